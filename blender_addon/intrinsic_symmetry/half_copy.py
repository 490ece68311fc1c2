# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts a BMesh along the line between its halves, and puts a mirrored copy of the winning one in the other's place.

Vertices carry their source in an INT layer: the number of the old vertex, or behind them that of the cut; a copy has
-1 - source.
"""

import bmesh

from .half_line import LINE, LOSES, WINS

#: INT layers of vertices and faces; the second says which faces are copies.
SOURCE, COPIED = "sym_source", "sym_copied"
_LABEL = "sym_label"


def rebuild(bm, halves):
    """The faces of the losing half are gone afterwards, and copies of those of the winning half are there."""
    label = _written(bm, halves)
    _cut(bm, halves, label)
    bmesh.ops.delete(bm, geom=[face for face in bm.faces if _is_lost(face, label)], context="FACES")
    _copy(bm, [face for face in bm.faces if any(vertex[label] == WINS for vertex in face.verts)], label)
    bm.verts.layers.int.remove(bm.verts.layers.int[_LABEL])


def _written(bm, halves):
    """The layer of labels; sources are written as well."""
    bm.verts.layers.int.new(SOURCE)
    bm.verts.layers.int.new(_LABEL)
    bm.faces.layers.int.new(COPIED)
    source, label = bm.verts.layers.int[SOURCE], bm.verts.layers.int[_LABEL]
    for number, (vertex, value) in enumerate(zip(bm.verts, halves.labels.tolist())):
        vertex[source], vertex[label] = number, value
    return label


def _cut(bm, halves, label):
    """Adds a vertex where the line crosses an edge, and edges between those."""
    source, count = bm.verts.layers.int[SOURCE], len(bm.verts)
    bm.edges.ensure_lookup_table()
    edges = [bm.edges[number] for number in halves.edges.tolist()]
    for number, (edge, start, share) in enumerate(zip(edges, halves.winning.tolist(), halves.shares.tolist())):
        first = next(vertex for vertex in edge.verts if vertex[source] == start)
        cut = bmesh.utils.edge_split(edge, first, share)[1]
        cut[source], cut[label] = count + number, LINE
    line = [vertex for vertex in bm.verts if vertex[label] == LINE]
    for face in dict.fromkeys(face for vertex in line for face in vertex.link_faces):
        _split(face, label)


def _split(face, label):
    """Cuts off each run of winning corners of a face that has losing ones as well."""
    waiting = [face]
    while waiting:
        face = waiting.pop()
        labels = [vertex[label] for vertex in face.verts]
        if WINS not in labels or LOSES not in labels:
            continue
        size, corners = len(labels), list(face.verts)
        start = next(at for at in range(size) if labels[at] == WINS != labels[at - 1])
        end = next(at for at in range(start, start + size) if labels[at % size] != WINS)
        waiting += [face, bmesh.utils.face_split(face, corners[start - 1], corners[end % size])[0]]


def _is_lost(face, label):
    return all(vertex[label] in (LOSES, LINE) for vertex in face.verts)


def _copy(bm, faces, label):
    """Copies faces inside out, and joins the copies to them along the line."""
    source, copied = bm.verts.layers.int[SOURCE], bm.faces.layers.int[COPIED]
    own = dict.fromkeys(vertex for face in faces for vertex in face.verts)
    answer = bmesh.ops.duplicate(bm, geom=faces)
    copies = [element for element in answer["geom"] if isinstance(element, bmesh.types.BMFace)]
    for face in copies:
        face[copied] = 1
    bmesh.ops.reverse_faces(bm, faces=copies)
    twins = {vertex: answer["vert_map"][vertex] for vertex in own}
    for vertex, twin in twins.items():
        twin[source] = -1 - vertex[source]
    bmesh.ops.weld_verts(bm, targetmap={twin: vertex for vertex, twin in twins.items() if vertex[label] == LINE})
