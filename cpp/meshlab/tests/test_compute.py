# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute Intrinsic Symmetry against the command line, to the bit."""

import numpy as np
import pymeshlab
import pytest
from conftest import COMPUTE, EXAMPLES, CommandLine, attributes, example, loose_triangles, mesh_set, vertex_properties


@pytest.mark.parametrize("name", ["quadruped", "human_shells"])
def test_everything_equals_the_command_line_to_the_bit(name, tmp_path):
    said = CommandLine(EXAMPLES / f"{name}.ply", tmp_path)
    ms = example(name)
    outputs = ms.apply_filter(COMPUTE)
    mesh = ms.current_mesh()
    found = attributes(mesh)
    assert np.array_equal(found["sym_vertex"], said.vertex["sym_vertex"])
    assert np.array_equal(found["sym_confidence"].astype(np.float32), said.vertex["sym_confidence"])
    assert np.array_equal(found["sym_side"], said.vertex["sym_side"])
    colours = np.rint(255 * mesh.vertex_color_matrix()).astype(int)
    assert np.array_equal(colours[:, :3], np.stack([said.vertex[k] for k in ("red", "green", "blue")], 1))
    assert (colours[:, 3] == 255).all()
    assert np.array_equal(mesh.vertex_scalar_array(), found["sym_confidence"])
    symmetry = said.report["symmetries"][0]
    for key in ("score", "mean_confidence", "exact_share"):
        assert outputs[key] == symmetry[key]
    assert outputs["found"] and outputs["symmetries_found"] == 1 and outputs["is_reflection"]
    assert not outputs["doubtful"] and outputs["paired_share"] == symmetry["paired_share"]
    for key in ("shells_paired", "shells_self_mirrored", "shells_alone"):
        assert outputs[key] == symmetry[key]
    assert 0 < outputs["seconds"] < 600


def test_surface_points_and_mirror_line_equal_the_library_to_the_bit(detected_quadruped):
    ms = example("quadruped")
    ms.apply_filter(COMPUTE, mirror_line=True)
    assert len(ms) == 2 and ms.current_mesh_id() == 0
    mesh, line = ms.mesh(0), ms.mesh(1)
    found, points = attributes(mesh), detected_quadruped.surface_points
    assert np.array_equal(found["sym_face"], points.faces)
    assert np.array_equal(found["sym_corners"], points.corners)
    assert np.array_equal(found["sym_barycentrics"].astype(np.float32), points.barycentrics)
    corners = mesh.face_matrix()[found["sym_face"].astype(int)]
    assert np.array_equal(np.sort(corners, 1), np.sort(found["sym_corners"], 1))
    lines = detected_quadruped.fixed_curve
    expected = np.concatenate([piece.positions(mesh.vertex_matrix()) for piece in lines])
    assert np.abs(line.vertex_matrix() - expected).max() < 1e-12
    assert line.edge_number() == sum(len(piece.edges) - (not piece.closed) for piece in lines)
    assert line.face_number() == 0


def test_quality_shows_what_is_asked_for(detected_quadruped):
    ms = example("quadruped")
    ms.apply_filter(COMPUTE, quality="Side", colorize=False)
    mesh = ms.current_mesh()
    assert np.array_equal(mesh.vertex_scalar_array(), detected_quadruped.side)
    assert not mesh.has_vertex_color()
    ms.apply_filter(COMPUTE, quality="Distance to the mirror line")
    distance = ms.current_mesh().vertex_scalar_array()
    assert distance.min() >= 0 and mesh.has_vertex_color()
    # No shorter than through the air to the line, and hardly longer than along the edges of the mesh.
    line = np.concatenate([piece.positions(mesh.vertex_matrix()) for piece in detected_quadruped.fixed_curve])
    through_air = np.linalg.norm(mesh.vertex_matrix()[:, None] - line[None], axis=2).min(1)
    edge = np.linalg.norm(np.diff(mesh.vertex_matrix()[mesh.face_matrix()], axis=1), axis=2).max()
    assert (distance > through_air - edge).all() and distance.max() > 2 * edge
    ms.apply_filter(COMPUTE, quality="Leave as it is")
    assert np.array_equal(ms.current_mesh().vertex_scalar_array(), distance)


def test_a_box_has_several_symmetries_and_each_has_its_attributes(tmp_path):
    ms = pymeshlab.MeshSet()
    ms.create_cube()
    ms.meshing_isotropic_explicit_remeshing(targetlen=pymeshlab.PercentageValue(4))
    ms.apply_coord_laplacian_smoothing(stepsmoothnum=1)
    mesh = ms.current_mesh()
    stretched = pymeshlab.Mesh(mesh.vertex_matrix() * [1.0, 1.6, 2.6], mesh.face_matrix())
    ms.add_mesh(stretched)
    ms.save_current_mesh(str(tmp_path / "box.ply"))
    ms = mesh_set(tmp_path / "box.ply")
    said = CommandLine(tmp_path / "box.ply", tmp_path, "--symmetries", "3")
    outputs = ms.apply_filter(COMPUTE, symmetries=3, symmetry=2, quality="Side")
    assert outputs["symmetries_found"] == len(said.report["symmetries"]) == 3
    assert outputs["score"] == said.report["symmetries"][1]["score"]
    for suffix in ("", "_2", "_3"):
        found = attributes(ms.current_mesh(), suffix)
        assert np.array_equal(found["sym_vertex"], said.vertex["sym_vertex" + suffix])
    assert np.array_equal(ms.current_mesh().vertex_scalar_array(), said.vertex["sym_side_2"])
    # Fewer the next time: none of the old ones stay.
    ms.apply_filter(COMPUTE)
    with pytest.raises(pymeshlab.PyMeshLabException):
        ms.current_mesh().vertex_custom_scalar_attribute_array("sym_vertex_2")


def test_no_symmetry_is_an_answer_and_leaves_no_map(tmp_path):
    ms = loose_triangles(tmp_path)
    outputs = ms.apply_filter(COMPUTE)
    assert outputs["found"] is False and outputs["symmetries_found"] == 0 and "score" not in outputs
    assert outputs["doubtful"] is False
    assert not ms.current_mesh().has_vertex_color()
    with pytest.raises(pymeshlab.PyMeshLabException):
        ms.current_mesh().vertex_custom_scalar_attribute_array("sym_vertex")


def test_a_doubtful_symmetry_is_called_so_and_its_map_kept():
    ms = example("quadruped")
    outputs = ms.apply_filter(COMPUTE, plausibility=100)
    assert outputs["doubtful"] and not outputs["found"] and outputs["symmetries_found"] == 1
    assert (attributes(ms.current_mesh())["sym_vertex"] >= 0).all()


def test_parameters_are_the_options_of_the_library():
    import intrinsym

    defaults = example("blob").filter_parameter_values(COMPUTE)
    for spec in intrinsym.option_specs():
        assert defaults[spec.name] == spec.default, spec.name
    assert defaults["symmetry"] == 1 and defaults["mirror_line"] is False


def test_the_map_can_be_exported(tmp_path):
    ms = example("quadruped")
    ms.apply_filter(COMPUTE)
    names = ["sym_vertex", "sym_confidence", "sym_side", "sym_face"]
    ms.save_current_mesh(str(tmp_path / "paired.ply"), **{f"__ca_vs__{name}": True for name in names})
    in_file = vertex_properties((tmp_path / "paired.ply").read_bytes())
    for name in names:
        assert np.array_equal(in_file[name], attributes(ms.current_mesh())[name]), name
