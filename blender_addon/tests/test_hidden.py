# SPDX-License-Identifier: GPL-3.0-or-later
"""Every tool leaves what is hidden in edit mode as it is, and changes what is not."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, said, select

ops = bpy.ops.intrinsic_symmetry


def _one_sided(mesh):
    """(vertices, 1) 1 on the left side, growing from the line."""
    return np.where(attribute(mesh, "sym_side") == 1, np.abs(positions(mesh)[:, 0]), 0)[:, None]


def _with_dent(object):
    module("mesh_data").set_shown_positions(object, positions(object.data) + 0.1 * _one_sided(object.data))


def _with_key(object):
    object.shape_key_add(name="Basis")
    key = object.shape_key_add(name="Smile")
    module("mesh_data").set_key_positions(key, positions(object.data) + 0.1 * _one_sided(object.data))
    object.active_shape_key_index = 1


def _key(object):
    return module("mesh_data").key_positions(object.data.shape_keys.key_blocks["Smile"])


def _with_colors(object):
    mesh = object.data
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    values = np.tile(_one_sided(mesh), (1, 4))
    for name, domain, rows in (("points", "POINT", slice(None)), ("corners", "CORNER", corners)):
        module("mesh_data").write_attribute(mesh, name, "FLOAT_COLOR", values[rows], domain)


def _with_uvs(object):
    object.data.uv_layers.new(name="UV")
    places = positions(object.data)[[loop.vertex_index for loop in object.data.loops]]
    faces = object.data.polygons
    is_left = np.repeat([face.center.x > 0 for face in faces], [face.loop_total for face in faces])
    module("mesh_data").update_attribute(object.data.attributes["UV"], places[:, [0, 2]] + 0.3 * is_left[:, None])


def _of(name):
    return lambda object: attribute(object.data, name)


def _places(object):
    return positions(object.data)


#: What comes before, the tool, and what it changes: values of vertices or of face corners.
TOOLS = {
    "symmetrize positions": (_with_dent, lambda: ops.symmetrize(direction="LEFT_TO_RIGHT"), _places),
    "symmetrize exactly": (_with_dent, lambda: ops.symmetrize_exactly(direction="LEFT_TO_RIGHT"), _places),
    "shape key": (_with_key, lambda: ops.mirror_shape_keys(direction="LEFT_TO_RIGHT"), _key),
    "points": (_with_colors, lambda: ops.mirror_attribute(name="points"), _of("points")),
    "corners": (_with_colors, lambda: ops.mirror_attribute(name="corners"), _of("corners")),
    "overlapping uvs": (_with_uvs, lambda: ops.mirror_uvs(placement="OVERLAP"), _of("UV")),
    "uvs in place": (_with_uvs, lambda: ops.mirror_uvs(placement="BESIDE"), _of("UV")),
}


@pytest.mark.parametrize("tool", TOOLS)
def test_what_is_hidden_stays(human, tool):
    prepare, call, values = TOOLS[tool]
    prepare(human)
    side, before = attribute(human.data, "sym_side"), values(human)
    hidden = (side < 1) & (np.arange(len(side)) % 2 == 0)
    enter("EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    enter("OBJECT")
    module("mesh_data").write_attribute(human.data, ".hide_vert", "BOOLEAN", hidden)
    enter("EDIT")
    assert call() == {"FINISHED"}
    enter("OBJECT")
    changed = np.abs(values(human) - before).max(axis=1) > 1e-6
    corners = np.array([loop.vertex_index for loop in human.data.loops])
    there = hidden if len(changed) == len(side) else hidden[corners]
    assert not changed[there].any() and changed[~there].sum() > 500


@pytest.mark.parametrize("hides", [True, False])
@pytest.mark.parametrize("tool", [ops.symmetrize, ops.symmetrize_exactly], ids=["positions", "exactly"])
def test_it_says_how_many_are_hidden_or_masked(human, tool, hides, capfd):
    losing = attribute(human.data, "sym_side") == -1
    name, kind, mode = (".hide_vert", "BOOLEAN", "EDIT") if hides else (".sculpt_mask", "FLOAT", "SCULPT")
    module("mesh_data").write_attribute(human.data, name, kind, losing)
    enter(mode)
    assert f"{losing.sum()} vertices are hidden, masked or outside the paint selection, and stay" in said(capfd, tool)


@pytest.mark.parametrize("direction, left, right", [("LEFT_TO_RIGHT", 0, 0), ("SWAP", 1, 0), ("AVERAGE", 0.5, 0.5)])
def test_a_mask_does_not_protect_itself(human, direction, left, right):
    """But hidden vertices keep theirs."""
    mesh, side = human.data, attribute(human.data, "sym_side")
    hidden = (side == -1) & (np.arange(len(side)) % 3 == 0)
    for name, kind, values in ((".sculpt_mask", "FLOAT", side == -1), (".hide_vert", "BOOLEAN", hidden)):
        module("mesh_data").write_attribute(mesh, name, kind, values)
    enter("SCULPT")
    assert ops.mirror_attribute(name=".sculpt_mask", direction=direction) == {"FINISHED"}
    enter("OBJECT")
    mask = attribute(mesh, ".sculpt_mask")
    assert np.abs(mask[side == 1] - left).max() < 1e-5 and np.abs(mask[(side == -1) & ~hidden] - right).max() < 1e-5
    assert (mask[hidden] == 1).all()


def _mirror_mask(object, capfd, mask, hidden=(), **settings):
    """What Mirror Mask says in sculpt mode."""
    enter("OBJECT")
    flags = np.isin(np.arange(len(mask)), np.flatnonzero(hidden))
    for name, kind, values in ((".sculpt_mask", "FLOAT", mask), (".hide_vert", "BOOLEAN", flags)):
        module("mesh_data").write_attribute(object.data, name, kind, values)
    enter("SCULPT")
    return said(capfd, ops.mirror_attribute, name=".sculpt_mask", **settings).strip()


def test_mirror_mask_says_what_happened(human, capfd):
    side = attribute(human.data, "sym_side")
    left, right, count = side == 1, side == -1, np.count_nonzero(side == 1)
    assert _mirror_mask(human, capfd, left, direction="LEFT_TO_RIGHT") == (
        f"Info: Mask: {count} of {len(side)} values changed. {2 * count} vertices are masked now, {count} before")
    assert f"changed. 0 vertices are masked now, {count} before" in _mirror_mask(human, capfd, right, direction="LEFT_TO_RIGHT")
    alike = f"Info: Mask: 0 of {len(side)} values changed. Both sides are alike where they may change. "
    assert _mirror_mask(human, capfd, side < 2) == f"{alike}{len(side)} vertices are masked now, {len(side)} before"
    assert _mirror_mask(human, capfd, left, right, direction="LEFT_TO_RIGHT") == (
        f"Info: Mask: 0 of {len(side)} values changed. {count} vertices are masked now, {count} before. "
        f"{count} vertices are hidden, and stay")


def test_mirror_mask_says_that_nothing_is_masked(human, capfd):
    with pytest.raises(RuntimeError, match="Nothing is masked"):
        ops.mirror_attribute(name=".sculpt_mask")
    with pytest.raises(RuntimeError, match="Nothing is masked"):
        _mirror_mask(human, capfd, np.zeros(len(human.data.vertices)))


def test_mirror_mask_says_what_has_no_mirror_image(human, capfd):
    """Where that is all that is masked, nothing changes."""
    side = attribute(human.data, "sym_side")
    select(human, np.flatnonzero(side == -1))
    enter("EDIT")
    bpy.ops.mesh.delete(type="VERT")
    enter("OBJECT")
    text = _mirror_mask(human, capfd, attribute(human.data, "sym_side") == 1)
    assert "Mask: 0 of" in text and "of the vertices have no mirror image and are not touched" in text


def _with_creases(object):
    ends = np.array([edge.vertices for edge in object.data.edges])
    values = _one_sided(object.data)[ends].mean(axis=1)
    module("mesh_data").write_attribute(object.data, "crease_edge", "FLOAT", values, "EDGE")


def _with_face_values(object):
    values = np.array([max(face.center.x, 0) for face in object.data.polygons])
    module("mesh_data").write_attribute(object.data, "mine", "FLOAT", values, "FACE")


def _with_normals(object):
    normals = np.array([vertex.normal for vertex in object.data.vertices]) + 0.5 * _one_sided(object.data)
    object.data.normals_split_custom_set_from_vertices((normals / np.linalg.norm(normals, axis=1)[:, None]).tolist())


def _normals(object):
    return module("ops_attributes").normals(object.data)


#: The same for what faces and edges have.
TOOLS_OF_FACES = {
    **{tool: TOOLS[tool] for tool in ("corners", "overlapping uvs", "uvs in place")},
    "creases": (_with_creases, lambda: ops.mirror_attribute(name="crease_edge"), _of("crease_edge")),
    "faces": (_with_face_values, lambda: ops.mirror_attribute(name="mine"), _of("mine")),
    "normals": (_with_normals, lambda: ops.mirror_attribute(name="custom_normal"), _normals),
}


@pytest.mark.parametrize("tool", TOOLS_OF_FACES)
def test_what_hidden_faces_have_stays_though_their_vertices_are_seen(human, tool):
    prepare, call, values = TOOLS_OF_FACES[tool]
    prepare(human)
    mesh, before = human.data, values(human)
    enter("EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    enter("OBJECT")
    right = np.array([face.center.x < 0 for face in mesh.polygons])
    hidden = right & (np.arange(len(right)) % 3 == 0)
    mesh.polygons.foreach_set("hide", hidden)
    edges = np.arange(len(mesh.edges)) % 3 == 0
    mesh.edges.foreach_set("hide", edges)
    enter("EDIT")
    assert call() == {"FINISHED"}
    enter("OBJECT")
    assert not any(vertex.hide for vertex in mesh.vertices) and np.count_nonzero(hidden) > 500
    least = 0.01 if tool == "normals" else 1e-4  # Blender keeps them as angles, in few bits
    changed = (np.abs(values(human) - before).reshape(len(before), -1) > least).any(axis=1)
    there = {len(mesh.edges): edges, len(hidden): hidden}.get(len(changed))
    there = np.repeat(hidden, [face.loop_total for face in mesh.polygons]) if there is None else there
    assert not changed[there].any() and changed[~there].sum() > 500


def test_faces_outside_the_paint_selection_stay(human):
    """Corners of theirs at vertices of selected faces, too."""
    _with_colors(human)
    mesh, before = human.data, attribute(human.data, "corners")
    mesh.use_paint_mask = True
    chosen = np.arange(len(mesh.polygons)) % 3 == 0
    mesh.polygons.foreach_set("select", chosen)
    enter("VERTEX_PAINT")
    assert ops.mirror_attribute(name="corners") == {"FINISHED"}
    enter("OBJECT")
    changed = (attribute(mesh, "corners") != before).any(axis=1)
    inside = np.repeat(chosen, [face.loop_total for face in mesh.polygons])
    assert not changed[~inside].any() and changed[inside].sum() > 500
