# SPDX-License-Identifier: GPL-3.0-or-later
"""How directions at the mirror image of each vertex are turned and stretched there: what `carry_displacement` does to the
axes. No bpy here."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from intrinsym import Merge


def turns(symmetry, positions):
    """(vertices, 3, 3) matrices, fitted to the positions, (vertices, 3), of a pose."""
    def carried(axis):
        unit = np.zeros((len(positions), 3))
        unit[:, axis] = 1
        return symmetry.carry_displacement(positions, unit, Merge.SWAP)

    with ThreadPoolExecutor(3) as threads:
        return np.stack(list(threads.map(carried, range(3))), axis=2)
