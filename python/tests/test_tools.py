"""The tools that mirror across a symmetry."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import EXAMPLES, truth_of

import intrinsym
from intrinsym import Merge


@pytest.fixture(scope="module")
def human() -> intrinsym.Mesh:
    return intrinsym.Mesh.read(EXAMPLES / "human.ply")


@pytest.fixture(scope="module")
def exact(human) -> intrinsym.Symmetry:
    return human.detect()[0]


def test_swapped_values_are_the_partners(human, exact):
    values = np.random.default_rng(1).random((human.vertex_count, 2, 2))
    assert np.array_equal(exact.mirror_values(values), values[truth_of("human")])


def test_a_winning_side_and_the_fixed_curve_stay(human, exact):
    values = np.arange(human.vertex_count, dtype=float)
    mirrored = exact.mirror_values(values, Merge.POSITIVE_WINS)
    changed = exact.side == -1
    assert np.array_equal(mirrored[~changed], values[~changed])
    assert np.array_equal(mirrored[changed], values[exact.partner[changed]])


def test_average_is_its_own_image(human, exact):
    values = exact.mirror_values(np.random.default_rng(2).random(human.vertex_count), Merge.AVERAGE)
    assert np.allclose(values, values[exact.partner])


def test_selected_faces_are_mirrored_one_by_one(human, exact):
    offsets, corners = human.polygons
    faces = [frozenset(piece.tolist()) for piece in np.split(corners, offsets[1:-1])]
    number = {face: index for index, face in enumerate(faces)}
    truth = truth_of("human")
    chosen = np.zeros(len(faces), bool)
    chosen[::7] = True
    images = [number[frozenset(truth[list(face)].tolist())] for face in faces]
    assert np.array_equal(exact.mirror_face_selection(chosen), chosen[images])
    with pytest.raises(intrinsym.ArgumentError):
        exact.mirror_face_selection(chosen[1:])


def test_selection_of_one_hand_is_the_other(human, exact):
    chosen = np.zeros(human.vertex_count, bool)
    chosen[np.flatnonzero(exact.side == 1)[:200]] = True
    mirrored = exact.mirror_selection(chosen)
    assert np.array_equal(mirrored, chosen[truth_of("human")])
    assert not exact.mirror_selection(np.zeros(human.vertex_count, bool)).any()


def test_a_push_along_the_normal_is_carried_to_one_along_the_normal(human, exact):
    normals = vertex_normals(human)
    carried = exact.carry_displacement(human.vertices, normals, Merge.SWAP)
    cosine = np.einsum("vx,vx->v", carried, normals)
    assert np.median(cosine) > 0.99 and np.mean(cosine > 0.9) > 0.98


def test_a_bump_appears_on_the_other_side_and_the_pose_stays(human, exact):
    chosen = np.zeros(human.vertex_count, bool)
    chosen[np.flatnonzero(exact.side == 1)[:200]] = True
    bumped = human.vertices + 0.01 * chosen[:, None] * vertex_normals(human)
    moved = exact.symmetrize_positions(bumped, Merge.POSITIVE_WINS)
    stay = exact.side >= 0
    assert np.allclose(moved[stay], bumped[stay])
    step = np.linalg.norm(moved - human.vertices, axis=1)[exact.mirror_selection(chosen)]
    assert 0.005 < np.median(step) < 0.015


def vertex_normals(mesh: intrinsym.Mesh) -> np.ndarray:
    quads = mesh.polygons.corners.reshape(-1, 4)
    points = mesh.vertices[quads]
    face_normals = np.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 1])
    normals = np.zeros((mesh.vertex_count, 3))
    for corner in range(4):
        np.add.at(normals, quads[:, corner], face_normals)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
