"""An ablation's tables say what the rows say, and the development sets come again as they were."""

import json

import numpy as np
import pytest

from evaluation import ablate, ablate_tables, development
from training import damage


def rows_of(errors, variant, name="animal", plausibility=0.9, cpu=1.0):
    make = lambda index, error: {"set": name, "name": f"{name}-{index}", "variant": variant, "error": error,
                                 "plausibility": plausibility, "cpu": cpu}  # fmt: skip
    return [make(index, error) for index, error in enumerate(errors)]


def test_a_change_leaves_out_what_is_wrong_either_way():
    before, after = np.array([0.01, 0.02, 0.02, 0.5]), np.array([0.02, 0.04, 0.3, 0.01])
    assert ablate_tables.change(before, after) == pytest.approx((100, 100, 100))
    assert np.isnan(ablate_tables.change(before[3:], after[3:])).all()


def test_the_interval_holds_the_change():
    rng = np.random.default_rng(1)
    before = rng.uniform(0.01, 0.03, 40)
    middle, low, high = ablate_tables.change(before, before * rng.uniform(0.9, 1.2, 40))
    assert low < middle < high and high - low < 10


def test_tables_count_wrong_and_accepted_maps():
    rows = rows_of([0.01, 0.02], "today") + rows_of([0.02, 0.4], "less", cpu=0.5)
    rows += rows_of([None, None], "today", "none", 0.2) + rows_of([None, None], "less", "none", 0.6)
    text = ablate_tables.summary(rows, ["today", "less"])
    assert "| today | +0.0 [0.0, 0.0] | 0 | 2 | 0 | 1.00 | 1.00 |" in text
    assert "| less | +100.0 [100.0, 100.0] | 1 | 2 | 2 | 0.50 | 1.00 |" in text
    assert "| animal | 2 | 0.0150 | 0 | **+100** (+1 wrong) |" in ablate_tables.by_set(rows, ["today", "less"])


def test_a_mesh_that_a_variant_lacks_is_left_out():
    rows = rows_of([0.01, 0.02], "today") + rows_of([0.01], "less")
    assert ablate_tables.complete(rows, ["today", "less"]) == ["animal-0"]


def test_the_first_variant_changes_nothing():
    variants = json.loads(ablate.VARIANTS.read_text())
    assert next(iter(variants.values())) == {} and all(list(variants.values())[1:])


def test_each_set_has_a_seed_of_its_own():
    seeds = [chosen.seed for chosen in development.SETS.values()]
    assert len(set(seeds)) == len(seeds)
    assert sum(chosen.count for chosen in development.SETS.values()) >= 200


@pytest.mark.parametrize("name", ["plate", "furniture", "flipped"])
def test_a_development_shape_comes_again(name):
    chosen = development.SETS[name]
    index = next(k for k in range(12) if chosen.kinds[k % len(chosen.kinds)] != "person")
    chosen = development.DevelopmentSet(chosen.seed, (chosen.kinds[index % len(chosen.kinds)],), 1, chosen.damaged, chosen.mirrored)
    first, second = (chosen.draw(chosen.generator(), 0) for _ in range(2))
    assert np.array_equal(first[0].posed, second[0].posed) and np.array_equal(first[1], second[1])
    assert (first[1] >= 0).mean() > 0.9 and first[2]["truth_error"] < 0.02


def test_flipped_edges_keep_vertices_and_area():
    sample = development.DevelopmentSet(0, ("blob",), 1).draw(development.DevelopmentSet(0, ("blob",)).generator(), 0)[0]
    flipped = damage.flip_edges(np.random.default_rng(0), sample, 0.1)
    changed = (flipped.faces != sample.faces).any(axis=1).mean()
    assert 0.2 < changed <= 0.3 + 1e-9  # two triangles an edge, three edges for two triangles
    edges = lambda faces: {tuple(edge) for face in faces for edge in zip(face, np.roll(face, -1))}
    assert len(edges(flipped.faces)) == len(edges(sample.faces)) == 3 * len(sample.faces)
