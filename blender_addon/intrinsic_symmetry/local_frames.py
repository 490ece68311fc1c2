# SPDX-License-Identifier: GPL-3.0-or-later
"""How directions at the mirror image of each vertex are turned there: what `carry_displacement` does to the axes. No
bpy here."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from intrinsym import Merge, SymmetryKind


def turns(symmetry, positions):
    """(vertices, 3, 3) orthogonal matrices, fitted to the positions, (vertices, 3), of a pose. The third column follows
    from the others, as the determinant is known."""
    def carried(axis):
        unit = np.zeros((len(positions), 3))
        unit[:, axis] = 1
        return symmetry.carry_displacement(positions, unit, Merge.SWAP)

    with ThreadPoolExecutor(2) as threads:
        x, y = threads.map(carried, range(2))
    z = np.cross(y, x) if symmetry.kind == SymmetryKind.REFLECTION else np.cross(x, y)
    return np.stack((x, y, z), axis=2)
