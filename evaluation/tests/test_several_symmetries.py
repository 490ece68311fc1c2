"""The solids whose symmetries are counted, and the judge of what is listed."""

import numpy as np
import pytest

from evaluation.several_symmetries import SOLIDS, Map, isometries, judge, kind, meshed, order, same_symmetry


@pytest.mark.parametrize(
    "name, reflections, half_turns, rotations",
    [("box 1 : 1.5 : 2", 4, 3, []), ("cube", 10, 9, [3, 3, 3, 3, 4, 4, 4]), ("tetrahedron", 6, 3, [3, 3, 3, 3]),
     ("triangular prism", 4, 3, [3]), ("table", 2, 1, []), ("star of 5 arms", 6, 5, [5]),
     ("bent star of 4 arms", 2, 1, [4]), ("hexagonal prism", 8, 7, [6]),
     ("pinwheel of 3 arms", 0, 0, [3]), ("dodecahedron", 16, 15, [3] * 10 + [5] * 6)],
)
def test_a_solid_has_its_own_isometries(name, reflections, half_turns, rotations):
    group = isometries(SOLIDS[name])
    kinds = [kind(matrix) for matrix in group]
    assert (kinds.count("reflection"), kinds.count("half_turn")) == (reflections, half_turns)
    cyclic = {same_symmetry(matrix, group) for matrix in group if kind(matrix) == "rotation"}
    assert sorted(len(powers) for powers in cyclic) == rotations


def test_true_repeated_and_other_maps_are_told_apart():
    solid = SOLIDS["box 1 : 1.5 : 2"]
    vertices, faces = meshed(solid, np.eye(3))
    nearest = lambda image: np.linalg.norm(vertices[:, None] - image, axis=2).argmin(0)
    mirror, turn = nearest(vertices * [-1, 1, 1]), nearest(vertices * [-1, -1, 1])
    itself, swapped = np.arange(len(vertices)), nearest(vertices[:, [1, 0, 2]])
    maps = [Map("reflection", 2, mirror), Map("half_turn", 2, turn), Map("reflection", 2, mirror),
            Map("reflection", 2, itself), Map("reflection", 2, swapped)]
    listed = judge(vertices, faces, maps, isometries(solid))
    assert (listed.true, listed.repeated, listed.other) == ({"reflection": 1, "half_turn": 1}, 1, 2)


def test_rotations_are_counted_by_their_cyclic_groups():
    solid = SOLIDS["square bar 1 : 1 : 4"]
    vertices, faces = meshed(solid, np.eye(3))
    nearest = lambda image: np.linalg.norm(vertices[:, None] - image, axis=2).argmin(0)
    once = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    quarter, back, half = (nearest(vertices @ m.T) for m in (once, once.T, once @ once))
    maps = [Map("rotation", 4, quarter), Map("rotation", 4, back), Map("rotation", 3, quarter), Map("rotation", 4, half)]
    listed = judge(vertices, faces, maps, isometries(solid))
    assert (listed.true, listed.repeated, listed.other) == ({"rotation": 1}, 1, 2)
    assert (order(once), order(once @ once), order(np.eye(3))) == (4, 2, 1)
