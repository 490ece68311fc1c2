"""Generated assemblies are the same each time, their truth is one, and the judge tells right from wrong."""

import numpy as np
import pytest

from evaluation import assemblies
from evaluation.assembly_kinds import KINDS
from evaluation.shells import Cut, Lathe, Sheet, ball, fused
from evaluation.surface import opposite_half_edges
from training.skeleton import MIRROR


def made(kind, number):
    return assemblies.laid_out(assemblies.draw(kind, number)[0])


def volume(vertices, faces):
    a, b, c = vertices[faces].transpose(1, 0, 2)
    return (a * np.cross(b, c)).sum() / 6


@pytest.mark.parametrize("kind", ["armour", "vehicle"])
def test_the_same_seed_makes_the_same_assembly(kind):
    first, second = made(kind, 2), made(kind, 2)
    assert np.array_equal(first[0], second[0]) and np.array_equal(first[1], second[1])
    assert all(np.array_equal(first[2][name], second[2][name], equal_nan=True) for name in first[2])
    assert len(made(kind, 1)[0]) != len(first[0])


@pytest.mark.parametrize("kind", KINDS)
def test_the_truth_is_an_involution_of_vertices_and_shells(kind):
    for number in (0, 3):
        vertices, faces, truth = made(kind, number)
        partner, twin, shell = truth["partner"], truth["shell_mirror"], truth["shell"]
        known = np.flatnonzero(partner >= 0)
        assert np.array_equal(partner[partner[known]], known)
        assert np.allclose(truth["rest"][partner[known]], truth["truth"][known], atol=1e-4)
        assert all(twin[twin[s]] == s for s in np.flatnonzero(twin >= 0))
        assert np.array_equal(shell[partner[known]], twin[shell[known]])
        assert (shell[faces] == shell[faces[:, :1]]).all() and len(np.unique(shell)) == len(twin)
        assert number == 0 or (partner == -1).any()
        assert number == 3 or (partner >= 0).all() or kind == "half-hair" or kind == "vehicle"


def test_a_pose_is_no_mirror_image_but_keeps_the_shapes():
    vertices, faces, truth = made("mannequin", 0)
    areas = [assemblies.triangle_areas(points, faces) for points in (vertices, truth["rest"])]
    assert np.allclose(*areas, rtol=1e-6)
    plane = assemblies.plane_partners(vertices)
    assert assemblies.near_share(plane, truth["rest"], truth["truth"], areas[1].sum()) < 0.8


def test_bodies_are_closed_and_face_outwards():
    cut = lambda style: Cut(style, np.random.default_rng(0))
    for style in ("same", "recut", "remeshed"):
        for axis in np.eye(3):
            vertices, faces = ball([0.1, 0, 0], [0.1, 0.2, 0.3], axis=axis).made(cut(style))
            assert volume(vertices, faces) > 0 and (opposite_half_edges(faces, len(vertices)) >= 0).all()
    vertices, faces = Lathe(np.array([[0, 0, 0], [0, 0, 1]]), [0.1, 0.2]).made(cut("same"))
    assert np.allclose(np.sort(vertices * MIRROR, axis=0), np.sort(vertices, axis=0))


def test_a_fused_prop_makes_one_closed_surface():
    cut = Cut("recut", np.random.default_rng(0))
    body, prop = ball([0, 0, 0], 0.2).made(cut), ball([0.3, 0, 0], 0.08).made(cut)
    vertices, faces = fused(body, prop)
    assert np.array_equal(vertices[: len(body[0])], body[0])
    assert (opposite_half_edges(faces, len(vertices)) >= 0).all()
    assert len(vertices) - len(faces) / 2 == 2  # Euler: one sphere


def test_a_sheet_is_as_wide_as_it_is_told():
    vertices, _ = Sheet(np.array([[0, 0, 0], [0, 1, 0]]), [0.2, 0.4], np.array([0, 0, 1.0]), 5, 2, 0.0).made(Cut("same", None))
    assert np.ptp(vertices[:, 0]) == pytest.approx(0.4)


def test_the_judge_tells_right_wrong_torn_and_missing_shells_apart():
    _, faces, truth = made("jointed", 0)
    right = assemblies.judge(truth["partner"], faces, truth)
    assert (right["near"], right["exact"], right["right"], right["own"]) == (1, 1, right["shells"], 0)
    itself = assemblies.judge(np.arange(len(truth["rest"])), faces, truth)
    pairs = int((truth["shell_mirror"] != np.arange(right["shells"])).sum())
    assert (itself["own"], itself["wrong"]) == (pairs, pairs) and itself["near"] < 0.6
    nothing = assemblies.judge(np.full(len(truth["rest"]), -1), faces, truth)
    assert (nothing["paired"], nothing["near"], nothing["unpaired"]) == (0, 0, right["shells"])
    torn = truth["partner"].copy()
    chosen = np.flatnonzero(truth["shell"] == 0)
    torn[chosen] = np.resize([np.flatnonzero(truth["shell"] == k)[0] for k in range(1, 5)], len(chosen))
    assert assemblies.judge(torn, faces, truth)["torn"] == 1


def test_what_has_no_counterpart_must_stay_alone():
    _, faces, truth = made("mannequin", 4)
    partners = truth["partner"].copy()
    assert (partners == -1).any() and assemblies.judge(partners, faces, truth)["none paired"] == 0
    partners[partners == -1] = 0
    row = assemblies.judge(partners, faces, truth)
    assert row["none paired"] == 1 and row["near"] == 1


def test_one_plane_is_enough_at_rest_but_not_in_a_pose():
    vertices, faces, truth = made("furniture", 0)
    area = assemblies.triangle_areas(truth["rest"], faces).sum()
    assert assemblies.near_share(assemblies.plane_partners(vertices), truth["rest"], truth["truth"], area) == 1


def test_files_are_read_as_written_and_counted_by_kind(tmp_path):
    assemblies.write(tmp_path, ["robot"])
    assert len(list(tmp_path.glob("*.ply"))) == len(assemblies.VARIANTS)
    path = tmp_path / "robot-0-same.ply"
    vertices, faces = assemblies.read_mesh(path)
    obj = tmp_path / "a.obj"
    obj.write_text("".join("v %r %r %r\n" % tuple(map(float, v)) for v in vertices) + "".join("f %d/1 %d %d\n" % tuple(f + 1) for f in faces))
    again = assemblies.read_mesh(obj)
    assert np.array_equal(again[0], vertices) and np.array_equal(again[1], faces)
    truth = np.load(path.with_suffix(".truth.npz"))
    row = assemblies.judge(truth["partner"], faces, truth) | {"kind": "robot", "outcome": "doubtful"}
    lines = assemblies.report({"date": "2000-01-01", "meshes": [row, row | {"near": 0.5, "outcome": "none"}]}).splitlines()
    assert lines[-1].startswith("| **all** | 1 of 2 | 75 |") and "| 0 / 1 / 1 |" in lines[-1]
