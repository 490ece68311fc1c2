# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts a BMesh along the line between its halves, and makes the losing one the mirror image of the winning one: faces that
have no mirror images are deleted from one, and copied from the other.

Vertices carry their source in an INT layer: the number of the old vertex, or behind them that of the cut; a copy has
-1 - source.
"""

import bmesh
import numpy as np

from .half_faces import turned, without_images
from .half_labels import LINE, LOSES, STAYS, WINS

#: INT layers of vertices and faces, hidden as Blender's own are; the second says which faces are copies.
SOURCE, COPIED = ".sym_source", ".sym_copied"
_LABEL = ".sym_label"


def rebuild(bm, halves):
    """The losing half is the mirror image of the winning one afterwards. Faces that are so already stay, and so do the
    vertices that have twins, and what else hangs on them. How many other faces than the losing ones are gone: none may be."""
    label = _written(bm, halves)
    source = bm.verts.layers.int[SOURCE]
    cuts = list(range(len(halves.twin), len(halves.twin) + len(halves.shares)))
    twin, point = halves.twin.tolist() + cuts, halves.point.tolist() + cuts
    for number in np.flatnonzero(halves.labels == LINE).tolist():
        twin[number] = number
    apart = [vertex for vertex, is_so in zip(bm.verts, halves.apart.tolist()) if is_so]
    apart += _cut(bm, halves, label)
    for face in _alone(apart, source, label, twin, point):
        apart += face.verts
        _split(face, label)
    alone = _flip(_alone(apart, source, label, twin, point), source, label, twin)
    around = _around(apart, label)
    walls = _walls(around, label)
    lost = walls + [face for face in alone if any(vertex[label] == LOSES for vertex in face.verts)]
    kept = set(around) - set(lost)
    copied = [face for face in alone if any(vertex[label] == WINS for vertex in face.verts)]
    copied += [edge for edge in bm.edges if edge.is_wire and _is_edited(edge, label, source, halves.edited, twin)]
    edges = dict.fromkeys(edge for face in lost for edge in face.edges)
    vertices = {vertex[source]: vertex for vertex in bm.verts}
    joined = _copy(bm, copied, {own: vertices[other] for own, other in enumerate(twin) if other in vertices})
    bmesh.ops.delete(bm, geom=lost, context="FACES_ONLY")
    _join(bm, joined)
    _clean(bm, [edge for edge in edges if edge.is_valid], source, vertices, twin)
    bm.verts.layers.int.remove(bm.verts.layers.int[_LABEL])
    return sum(not face.is_valid for face in kept)


def _around(apart, label):
    """The faces at vertices of `apart`."""
    return list(dict.fromkeys(face for vertex in apart if vertex[label] != STAYS for face in vertex.link_faces))


def _walls(faces, label):
    """Those of the faces that lie in the line and close one half alone: where the halves meet there, nothing is between them.
    What stands on the surface in the plane, as a fin, is none."""
    def is_within(face):
        return all(vertex[label] == LINE for vertex in face.verts)

    def closes(edge):
        return len(edge.link_faces) == 2 and not all(map(is_within, edge.link_faces))

    waiting = [face for face in faces if is_within(face) and any(map(closes, face.edges))]
    found = dict.fromkeys(waiting)
    while waiting:
        beside = [other for edge in waiting.pop().edges if len(edge.link_faces) == 2 for other in edge.link_faces]
        around = [face for face in beside if face not in found and is_within(face)]
        found.update(dict.fromkeys(around))
        waiting += around
    return list(found)


def _alone(apart, source, label, twin, point):
    """The faces of both halves without mirror images, each of which has a vertex of `apart`."""
    faces = _around(apart, label)
    corners = [[vertex[source] for vertex in face.verts] for face in faces]
    return [faces[number] for number in without_images(corners, twin, point)]


def _flip(faces, source, label, twin):
    """Turns over losing faces whose mirror images were; the other faces."""
    paired = [face for face in faces if all(twin[vertex[source]] >= 0 for vertex in face.verts)]
    winning, losing = ([face for face in paired if any(v[label] == each for v in face.verts)] for each in (WINS, LOSES))
    at = {turned([vertex[source] for vertex in reversed(face.verts)]): face for face in losing}
    done = set()
    for face in winning:
        image = [twin[vertex[source]] for vertex in reversed(face.verts)]
        other = at.get(turned(image))
        if other is not None:
            other.normal_flip()
            done |= {face, other}
    return [face for face in faces if face not in done]


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
    """Adds a vertex where the line crosses an edge; these vertices."""
    source, count = bm.verts.layers.int[SOURCE], len(bm.verts)
    bm.edges.ensure_lookup_table()
    edges = [bm.edges[number] for number in halves.edges.tolist()]
    added = []
    for number, (edge, start, share) in enumerate(zip(edges, halves.winning.tolist(), halves.shares.tolist())):
        first = next(vertex for vertex in edge.verts if vertex[source] == start)
        cut = bmesh.utils.edge_split(edge, first, share)[1]
        cut[source], cut[label] = count + number, LINE
        added.append(cut)
    return added


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


def _is_edited(edge, label, source, edited, twin):
    """Whether an edge of the winning half without faces, which has no twin, was edited."""
    numbers = [vertex[source] for vertex in edge.verts]
    wins = {vertex[label] for vertex in edge.verts} in ({WINS}, {WINS, LINE})
    return wins and any(number < len(edited) and edited[number] and twin[number] < 0 for number in numbers)


def _copy(bm, elements, twins):
    """Copies faces, inside out, and edges without faces; {copy: vertex} of those to join to the `twins`, {number of a vertex:
    its twin}."""
    source, copied = bm.verts.layers.int[SOURCE], bm.faces.layers.int[COPIED]
    own = dict.fromkeys(vertex for element in elements for vertex in element.verts)
    answer = bmesh.ops.duplicate(bm, geom=elements)
    copies = [element for element in answer["geom"] if isinstance(element, bmesh.types.BMFace)]
    for face in copies:
        face[copied] = 1
    bmesh.ops.reverse_faces(bm, faces=copies)
    for vertex in own:
        answer["vert_map"][vertex][source] = -1 - vertex[source]
    return {answer["vert_map"][vertex]: twins[vertex[source]] for vertex in own if vertex[source] in twins}


def _join(bm, joined):
    """Joins copies to their twins, {copy: vertex}; edges that were there stay as they are."""
    kept = {edge: (edge.seam, edge.smooth) for vertex in set(joined.values()) for edge in vertex.link_edges}
    bmesh.ops.weld_verts(bm, targetmap=joined)
    for edge, flags in kept.items():
        if edge.is_valid:
            edge.seam, edge.smooth = flags


def _clean(bm, edges, source, vertices, twin):
    """Removes those edges that have no faces any more, and their vertices, unless the other half has such ones; `vertices` by
    their numbers."""

    def image(vertex):
        return vertices.get(twin[vertex[source]])

    ends = dict.fromkeys(vertex for edge in edges for vertex in edge.verts)
    for edge in edges:
        others = [image(vertex) for vertex in edge.verts]
        itself = set(others) == set(edge.verts)
        if edge.is_wire and (itself or None in others or bm.edges.get(others) is None):
            bm.edges.remove(edge)
    for vertex in ends:
        if not vertex.link_edges and image(vertex) in (None, vertex):
            bm.verts.remove(vertex)
