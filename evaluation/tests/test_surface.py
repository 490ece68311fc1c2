"""Distances along a mesh, against ones that are known."""

import numpy as np
import pytest

from evaluation.surface import Surface, opposite_half_edges


def sheet(columns=13, rows=9, fold=0.0):
    """A sheet of unit squares, optionally folded along x = 6, which changes no distance along it."""
    x, y = (part.ravel().astype(float) for part in np.meshgrid(np.arange(columns), np.arange(rows)))
    corner = np.array([row * columns + column for row in range(rows - 1) for column in range(columns - 1)])
    triangles = np.concatenate(
        [np.c_[corner, corner + 1, corner + columns], np.c_[corner + 1, corner + columns + 1, corner + columns]]
    )
    beyond = np.maximum(x - 6, 0)
    return np.c_[x - beyond + beyond * np.cos(fold), y, beyond * np.sin(fold)], triangles


@pytest.mark.parametrize("fold", [0.0, 1.3])
def test_a_folded_sheet_has_the_distances_of_the_flat_one(fold):
    vertices, triangles = sheet(fold=fold)
    surface, flat = Surface(vertices, triangles), sheet()[0]
    rng = np.random.default_rng(0)
    starts, ends = rng.integers(len(flat), size=(2, 200))
    true = np.linalg.norm(flat[starts] - flat[ends], axis=1) / surface.unit
    found = surface.distances(starts, ends)
    assert (found >= true - 1e-9).all() and (found <= 1.05 * true + 1e-9).all()
    assert (found / np.maximum(true, 1e-9))[true > 0].mean() < 1.005


def test_lines_across_triangles_are_straight_and_seen():
    vertices, triangles = sheet()
    graph = Surface(vertices, triangles).graph.tocoo()
    straight = np.linalg.norm(vertices[graph.row] - vertices[graph.col], axis=1) / np.sqrt(12 * 8)
    assert np.abs(graph.data - straight).max() < 1e-12
    assert graph.nnz > 12 * len(vertices)  # far more than the edges


def test_exact_distances_are_never_longer():
    vertices, triangles = sheet(fold=1.3)
    surface = Surface(vertices, triangles)
    for start, end in [(0, 116), (3, 90), (12, 104)]:
        flat = np.linalg.norm(sheet()[0][start] - sheet()[0][end]) / surface.unit
        assert surface.exact_distance(start, end) == pytest.approx(flat)
        assert surface.distances([start], [end])[0] >= flat - 1e-9


@pytest.mark.filterwarnings("error")
def test_triangles_without_area_change_no_distance():
    vertices, triangles = sheet()
    # A slit along the edge from 58 to 59 that two triangles without area fill; 117 lies where 58 does.
    below = (triangles == 58).any(1) & (vertices[triangles][..., 1].mean(1) < 4)
    split = np.where(below[:, None] & (triangles == 58), 117, triangles)
    filled = np.r_[split, [[58, 117, 59], [117, 58, 57]]]
    surface, whole = Surface(np.r_[vertices, vertices[58:59]], filled), Surface(vertices, triangles)
    pairs = np.random.default_rng(0).integers(117, size=(2, 300))
    found, true = surface.distances(*pairs), whole.distances(*pairs)
    assert np.isfinite(found).all() and (found >= true - 1e-9).all() and (found <= 1.05 * true + 1e-9).all()


def test_pieces_that_do_not_touch_are_infinitely_far():
    vertices, triangles = sheet(4, 4)
    surface = Surface(np.r_[vertices, vertices + 10], np.r_[triangles, triangles + 16])
    assert np.isinf(surface.distances([0], [20])[0]) and surface.distances([17], [17])[0] == 0


def test_an_edge_of_three_triangles_is_not_crossed():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1.0]])
    triangles = np.array([[0, 1, 2], [1, 0, 3], [1, 0, 4]])
    assert (opposite_half_edges(triangles, 5) == -1).all()
    two = opposite_half_edges(triangles[:2], 5)
    assert two[0] == 3 and two[3] == 0 and (np.delete(two, [0, 3]) == -1).all()
    assert Surface(vertices, triangles).distances([2], [3])[0] == pytest.approx(2 / np.sqrt(1.5))
