# SPDX-License-Identifier: GPL-3.0-or-later
"""Along which vertices and edges a half of a mesh ends, where left and right do not share their faces.

The sides of the stored map are cleaned until each shell has one winning and one losing region. The line between them
goes through the vertices that the map has on it, as far as these may all lie there, and is then moved onto others that
are near it. A vertex may lie on the line only if one run of the vertices around it is
of the winning side and one of the losing side (a simple point: A. Rosenfeld, "Connectivity in digital pictures", 1970),
so that both regions stay connected, and the winning one has a border without crossings.
"""

import numpy as np

from . import mesh_data, rigid_pieces, stored_map, vertex_map
from .half_labels import LINE, LOSES, STAYS, WINS, Halves, not_through
from .regions import components, mirrored

#: The line goes through a vertex if it crosses one of its edges in this first share of the edge: a vertex of which is
#: known exactly where it has its image, or which was made by an edit, and another one.
_NEAR = 0.02, 0.3
#: Where it crosses an edge at a vertex that it cannot go through: one of the first, and another one.
_LEAST = 0.02, 0.1


def halves(bm, mesh, symmetry, labels):
    """The Halves of a mesh, of which `bm` is a BMesh, with the labels of its shells. Raises MeshProblem."""
    edges, positions = mesh_data.edges(mesh).astype(np.int64), mesh_data.positions(mesh).astype(float)
    labels = np.where(_stray(labels, edges), -labels, labels)
    labels[_deserted(mesh, labels, symmetry.side == 0)] = LOSES
    bm.verts.ensure_lookup_table()
    labels[_drawn(bm, labels, edges, symmetry.side == 0)] = LINE
    changed = stored_map.is_changed(mesh, symmetry.partner)
    exact = vertex_map.pairs(symmetry) & ~changed
    images, known = rigid_pieces.exact(
        symmetry.surface_points.positions(positions), positions, ~exact, exact, edges, sign=-1
    )
    known |= exact | changed
    distance = np.where(symmetry.side == 0, 0.0, np.linalg.norm(images - positions, axis=1))
    winning, losing, shares, _ = _crossings(labels, edges, distance)
    near = np.full(len(labels), 1.0)
    np.minimum.at(near, winning, shares)
    np.minimum.at(near, losing, 1 - shares)
    within = near < np.where(known, *_NEAR)
    for vertex in np.argsort(near, kind="stable")[: np.count_nonzero(near < _NEAR[1])].tolist():
        if within[vertex] and _may_lie_on_line(bm.verts[vertex], labels):
            labels[vertex] = LINE
    _refuse_moved(mesh, np.where(exact, symmetry.partner.astype(np.int64), -1), labels)
    winning, losing, shares, crossed = _crossings(labels, edges, distance)
    least = np.where(known[winning] & known[losing], *_LEAST)
    none, some, images = np.full(len(labels), -1), np.ones(len(labels), bool), np.full(positions.shape, np.nan)
    shares = np.clip(shares, least, 1 - least)
    return Halves(labels, crossed, winning, losing, shares, none, some, images, images, ~some, np.eye(3), none, ~some, np.arange(len(labels)))


def _refuse_moved(mesh, partner, labels):
    """Raises MeshProblem where vertices with mirrored faces would not keep the place of their partner, (vertices,), -1 for
    none."""
    offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
    itself, image = partner == np.arange(len(labels)), labels[partner]
    as_it_was = (labels == STAYS) | np.where(itself, labels == LINE, (labels == -image) & (labels != LINE))
    if moved := np.count_nonzero(mirrored(offsets, corners, partner) & ~as_it_was):
        raise mesh_data.MeshProblem(
            f"{moved:,} vertices that are mirrored already would not stay as they are: {not_through(mesh)}"
        )


def _stray(labels, edges):
    """(vertices,) bool: all but the largest winning and the largest losing region of each shell."""
    shell = components(len(labels), edges)
    inner = edges[labels[edges[:, 0]] == labels[edges[:, 1]]]
    region = components(len(labels), inner)
    size = np.bincount(region, minlength=len(labels))
    largest = {}
    for number in np.unique(region).tolist():
        key = (shell[number], labels[number])
        if size[number] > size[largest.get(key, number)] or key not in largest:
            largest[key] = number
    return ~np.isin(region, list(largest.values())) & (np.abs(labels) == 1)


def _deserted(mesh, labels, on_line):
    """(vertices,) bool: those that the map has on the line, but with nothing of the winning side in their faces any more."""
    offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
    wins = np.logical_or.reduceat(((labels == WINS) & ~on_line)[corners], offsets[:-1])
    deserted = on_line & (labels == WINS)
    deserted[corners[np.repeat(wins, np.diff(offsets))]] = False
    return deserted


def _drawn(bm, labels, edges, on_line):
    """(vertices,) bool: the winning ones, of those that the map has on the line, that may lie there all at once."""
    chosen, bad = on_line & (labels == WINS), True
    while np.any(bad):
        now = np.where(chosen, LINE, labels)
        bad = np.zeros(len(labels), bool)
        bad[edges[_stray(now, edges)[edges].any(axis=1)]] = True
        bad[[at for at in np.flatnonzero(chosen).tolist() if not _may_lie_on_line(bm.verts[at], now)]] = True
        bad &= chosen
        chosen &= ~bad
    return chosen


def _crossings(labels, edges, distance):
    """Winning ends, losing ends, shares of the way and numbers of the edges that the line crosses: half way between a
    vertex and its image."""
    product = labels[edges[:, 0]] * labels[edges[:, 1]]
    crossed = np.flatnonzero(product == WINS * LOSES)
    first, second = edges[crossed].T
    wins = labels[first] == WINS
    winning, losing = np.where(wins, first, second), np.where(wins, second, first)
    total = distance[winning] + distance[losing]
    shares = np.where(total > 0, distance[winning] / np.maximum(total, 1e-30), 0.5)
    return winning, losing, shares, crossed


def _may_lie_on_line(vertex, labels):
    around, closed = _link(vertex)
    found = [labels[other] for other in around]
    return all(_runs(found, label, closed) == 1 for label in (WINS, LOSES))


def _runs(labels, wanted, closed):
    """How many runs of a label there are."""
    before = labels[-1:] + labels[:-1] if closed else [None] + labels[:-1]
    return sum(label == wanted != last for label, last in zip(labels, before))


def _link(vertex):
    """Numbers of the vertices around a vertex, in order, and whether they close; none where its faces are no disk."""
    paths, ends = {}, set()
    for loop in vertex.link_loops:
        path, step = [], loop.link_loop_next
        while step != loop:
            path.append(step.vert.index)
            step = step.link_loop_next
        paths[path[0]] = path
        ends.add(path[-1])
    starts = [start for start in paths if start not in ends]
    if len(paths) != len(vertex.link_loops) or len(starts) > 1:
        return [], True
    at = start = starts[0] if starts else next(iter(paths), None)
    around = []
    while at in paths:
        path = paths.pop(at)
        around += path[:-1]
        at = path[-1]
    if paths:
        return [], True
    return (around, True) if at == start else (around + [at], False)
