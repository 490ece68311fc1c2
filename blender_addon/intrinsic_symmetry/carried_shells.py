# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of vertices in shells that an edit has duplicated, as a garment made of the skin: the partner of a duplicate is
the duplicate of its original's partner, in the shell that has these. No bpy here."""

from collections import Counter, defaultdict
from itertools import chain

import numpy as np

#: Two shells are each other's images if this share of their originals is.
_SHARED = 0.5
#: A shell is not its own image if its heights differ between left and right by more than this many times their mean.
_UNLIKE = 1


def pairs(shells, original, image, height):
    """{vertex: its partner} of lists of vertices, each a shell; of (vertices,) originals, the images of these, and how high
    a duplicate is above its original. Of several duplicates of one those at the same height are paired."""
    tables = [_by_original(shell, original) for shell in shells]
    found = {}
    for one, other in _matched(tables, image, height):
        there, back = (_nearest(tables[start], tables[end], image, height) for start, end in ((one, other), (other, one)))
        twins = {vertex: twin for vertex, twin in there.items() if back.get(twin) == vertex}
        rows, images = (np.fromiter(part, np.int64, len(twins)) for part in (twins.keys(), twins.values()))
        off = np.abs(height[rows] - height[images]).sum()
        if one != other or off <= _UNLIKE * np.abs(height[rows]).sum():
            found.update({**twins, **{twin: vertex for vertex, twin in twins.items()}})
    return found


def _by_original(shell, original):
    table = defaultdict(list)
    for vertex in shell.tolist():
        if original[vertex] >= 0:
            table[int(original[vertex])].append(vertex)
    return table


def _matched(tables, image, height):
    """Pairs of numbers of tables, each of which is in one. A shell across the line is its own image."""
    sides = [{key: int(image[vertices[0]]) for key, vertices in table.items()} for table in tables]
    sides = [{key: there for key, there in each.items() if there != key} for each in sides]  # without the line
    holders = defaultdict(list)
    for number, each in enumerate(sides):
        for key in each:
            holders[key].append(number)
    scores = []
    for number, each in enumerate(sides):
        for other, count in Counter(chain.from_iterable(holders[there] for there in each.values() if there in holders)).items():
            share = count / max(len(each), len(sides[other]))
            off = abs(_mean_height(tables[number], height) - _mean_height(tables[other], height))
            if number <= other and share >= _SHARED:
                scores.append((number != other, -share, off, number, other))
    free = set(range(len(tables)))
    for *_, one, other in sorted(scores):
        if {one, other} <= free:
            free -= {one, other}
            yield one, other


def _mean_height(table, height):
    return np.mean(height[list(chain.from_iterable(table.values()))])


def _nearest(table, others, image, height):
    """{vertex: of the other table's duplicates of its image, the one that is nearest in height}."""
    found = {}
    for vertices in table.values():
        there = others.get(int(image[vertices[0]]), [])
        for vertex in vertices if there else ():
            found[vertex] = min(there, key=lambda twin: abs(height[twin] - height[vertex]))
    return found
