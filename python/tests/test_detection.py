"""Detection: the same as the command line, by every way in."""

from __future__ import annotations

import json
from dataclasses import asdict, fields

import numpy as np
import pytest
from conftest import EXAMPLES, truth_of

import intrinsym


def test_partners_and_report_are_those_of_the_command_line(command_line, detection, symmetry):
    out = command_line(
        "detect", EXAMPLES / "quadruped.ply", "--map", "map", "--json", "json", "--output", "out.ply"
    )
    assert np.array_equal(np.loadtxt(out / "map", dtype=np.int64), symmetry.partner)
    theirs = json.loads((out / "json").read_text())
    assert theirs["symmetries"] == detection.report.json["symmetries"]
    assert theirs["symmetries"][0]["plausibility"] == pytest.approx(symmetry.plausibility, abs=1e-9)


def test_a_posed_human_of_quads_gives_its_exact_mirror_table():
    mesh = intrinsym.Mesh.read(EXAMPLES / "human.ply")
    (found,) = mesh.detect()
    assert found.kind is intrinsym.SymmetryKind.REFLECTION
    assert found.exact_share == 1.0
    assert 0.95 < found.plausibility <= 1
    assert np.array_equal(found.partner, truth_of("human"))
    (line,) = found.fixed_curve
    assert line.closed
    own = found.partner == np.arange(mesh.vertex_count)
    assert np.array_equal(np.flatnonzero(own), np.unique(line.edges[own[line.edges]]))


def test_a_lump_is_not_found_to_have_a_symmetry():
    found = intrinsym.Mesh.read(EXAMPLES / "blob.ply").detect()
    assert found.outcome is not intrinsym.Outcome.FOUND and "plausibility" in found.evidence


def test_no_symmetry_is_an_empty_answer_with_its_evidence(loose_triangles):
    found = loose_triangles.detect()
    assert not found and len(found) == 0
    assert found.outcome is intrinsym.Outcome.NONE
    assert "nothing_said" in [reason.name for reason in found.report.reasons]


def test_a_doubtful_answer_holds_its_map_and_what_speaks_against_it(quadruped):
    found = quadruped.detect(plausibility=100)
    assert found.outcome is intrinsym.Outcome.DOUBTFUL == found.report.json["outcome"]
    assert found and found[0].partner.min() >= 0
    best_map, doubt = found.report.reasons
    assert (best_map.name, doubt.name) == ("best_map", "low_plausibility")
    assert best_map.figures["accepted_from"] == 100 and doubt.figures == {}
    assert best_map.figures["judged"] == asdict(found.report.judged)


def test_every_number_of_the_report_is_a_field(detection):
    report, whole = detection.report, detection.report.json
    names = {field.name for field in fields(report)}
    assert set(whole["report"]) <= names
    assert asdict(report.repairs) == whole["report"]["repairs"] and asdict(report.judged) == whole["report"]["judged"]
    assert [asdict(sign) for sign in report.signs] == whole["report"]["signs"]
    typed = {name for part in (report.symmetries[0], detection[0].evidence) for name in asdict(part)}
    assert set(whole["symmetries"][0]) == typed | {"kind"}


def test_shells_are_counted():
    best = intrinsym.Mesh.read(EXAMPLES / "human_shells.ply").detect()[0]
    evidence = best.evidence
    counts = evidence.shells_paired, evidence.shells_self_mirrored, evidence.shells_alone
    assert sum(counts) == 10 and counts[0] >= 2 and counts[0] % 2 == 0, counts
    assert evidence.paired_share > 0.9


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("index", [np.uint8, np.int16, np.int64, np.uint64])
def test_any_float_and_any_integer(real, index):
    vertices = np.array([[0, 0, 0], [2, 0, 0], [1, 2, 0], [1, 0.7, 2]], real)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], index)
    mesh = intrinsym.Mesh(vertices, faces)
    assert np.array_equal(mesh.vertices, vertices.astype(np.float64))
    assert np.array_equal(mesh.polygons.corners, faces.reshape(-1))


def test_arrays_in_any_layout_give_the_same_map(quadruped, symmetry):
    offsets, corners = quadruped.polygons
    assert np.all(np.diff(offsets) == 3)
    backwards = np.asfortranarray(corners.reshape(-1, 3))
    found = intrinsym.detect(np.asfortranarray(quadruped.vertices), backwards)
    assert np.array_equal(found[0].partner, symmetry.partner)


def test_quads_as_table_and_as_polygons_are_one_mesh():
    mesh = intrinsym.Mesh.read(EXAMPLES / "human.ply")
    offsets, corners = mesh.polygons
    assert np.all(np.diff(offsets) == 4)
    table = intrinsym.Mesh(mesh.vertices, corners.reshape(-1, 4))
    polygons = intrinsym.Mesh(mesh.vertices, intrinsym.Polygons(offsets.tolist(), corners.tolist()))
    assert table.connectivity_hash == polygons.connectivity_hash == mesh.connectivity_hash
    assert table.face_count == mesh.face_count


def test_options_and_known_signs_reach_the_library(quadruped):
    found = quadruped.detect(eigenfunctions=30, samples=500, known_signs=[0, 0, 1])
    assert found.report.options["eigenfunctions"] == 30
    assert found.report.options["known_signs"] == [0, 0, 1]


def test_surface_points_lie_where_the_partners_do(quadruped, symmetry):
    points = symmetry.surface_points
    images = points.positions(quadruped.vertices)
    assert np.allclose(points.barycentrics.sum(axis=1), 1, atol=1e-5)
    corners = quadruped.polygons.corners.reshape(-1, 3)[points.faces]
    assert np.array_equal(np.sort(corners, axis=1), np.sort(points.corners, axis=1))
    longest_edge = np.linalg.norm(np.diff(quadruped.vertices[corners], axis=1), axis=2).max()
    distance = np.linalg.norm(images - quadruped.vertices[symmetry.partner], axis=1)
    assert np.all(distance <= 2 * longest_edge)


def test_eigenpairs_are_orthonormal_and_those_of_the_command_line(command_line, quadruped):
    pairs = quadruped.eigen(20)
    assert np.all(np.diff(pairs.values) >= 0)
    gram = pairs.functions.T @ (pairs.mass[:, None] * pairs.functions)
    assert np.allclose(gram, np.eye(20), atol=1e-4)
    assert pairs.mass.sum() == pytest.approx(1)


def test_a_stored_map_can_be_used_again(quadruped, symmetry):
    stored = (symmetry.kind, symmetry.partner, symmetry.confidence, symmetry.side, symmetry.surface_points)
    again = quadruped.restore(*stored)
    weights = np.linspace(0, 1, quadruped.vertex_count)
    assert np.array_equal(again.mirror_values(weights), symmetry.mirror_values(weights))
    assert np.array_equal(again.partner, symmetry.partner)
    with pytest.raises(intrinsym.ArgumentError, match="3398"):
        quadruped.restore(symmetry.kind, np.full(3398, 3398), *stored[2:])
    with pytest.raises(intrinsym.ArgumentError, match="vertex 0 has the partner -2; there are 3398"):
        quadruped.restore(symmetry.kind, np.full(3398, -2), *stored[2:])


def test_a_deformed_shape_keeps_its_map_and_another_shape_does_not(quadruped, detection, symmetry):
    vertices, polygons = quadruped.vertices, quadruped.polygons
    moved = vertices * [1.0, 1.1, 0.9]
    found = intrinsym.detect(moved, polygons, previous=detection)
    assert found.report.kept
    assert np.array_equal(found[0].partner, symmetry.partner)
    assert np.array_equal(found[0].confidence, symmetry.confidence)
    assert len(found[0].fixed_curve) == len(symmetry.fixed_curve)
    # What was found while deforming starts the next call as well, and so does one of its symmetries.
    for previous in (found, found[0]):
        third = intrinsym.detect(vertices, polygons, previous=previous)
        assert third.report.kept
        assert np.array_equal(third[0].partner, symmetry.partner)
    # The same numbers of vertices and faces, but shuffled: another shape of another connectivity.
    shuffled = np.random.default_rng(0).permutation(len(vertices))
    with pytest.raises(intrinsym.ArgumentError, match="another connectivity"):
        intrinsym.Mesh(vertices, intrinsym.Polygons(polygons.offsets, shuffled[polygons.corners])).detect(
            previous=detection
        )
    # Partners that are no symmetry, from a stored map.
    stored = (symmetry.kind, np.roll(symmetry.partner, 1000), symmetry.confidence, symmetry.side)
    wrong = quadruped.restore(*stored, symmetry.surface_points)
    anew = quadruped.detect(previous=wrong)
    assert not anew.report.kept
    assert np.array_equal(anew[0].partner, symmetry.partner)


def test_partners_share_a_colour_and_other_pairs_do_not(symmetry):
    colours = symmetry.pair_colours
    sure = symmetry.confidence > 0.5
    paired = sure & sure[symmetry.partner] & (symmetry.partner[symmetry.partner] == np.arange(len(sure)))
    assert paired.sum() > 1000
    difference = np.abs(colours[paired].astype(int) - colours[symmetry.partner[paired]])
    assert np.median(difference.max(axis=1)) < 8
    assert len(np.unique(colours, axis=0)) > 1000


def test_distances_from_the_curve_are_at_least_those_in_space_and_at_most_those_along_its_edges(quadruped, symmetry):
    vertices = quadruped.vertices
    distances = symmetry.curve_distances(vertices)
    edges = np.concatenate([line.edges for line in symmetry.fixed_curve])
    points = np.concatenate([line.positions(vertices) for line in symmetry.fixed_curve])
    lengths = np.linalg.norm(np.diff(vertices[edges], axis=1)[:, 0], axis=1)
    assert np.all(distances[edges].sum(axis=1) <= 1.001 * lengths)
    for vertex in range(0, len(vertices), 97):
        # The curve goes on between its points, which are no farther apart than an edge is long.
        in_space = np.linalg.norm(points - vertices[vertex], axis=1).min() - lengths.max()
        assert distances[vertex] >= in_space
    with pytest.raises(intrinsym.ArgumentError, match="positions"):
        symmetry.curve_distances(vertices[1:])
