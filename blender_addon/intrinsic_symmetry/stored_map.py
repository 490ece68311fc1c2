# SPDX-License-Identifier: GPL-3.0-or-later
"""The map that is kept on a mesh: attributes of the POINT domain, and a record that says what they belong to.

| attribute | type | meaning |
|---|---|---|
| sym_vertex | INT | the vertex that is the mirror image; -1 none |
| sym_confidence | FLOAT | 0..1 |
| sym_side | INT | 1 left (see `left_side`), -1 right, 0 on the line between them |
| sym_face | INT | the face that holds the exact mirror image; -1 none |
| sym_corner_0, _1, _2 | INT | three vertices of that face |
| sym_bary | FLOAT_VECTOR | their weights |
| sym_record | INT | the same for all vertices: which record belongs to the map (see `undo`) |
| sym_index, sym_mixed | INT, FLOAT | the vertex' own number, from 1, plain and scattered (see `carry`) |
| sym_place, sym_image | FLOAT_VECTOR | where the vertex and its mirror image were when the map was stored |
| sym_around | INT | the faces around the vertex then (see `regions.around`) |

Editing rots such numbers silently, so the record holds a hash of the connectivity and a checksum of the attributes,
and a map that does not fit its mesh any more is refused.
"""

import re
import zlib
from dataclasses import dataclass

import intrinsym
import numpy as np

from . import mesh_data, undo, vertex_map
from .regions import around
from .undo import RECORD

PARTNER, CONFIDENCE, SIDE = "sym_vertex", "sym_confidence", "sym_side"
FACE, BARY = "sym_face", "sym_bary"
CORNERS = ("sym_corner_0", "sym_corner_1", "sym_corner_2")
KINDS = {PARTNER: "INT", CONFIDENCE: "FLOAT", SIDE: "INT", FACE: "INT", BARY: "FLOAT_VECTOR"}
KINDS.update(dict.fromkeys((*CORNERS, undo.NUMBER), "INT"))
#: The vertex' own number plus 1, and the same `scattered`.
NUMBERS = ("sym_index", "sym_mixed")
#: Where it and its image were, and its faces, when the map was stored.
PLACE, IMAGE, AROUND = "sym_place", "sym_image", "sym_around"
#: What `carry` needs besides the map.
_TRACES = {**dict(zip(NUMBERS, ("INT", "FLOAT"))), PLACE: "FLOAT_VECTOR", IMAGE: "FLOAT_VECTOR", AROUND: "INT"}
#: The golden section of 2^64.
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
#: FLOAT_VECTOR: how far vertices stand off the surface that the map speaks of, after `carry`.
LIFT = "sym_lift"
#: INT: what an edit did, after `carry`: MADE the vertex or moved it, LOST its mirror image, or gave it other faces.
EDIT = "sym_edit"
MADE, LOST, REFACED = 1, 2, 3
#: FLOAT_VECTOR: how far an edit has moved old vertices, and duplicates from their originals, after `carry`.
MOVED = "sym_moved"
#: What `carry` adds.
_CARRIED = {LIFT: "FLOAT_VECTOR", EDIT: "INT", MOVED: "FLOAT_VECTOR"}
#: All of these.
_OF_MAP = {**KINDS, **_TRACES, **_CARRIED}
#: FLOAT_VECTOR: positions of the shape that is being edited, when they were remembered. That of a shape key ends in a
#: number made of the key's name, so that what was edited on one is not mirrored on another.
REMEMBERED = "sym_remembered"
_REMEMBERED = re.compile(rf"{REMEMBERED}(_[0-9a-f]{{8}})?")
#: What an imported PLY or glTF file says of its further symmetries. It does not belong to the map that is kept.
_FURTHER = re.compile(r"(sym_(vertex|confidence|side)|_SYM_(VERTEX|CONFIDENCE|SIDE))_\d+")
_NONE = 2**32 - 1
#: What says which side is left, where no name does.
BY_X = "+X"
#: The least confidence that is told from none.
LEAST = 1e-6


def is_own(name):
    """Whether an attribute of this name belongs to the map, or is what was remembered."""
    return name in _OF_MAP or is_remembered(name)


def is_remembered(name):
    """Whether an attribute of this name is a shape that was remembered."""
    return _REMEMBERED.fullmatch(name) is not None


def is_of_vertices(attribute, *kinds):
    """Whether an attribute may be what is written as one of the `kinds`. Others of the same name are the user's."""
    return attribute.domain == "POINT" and attribute.data_type in kinds


def remembered(mesh):
    """Names of the shapes that were remembered."""
    return [name for name in filter(is_remembered, mesh.attributes.keys()) if is_of_vertices(mesh.attributes[name], "FLOAT_VECTOR")]


def refuse_taken(mesh):
    """Raises MeshProblem where something of the user's has a name that the map needs. Without a record all that have one are
    the user's, unless the three are there that a file brings; a PLY file gives all numbers as floats."""
    there = [mesh.attributes.get(name) for name in (PARTNER, CONFIDENCE, SIDE)]
    of_file = all(each is not None and is_of_vertices(each, "INT", "FLOAT") for each in there)
    for name, kind in _OF_MAP.items():
        refuse_name(mesh, name, *([kind] if RECORD in mesh else [kind, "FLOAT"] if of_file else []))
    for name in filter(is_remembered, mesh.attributes.keys()):
        refuse_name(mesh, name, "FLOAT_VECTOR")


def refuse_groups(object):
    """Raises MeshProblem where a vertex group has a name of the map: Blender takes it for the attribute, and removes it as that."""
    taken = [group.name for group in object.vertex_groups if is_own(group.name)]
    if taken:
        raise mesh_data.MeshProblem(f'The name of the vertex group "{taken[0]}" is needed for the symmetry: rename it')


def refuse_name(mesh, name, *kinds):
    """Raises MeshProblem where something of the user's has the name: what is not of vertices, and of one of the `kinds`."""
    attribute = mesh.attributes.get(name)
    if attribute is not None and not is_of_vertices(attribute, *kinds):
        what = "UV map" if name in mesh.uv_layers else "attribute"
        raise mesh_data.MeshProblem(f'The name of the {what} "{name}" is needed for the symmetry: rename it')


def read_edit(mesh):
    """(vertices,) MADE, LOST or REFACED by an edit since the map was found; 0 for others."""
    attribute = mesh.attributes.get(EDIT)
    return np.zeros(len(mesh.vertices), int) if attribute is None else mesh_data.read_attribute(attribute)


def read_lift(mesh):
    """(vertices, 3) how far each vertex stands off the surface that the map speaks of."""
    return _vectors(mesh, LIFT)


def read_moved(mesh):
    """(vertices, 3) how far an edit has moved each vertex, or a duplicate from its original, since the map was found."""
    return _vectors(mesh, MOVED)


def _vectors(mesh, name):
    attribute = mesh.attributes.get(name)
    return np.zeros((len(mesh.vertices), 3)) if attribute is None else mesh_data.read_attribute(attribute).astype(float)


def is_touched(mesh, partner):
    """(vertices,) bool: those that an edit has done something to, or to their partners, (vertices,)."""
    edit = read_edit(mesh) > 0
    return edit | edit[partner] & (partner >= 0)


def is_changed(mesh, partner):
    """(vertices,) bool: those that an edit has made or moved, or their partners, (vertices,), since the map was found."""
    made = read_edit(mesh) == MADE
    return made | made[partner] & (partner >= 0)


class StaleMap(mesh_data.MeshProblem):
    """There is no map that fits the mesh."""


class ChangedMesh(StaleMap):
    """The map is that of other vertices or faces."""

    def __init__(self):
        super().__init__("The mesh has other vertices or faces than when its symmetry was found: Detect again")


@dataclass(frozen=True)
class FixedLine:
    """One piece of the line between left and right; see `intrinsym.CurveLine`."""

    edges: np.ndarray  # (points, 2) int32
    parameters: np.ndarray  # (points,) float32
    closed: bool

    def positions(self, vertices):
        """(points, 3) for (vertices, 3)."""
        t = self.parameters[:, None]
        return (1 - t) * vertices[self.edges[:, 0]] + t * vertices[self.edges[:, 1]]

    def nearest_vertices(self):
        """(points,) the nearer end of each point's edge."""
        return np.where(self.parameters < 0.5, self.edges[:, 0], self.edges[:, 1])


def why_none(object):
    """Why there is no map to use, as far as can be seen without reading the mesh; or nothing."""
    record = object.data.get(RECORD)
    if record is None:
        return "Detect the symmetry first"
    if object.mode != "EDIT" and record["vertices"] != len(object.data.vertices) and not may_be_carried(object.data):
        return "The mesh has changed since: Detect again"
    return None


def may_be_carried(mesh):
    """Whether a map that does not fit the mesh may be carried through the edit; see `carry`."""
    record, kinds = mesh.get(RECORD, {}), {**KINDS, **_TRACES}
    return bool(record) and all(_attribute(mesh, name, kind) is not None for name, kind in kinds.items())


def store(mesh, core_mesh, symmetry, is_doubtful=False, left=(1, BY_X), exact_share=None):
    """Keeps a map on its mesh; `left` is which of its sides is left, 1 or -1, and what says so. A restored map does not
    know its `exact_share`."""
    points = symmetry.surface_points
    values = {
        PARTNER: symmetry.partner,
        CONFIDENCE: symmetry.confidence,
        SIDE: symmetry.side.astype(np.int32) * left[0],
        FACE: points.faces.astype(np.int64),
        BARY: points.barycentrics,
    }
    values.update(zip(CORNERS, points.corners.T.astype(np.int64)))
    refuse_taken(mesh)
    undo.remember(mesh)
    _remove_further(mesh)
    for name in _CARRIED.keys() & set(mesh.attributes.keys()):
        mesh_data.remove_attribute(mesh, name)
    for name, array in values.items():
        given = np.where(array == _NONE, -1, array) if KINDS[name] == "INT" else array
        mesh_data.write_attribute(mesh, name, KINDS[name], given)
    mesh[RECORD] = _record(mesh, core_mesh, symmetry) | {"doubtful": is_doubtful, "left_from": left[1]}
    if exact_share is not None:
        mesh[RECORD]["exact_share"] = exact_share
    _trace(mesh, core_mesh, points)
    _number(mesh)


def store_share(mesh, whole, members, number):
    """Keeps, beside the attributes that are there, the record of one of several objects that share a map, which has the
    `number` among them: that of all of them, `whole`, and their names."""
    undo.remember(mesh)
    _remove_further(mesh)
    own = {"checksum": _checksum(mesh), **_counts(mesh)}
    shared = {key: value for key, value in whole.items() if not key.startswith("line_")}
    numbered = {str(at): name for at, name in enumerate(members)}
    mesh[RECORD] = shared | own | {"members": numbered, "member": number, "whole": whole}
    _number(mesh)


def _counts(mesh):
    vertices, faces = len(mesh.vertices), len(mesh.polygons)
    return {"vertices": vertices, "faces": faces, "triangles": len(mesh.loops) - 2 * faces}


def _record(mesh, core_mesh, symmetry):
    record = {
        "connectivity": f"{core_mesh.connectivity_hash:016x}",
        "checksum": _checksum(mesh),
        **_counts(mesh),
        "kind": int(symmetry.kind),
        "mean_confidence": float(symmetry.mean_confidence),
        "exact_share": float(symmetry.exact_share),
    }
    if lines := symmetry.fixed_curve:
        # In arrays: Blender takes each new name past all that are there.
        record["line_edges"] = np.concatenate([line.edges for line in lines]).astype(np.int32).ravel().tolist()
        record["line_parameters"] = np.concatenate([line.parameters for line in lines]).astype(float).tolist()
        record["line_points"] = [len(line.parameters) for line in lines]
        record["line_closed"] = [int(line.closed) for line in lines]
    return record


def _trace(mesh, core_mesh, points):
    """Keeps where the vertices and their images are, and which faces they have."""
    offsets, corners = (np.asarray(part).astype(np.int64) for part in core_mesh.polygons)
    places = mesh_data.positions(mesh)
    faces = around(offsets, corners, np.arange(len(places)))
    for name, values in ((PLACE, places), (IMAGE, np.nan_to_num(points.positions(places))), (AROUND, faces)):
        mesh_data.write_attribute(mesh, name, _TRACES[name], values)


def _number(mesh):
    """Marks the attributes as those of the record that the mesh has, and each vertex by its own number."""
    own = 1 + np.arange(len(mesh.vertices))
    for name, values in zip(NUMBERS, (own, scattered(own))):
        mesh_data.write_attribute(mesh, name, _TRACES[name], values)
    numbers = np.full(len(mesh.vertices), undo.number_of(mesh[RECORD]))
    mesh_data.write_attribute(mesh, undo.NUMBER, "INT", numbers)
    undo.remember(mesh)


def number_as_whole(mesh, first):
    """Gives the vertices of one of several objects that share a map the numbers that they have in the joined mesh, where
    its vertices begin with `first`. What did not fit before does not fit afterwards."""
    if not may_be_carried(mesh):
        return
    record, names = mesh[RECORD], (*NUMBERS, undo.NUMBER)
    own, mixed, mark = (mesh_data.read_attribute(mesh.attributes[name]).astype(float) for name in names)
    there = np.where((own > 0) & (own <= record["vertices"]), own + first, 0)
    mixed += scattered(there) - scattered(own)
    mark += undo.number_of(record["whole"]) - undo.number_of(record)
    for name, values in zip(names, (there, mixed, np.clip(mark, 0, undo.MOST))):
        mesh_data.update_attribute(mesh.attributes[name], values)


def scattered(numbers):
    """0..1, so that the mean of some numbers goes elsewhere than the mean of where they go: also of numbers whose mean is whole."""
    whole = np.asarray(numbers).astype(np.int64).astype(np.uint64)
    return whole * whole * _GOLDEN / 2.0**64


def _checksum(mesh):
    total = 0
    for name in (name for name in KINDS if name != undo.NUMBER):
        total = zlib.crc32(mesh_data.read_attribute(mesh.attributes[name]).tobytes(), total)
    return f"{total:08x}"


def load(mesh, only=None):
    """The stored map as an `intrinsym.Symmetry`. Raises StaleMap.

    `only`, (vertices,) bool: the other vertices get confidence 0, and these at least LEAST, so that a tool with this
    minimum changes these alone.
    """
    record = mesh.get(RECORD)
    if record is None or any(_attribute(mesh, name) is None for name in KINDS):
        raise StaleMap("This mesh has no stored symmetry: Detect first")
    if "members" in record:
        raise StaleMap("The symmetry spans several objects, and this tool works on one: Detect on this one alone")
    core_mesh = intrinsym.Mesh(mesh_data.positions(mesh), mesh_data.polygons(mesh))
    if record["connectivity"] != f"{core_mesh.connectivity_hash:016x}":
        raise ChangedMesh
    if record["checksum"] != _checksum(mesh):
        raise StaleMap("The stored symmetry has been changed by an edit: Detect again")
    read = {name: mesh_data.read_attribute(mesh.attributes[name]) for name in KINDS}
    corners = np.stack([read[name] for name in CORNERS], axis=1)
    points = intrinsym.SurfacePoints(read[FACE].astype(np.uint32), corners.astype(np.uint32), read[BARY])
    kind = intrinsym.SymmetryKind(record["kind"])
    confidence = read[CONFIDENCE]
    if only is not None:
        confidence = np.where(only, np.maximum(confidence, LEAST), np.float32(0))
    return core_mesh.restore(kind, read[PARTNER], confidence, read[SIDE].astype(np.int8), points)


def _attribute(mesh, name, kind=None):
    attribute = mesh.attributes.get(name)
    return attribute if attribute is not None and is_of_vertices(attribute, kind or KINDS[name]) else None


def fixed_lines(mesh):
    """The pieces of the line between left and right; empty for a half turn."""
    record = mesh.get(RECORD, {})
    if "line_points" not in record:
        return []
    ends = np.cumsum(record["line_points"][:])[:-1]
    edges = np.split(np.array(record["line_edges"][:], np.int32).reshape(-1, 2), ends)
    parameters = np.split(np.array(record["line_parameters"][:], np.float32), ends)
    return list(map(FixedLine, edges, parameters, map(bool, record["line_closed"][:])))


def name_sides(mesh, sign, left_from):
    """Keeps the sides, 1, or exchanges them, -1, and what says so."""
    undo.remember(mesh)
    mesh_data.update_attribute(mesh.attributes[SIDE], sign * mesh_data.read_attribute(mesh.attributes[SIDE]))
    edited = {"edited_side": sign * edited_side(mesh), "edited": edits(mesh)[::sign]}
    mesh[RECORD].update({"checksum": _checksum(mesh), "left_from": left_from, **edited})
    _number(mesh)


def edited_side(mesh):
    """The side with more edited vertices and faces when the map was carried last, 1 or -1; 0 if it was not, or none had more."""
    return mesh[RECORD].get("edited_side", 0)


def edits(mesh):
    """Numbers of vertices on the left and on the right that edits have touched since the map was found."""
    return [int(count) for count in mesh[RECORD].get("edited", (0, 0))]


def move_partners(mesh, core_mesh, partner):
    """Gives vertices other partners, at the vertices themselves where they are new ones."""
    moved = partner != mesh_data.read_attribute(mesh.attributes[PARTNER])
    points = vertex_map.at_vertices(core_mesh, partner)
    values = {FACE: points.faces.astype(np.int64), BARY: points.barycentrics, PARTNER: partner}
    values.update(zip(CORNERS, points.corners.T.astype(np.int64)))
    undo.remember(mesh)
    for name, array in values.items():
        old = mesh_data.read_attribute(mesh.attributes[name])
        mesh_data.update_attribute(mesh.attributes[name], np.where(moved.reshape(-1, *[1] * (old.ndim - 1)), array, old))
    mesh[RECORD]["checksum"] = _checksum(mesh)
    _number(mesh)


def clear(mesh):
    """Removes the map and its record, if there is one."""
    if RECORD not in mesh:
        return
    undo.remember(mesh)
    _remove_further(mesh)
    for name, kind in _OF_MAP.items():
        if _attribute(mesh, name, kind) is not None:
            mesh_data.remove_attribute(mesh, name)
    del mesh[RECORD]


def _remove_further(mesh):
    for name in filter(_FURTHER.fullmatch, mesh.attributes.keys()):
        if is_of_vertices(mesh.attributes[name], "INT", "FLOAT"):
            mesh_data.remove_attribute(mesh, name)
