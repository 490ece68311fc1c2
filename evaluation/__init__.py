"""Measures the command line on meshes with known truth; never on what it was trained on."""
