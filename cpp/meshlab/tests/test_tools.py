# SPDX-License-Identifier: GPL-3.0-or-later
"""The filters that use a map: equal to the library's own tools to the bit, and never with a stale map."""

import numpy as np
import pymeshlab
import pytest
from conftest import (COMPUTE, EXAMPLES, FLAG, MIRROR, SELECT_FACES, SELECT_VERTICES, SYMMETRIZE, attributes,
                      example, select_vertices)

from intrinsym import Merge

MERGES = [("Swap the sides", Merge.SWAP), ("Average of both sides", Merge.AVERAGE),
          ("Side +1 wins", Merge.POSITIVE_WINS), ("Side -1 wins", Merge.NEGATIVE_WINS)]
ONE_LEG = "(z < 0.25) && (y > 0) && (x > 0)"


def test_vertex_selection(quadruped, detected_quadruped):
    chosen = select_vertices(quadruped, ONE_LEG)
    assert 20 < chosen.sum() < 1000
    expected = detected_quadruped.mirror_selection(chosen)
    outputs = quadruped.apply_filter(SELECT_VERTICES)
    assert np.array_equal(quadruped.current_mesh().vertex_selection_array(), expected)
    assert outputs == {"selected": expected.sum(), "recomputed": False}
    quadruped.apply_filter(SELECT_VERTICES, mode="Add to the selection")
    both = expected | detected_quadruped.mirror_selection(expected)
    assert np.array_equal(quadruped.current_mesh().vertex_selection_array(), both)
    middle = round(float(np.median(detected_quadruped.confidence[both])), 3)
    trusted = detected_quadruped.mirror_selection(both, minimum_confidence=middle)
    quadruped.apply_filter(SELECT_VERTICES, minimum_confidence=middle)
    assert np.array_equal(quadruped.current_mesh().vertex_selection_array(), trusted)
    assert trusted.sum() < both.sum()


def test_face_selection_is_exact_on_mirrored_connectivity():
    ms = example("human")
    ms.apply_filter(COMPUTE)
    truth = np.loadtxt(EXAMPLES / "human.mirror", dtype=int)
    ms.compute_selection_by_condition_per_face(condselect="(z0 > 0.4) && (x0 > 0.1)")
    mesh = ms.current_mesh()
    polygons = [tuple(polygon) for polygon in mesh.polygonal_face_list()]
    chosen = mesh.face_selection_array()
    assert 100 < chosen.sum() < 10000
    outputs = ms.apply_filter(SELECT_FACES)
    found = ms.current_mesh().face_selection_array()
    assert outputs["selected"] == found.sum()
    # Both triangles of a quad belong together; a quad's image is the quad of the partners.
    quads = {frozenset(polygon): index for index, polygon in enumerate(polygons)}
    owner = {frozenset(face): index for index, face in enumerate(map(tuple, mesh.face_matrix()))}
    triangles_of = [[owner[key] for key in map(frozenset, triangles(polygon)) if key in owner]
                    for polygon in polygons]
    for index, polygon in enumerate(polygons):
        image = quads[frozenset(truth[list(polygon)])]
        was = any(chosen[triangle] for triangle in triangles_of[image])
        assert all(found[triangle] == was for triangle in triangles_of[index])


def triangles(polygon):
    """All triangles between the corners of a quad."""
    return [[corner for corner in polygon if corner != left] for left in polygon] if len(polygon) == 4 else [polygon]


@pytest.mark.parametrize("name, merge", MERGES)
def test_quality_and_colour(quadruped, detected_quadruped, name, merge):
    quadruped.compute_scalar_by_function_per_vertex(q="x * x + 3 * x + y - z")
    quadruped.compute_color_by_function_per_vertex(x="127 + 127 * sin(9 * z)", y="100 + 100 * x", z="7",
                                                  a="200 - 50 * y")
    mesh = quadruped.current_mesh()
    quality = detected_quadruped.mirror_values(mesh.vertex_scalar_array(), merge=merge)
    bytes_before = np.rint(255 * mesh.vertex_color_matrix())
    colour = detected_quadruped.mirror_values(bytes_before, merge=merge)
    outputs = quadruped.apply_filter(MIRROR, attribute="Quality", merge=name)
    quadruped.apply_filter(MIRROR, attribute="Color", merge=name)
    mesh = quadruped.current_mesh()
    assert outputs == {"recomputed": False}
    assert np.array_equal(mesh.vertex_scalar_array(), quality)
    # Halves are rounded away from zero by the plugin.
    assert np.array_equal(np.rint(255 * mesh.vertex_color_matrix()), np.floor(colour + 0.5))


def test_custom_attributes(quadruped, detected_quadruped):
    mesh = quadruped.current_mesh()
    random = np.random.default_rng(1)
    number, vector = random.normal(size=mesh.vertex_number()), random.normal(size=(mesh.vertex_number(), 3))
    mesh.add_vertex_custom_scalar_attribute(number, "weight")
    mesh.add_vertex_custom_point_attribute(vector, "push")
    how = {"attribute": "Custom attribute", "merge": "Swap the sides", "weight_by_confidence": True}
    same = {"merge": Merge.SWAP, "weight_by_confidence": True}
    quadruped.apply_filter(MIRROR, custom_name="weight", **how)
    assert np.array_equal(mesh.vertex_custom_scalar_attribute_array("weight"),
                          detected_quadruped.mirror_values(number, **same))
    quadruped.apply_filter(MIRROR, custom_name="push", **how)
    mirrored = detected_quadruped.mirror_values(vector, **same)
    assert np.array_equal(mesh.vertex_custom_point_attribute_matrix("push"), mirrored)
    quadruped.apply_filter(MIRROR, custom_name="push", as_displacement=True, **how)
    carried = detected_quadruped.carry_displacement(mesh.vertex_matrix(), mirrored, **same)
    assert np.array_equal(mesh.vertex_custom_point_attribute_matrix("push"), carried)


@pytest.mark.parametrize("name, merge", MERGES[1:3])
def test_symmetrize(quadruped, detected_quadruped, name, merge):
    before = quadruped.current_mesh().vertex_matrix()
    outputs = quadruped.apply_filter(SYMMETRIZE, merge=name)
    expected = detected_quadruped.symmetrize_positions(before, merge=merge)
    assert np.array_equal(quadruped.current_mesh().vertex_matrix(), expected)
    moved = np.linalg.norm(expected - before, axis=1)
    assert outputs["max_displacement"] == pytest.approx(moved.max(), rel=1e-12)
    assert outputs["mean_displacement"] == pytest.approx(moved.mean(), rel=1e-12)


def test_a_bump_is_flagged_on_both_sides():
    ms = example("human")
    ms.apply_filter(COMPUTE)
    posed = ms.apply_filter(FLAG)
    ms.apply_filter(SYMMETRIZE)
    even = ms.apply_filter(FLAG)
    assert even["max_asymmetry"] < 0.5 * posed["max_asymmetry"]
    assert even["mean_asymmetry"] < posed["mean_asymmetry"]
    mesh = ms.current_mesh()
    truth = np.loadtxt(EXAMPLES / "human.mirror", dtype=int)
    top = np.argmin(np.linalg.norm(mesh.vertex_matrix() - [0.12, -0.1, -0.1], axis=1))
    # Three centimetres high and wide, on one thigh.
    ms.compute_normal_per_vertex()
    offsets = (f"({axis} - {value})" for axis, value in zip("xyz", mesh.vertex_matrix()[top]))
    height = "0.03 * exp(-(" + " + ".join(f"{offset} * {offset}" for offset in offsets) + ") / 0.0009)"
    ms.compute_coord_by_function(x=f"x + nx * {height}", y=f"y + ny * {height}", z=f"z + nz * {height}")
    outputs = ms.apply_filter(FLAG, threshold=pymeshlab.PureValue(0.01))
    mesh = ms.current_mesh()
    flagged, quality = mesh.vertex_selection_array(), mesh.vertex_scalar_array()
    assert not outputs["recomputed"] and outputs["selected"] == flagged.sum()
    assert np.array_equal(flagged, quality > 0.01)
    assert 0.024 < quality[top] < 0.033 and quality[truth[top]] > 0.02
    assert outputs["max_asymmetry"] == quality.max()


def test_a_stale_map_is_found_again_and_a_moved_mesh_keeps_its_own(quadruped):
    before = attributes(quadruped.current_mesh())["sym_vertex"]
    quadruped.compute_matrix_from_rotation(rotaxis="X axis", angle=30)
    quadruped.apply_coord_taubin_smoothing()
    select_vertices(quadruped, ONE_LEG)
    assert quadruped.apply_filter(SELECT_VERTICES)["recomputed"] is False
    quadruped.compute_selection_by_condition_per_face(condselect="z0 > 1.5")
    quadruped.meshing_remove_selected_faces()
    quadruped.meshing_remove_unreferenced_vertices()
    assert quadruped.current_mesh().vertex_number() < len(before)
    select_vertices(quadruped, "z < 0.25")
    assert quadruped.apply_filter(SELECT_VERTICES)["recomputed"] is True
    after = attributes(quadruped.current_mesh())["sym_vertex"]
    assert len(after) == quadruped.current_mesh().vertex_number() and after.max() < len(after)
    assert quadruped.apply_filter(SELECT_VERTICES)["recomputed"] is False


def test_a_tool_without_a_map_finds_one(detected_quadruped):
    ms = example("quadruped")
    chosen = select_vertices(ms, ONE_LEG)
    assert ms.apply_filter(SELECT_VERTICES)["recomputed"] is True
    assert np.array_equal(ms.current_mesh().vertex_selection_array(), detected_quadruped.mirror_selection(chosen))
