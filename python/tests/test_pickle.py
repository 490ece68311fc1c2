"""What was found crosses to another process: meshes, detections and symmetries can be pickled."""

from __future__ import annotations

import multiprocessing
import pickle

import numpy as np

import intrinsym


def assert_same(one: intrinsym.Symmetry, other: intrinsym.Symmetry) -> None:
    for name in ("kind", "evidence"):
        assert getattr(one, name) == getattr(other, name), name
    for name in ("partner", "confidence", "side"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    for name in ("faces", "corners", "barycentrics"):
        np.testing.assert_array_equal(getattr(one.surface_points, name), getattr(other.surface_points, name))
    assert len(one.fixed_curve) == len(other.fixed_curve) > 0
    for line, again in zip(one.fixed_curve, other.fixed_curve):
        np.testing.assert_array_equal(line.edges, again.edges)
        np.testing.assert_array_equal(line.parameters, again.parameters)
        assert line.closed == again.closed


def test_a_detection_is_the_same_after_a_pickle(quadruped, detection):
    again = pickle.loads(pickle.dumps(detection))
    assert len(again) == len(detection) and again.report == detection.report
    assert again.continuous_family == detection.continuous_family
    assert_same(again[0], detection[0])
    values = np.arange(float(quadruped.vertex_count))
    np.testing.assert_array_equal(again[0].mirror_values(values), detection[0].mirror_values(values))
    assert quadruped.detect(previous=again).report.kept
    assert_same(pickle.loads(pickle.dumps(again))[0], detection[0])


def test_a_symmetry_and_a_mesh_are_the_same_after_a_pickle(quadruped, symmetry):
    assert_same(pickle.loads(pickle.dumps(symmetry)), symmetry)
    again = pickle.loads(pickle.dumps(quadruped))
    assert again.connectivity_hash == quadruped.connectivity_hash
    np.testing.assert_array_equal(again.vertices, quadruped.vertices)


def test_finding_none_is_the_same_after_a_pickle(loose_triangles):
    none = pickle.loads(pickle.dumps(loose_triangles.detect()))
    assert not none and none.outcome == "none"
    assert not loose_triangles.detect(previous=none)


def detect_in_child(mesh: intrinsym.Mesh) -> intrinsym.Detection:
    return mesh.detect(effort="fast")


def test_a_detection_comes_back_from_another_process(quadruped):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found = pool.apply(detect_in_child, (quadruped,))
    assert_same(found[0], quadruped.detect(effort="fast")[0])
