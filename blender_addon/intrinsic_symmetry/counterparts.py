# SPDX-License-Identifier: GPL-3.0-or-later
"""Which group or shape key is the mirror image of which, so that a name that is not understood destroys nothing.

Arm.L and Arm.R are a pair by their names; Spine, without a side, is its own mirror image. But a group that lies on one
side alone is no Spine, whatever its name is. It may be mirrored in place only where that fills its empty half: from its
own side, and if no other such group lies there, of which it would be the other half.
"""

import numpy as np
from intrinsym import Merge

from . import side_names

#: From this balance on a group lies on one side; below the other one, on both.
_ON_ONE, _ON_BOTH = 0.9, 0.2
#: Share of its vertices from which on a group lies where the mirror image of another one does.
_SHARED = 0.25
#: Merge to the side that wins, in the stored map's numbers.
WINNER = {Merge.POSITIVE_WINS: 1, Merge.NEGATIVE_WINS: -1}
#: Names that a report lists; of more, it says how many.
_LISTED = 3


def balance(amounts, side):
    """(names,) -1..1: where the amounts, (vertices, names), lie: all left 1, all right -1, on both or nowhere 0."""
    left, right = amounts[side > 0].sum(axis=0), amounts[side < 0].sum(axis=0)
    return (left - right) / np.maximum(left + right, 1e-12)


def is_on_one_side(amounts, side):
    """Whether a group, (vertices, 1), lies on one side alone."""
    return abs(balance(amounts, side)[0]) > _ON_ONE


def one_sided(names, amounts, symmetry, merge):
    """Names of groups without a side in their name that lie on one side: those that may not be mirrored in place, and
    those that may."""
    where = balance(amounts, symmetry.side)
    alone = [column for column in range(len(names)) if abs(where[column]) > _ON_ONE]
    sided = [column for column in alone if not side_names.side(names[column], names)]
    if not sided:
        return [], []
    sign = np.sign(where[sided])
    fills = sign == WINNER.get(merge)
    there = (amounts[:, sided] > 0).astype(np.float32)
    image = np.where(symmetry.partner[:, None] < 0, 0, there[symmetry.partner])
    least = np.minimum.outer(there.sum(axis=0), there.sum(axis=0))
    taken = ((image.T @ there > _SHARED * least) & (sign[:, None] != sign)).any(axis=1)
    good = fills & ~taken
    return tuple([names[column] for column, is_so in zip(sided, flags) if is_so] for flags in (~good, good))


def central(names, amounts, side):
    """Names with a side and without a counterpart that lie on both sides: L1 of a spine."""
    where, filled = balance(amounts, side), amounts.any(axis=0)
    alone = [side_names.side(name) != 0 and side_names.counterpart(name, names) not in names for name in names]
    return [name for name, *is_so in zip(names, alone, filled, np.abs(where) < _ON_BOTH) if all(is_so)]


def only_filled(amounts, merge):
    """The only one of a pair that has any amounts, (vertices, 2): nothing is taken from an empty one, but in an
    exchange. None where there is no such one."""
    filled = amounts.any(axis=0)
    return int(filled.argmax()) if filled.sum() == 1 and merge != Merge.SWAP else None


def source_of_keys(amounts, merge):
    """The key of a left and right pair, 0 or 1, that the other one takes from; None where each takes from the other."""
    only = only_filled(amounts, merge)
    return {1: 0, -1: 1}.get(WINNER.get(merge)) if only is None else only


def source_of_groups(amounts, side, merge):
    """The group of a pair, 0 or 1, that is mirrored as a whole: the only one that has any weights, or has any on the
    winning side, so that what it has beyond the middle stays. None where each vertex decides. Raises NothingToTake."""
    only = only_filled(amounts, merge)
    if only is not None or merge not in WINNER or not amounts.any():
        return only
    filled = amounts[side == WINNER[merge]].any(axis=0)
    if not filled.any():
        raise NothingToTake
    return int(filled.argmax()) if filled.sum() == 1 else None


class NothingToTake(Exception):
    """Both of a pair lie on the losing side alone."""


def listed(names):
    """Names in a sentence."""
    shown = ", ".join(f'"{name}"' for name in names[:_LISTED])
    more = len(names) - _LISTED
    return f"{shown} and {more} more" if more > 0 else shown
