"""Data generation, labelling, training, evaluation and export of SignNet."""
