"""The solids whose symmetries are counted, and the judge of what is listed."""

import numpy as np
import pytest

from evaluation.several_symmetries import SOLIDS, Map, isometries, judge, kind, meshed


@pytest.mark.parametrize(
    "name, reflections, half_turns",
    [("box 1 : 1.5 : 2", 4, 3), ("cube", 10, 9), ("tetrahedron", 6, 3), ("triangular prism", 4, 3), ("table", 2, 1),
     ("star of 5 arms", 6, 5), ("bent star of 4 arms", 2, 1), ("hexagonal prism", 8, 7), ("pinwheel of 3 arms", 0, 0),
     ("dodecahedron", 16, 15)],
)
def test_a_solid_has_its_own_isometries(name, reflections, half_turns):
    kinds = [kind(matrix) for matrix in isometries(SOLIDS[name])]
    assert (kinds.count("reflection"), kinds.count("half_turn")) == (reflections, half_turns)


def test_true_repeated_and_other_maps_are_told_apart():
    solid = SOLIDS["box 1 : 1.5 : 2"]
    vertices, faces = meshed(solid, np.eye(3))
    nearest = lambda image: np.linalg.norm(vertices[:, None] - image, axis=2).argmin(0)
    mirror, turn = nearest(vertices * [-1, 1, 1]), nearest(vertices * [-1, -1, 1])
    itself, swapped = np.arange(len(vertices)), nearest(vertices[:, [1, 0, 2]])
    maps = [Map("reflection", mirror), Map("half_turn", turn), Map("reflection", mirror),
            Map("reflection", itself), Map("reflection", swapped)]
    listed = judge(vertices, faces, maps, isometries(solid))
    assert (listed.true, listed.repeated, listed.other) == ({"reflection": 1, "half_turn": 1}, 1, 2)
