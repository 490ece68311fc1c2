"""Shapes and their mirror truth."""

import json

import numpy as np
import pytest

from training import damage
from training.creatures import ASYMMETRIC_KINDS, STOUT_KINDS, SYMMETRIC_KINDS
from training.generate import Generator
from training.lopsided import LOPSIDED_KINDS
from training.meshfile import read_ply, write_shape
from training.mirror_truth import NO_PARTNER, mean_edge, mirror_map
from training.skeleton import MIRROR


def volume(vertices, faces):
    a, b, c = vertices[faces].transpose(1, 0, 2)
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


@pytest.mark.parametrize("kind", [*SYMMETRIC_KINDS, *STOUT_KINDS])
def test_shared_connectivity_gives_an_exact_bijection(kind):
    sample, mirror, _ = Generator([kind], (600, 1500), damaged=False, remeshed_share=0).draw(3, 0)
    assert np.array_equal(mirror[mirror], np.arange(len(mirror)))
    assert np.abs(sample.rest[mirror] - sample.rest * MIRROR).max() < 1e-6 * np.ptp(sample.rest)
    assert volume(sample.rest, sample.faces) > 0


@pytest.mark.parametrize("kind", [*SYMMETRIC_KINDS, *STOUT_KINDS])
def test_remeshed_shapes_share_no_connectivity_but_keep_the_truth(kind):
    generator, there_and_back = Generator([kind], (600, 1500), damaged=False, remeshed_share=1), []
    for index in range(3):  # the grid's shift is random, and now and then nearly mirrors the grid
        sample, mirror, _ = generator.draw(4, index)
        edge = mean_edge(sample.rest, sample.faces)
        distance = np.linalg.norm(sample.rest[mirror] - sample.rest * MIRROR, axis=1)
        assert np.median(distance) < edge
        there_and_back.append((mirror[mirror] == np.arange(len(mirror))).mean())
    assert np.median(there_and_back) < 0.95


def test_posing_is_asymmetric():
    sample, mirror, _ = Generator(["biped"], (600, 1500), damaged=False, remeshed_share=0).draw(5, 0)
    straight = np.abs(sample.posed[mirror] - sample.posed * MIRROR).max()
    assert straight > 0.05 * np.ptp(sample.posed)


def test_a_shape_depends_on_seed_and_index_only():
    first = Generator(["bird", "insect"], (500, 900))
    second = Generator(["bird", "insect"], (500, 900))
    first.draw(7, 0)
    assert np.array_equal(first.draw(7, 1)[0].posed, second.draw(7, 1)[0].posed)


@pytest.mark.parametrize("kind", [*ASYMMETRIC_KINDS, *LOPSIDED_KINDS])
def test_asymmetric_shapes_have_no_partners(kind):
    _, mirror, description = Generator([kind], (600, 1500)).draw(8, 0)
    assert (mirror == NO_PARTNER).all() and not description["symmetric"]


def test_a_cut_limb_leaves_its_partner_without_one():
    rng = np.random.default_rng(0)
    sample, _, _ = Generator(["biped"], (1500, 2000), damaged=False, remeshed_share=0).draw(9, 0)
    cut = damage.cut_limb(rng, sample)
    missing = mirror_map(cut.rest, cut.faces) == NO_PARTNER
    assert len(cut.rest) < len(sample.rest) and missing.any()
    assert np.sign(cut.rest[missing, 0]).mean() ** 2 > 0.25  # on one side


def test_shells_are_a_mirrored_pair():
    rng = np.random.default_rng(0)
    sample, _, _ = Generator(["biped"], (600, 900), damaged=False, remeshed_share=0).draw(9, 1)
    more = damage.add_shells(rng, sample)
    mirror = mirror_map(more.rest, more.faces)
    added = np.arange(len(sample.rest), len(more.rest))
    assert np.isin(mirror[added], added).all() and np.array_equal(mirror[mirror[added]], added)


def test_files_come_back_as_written(tmp_path):
    sample, mirror, description = Generator(["sea-star"], (500, 700)).draw(1, 0)
    write_shape(tmp_path, "star", sample.posed, sample.faces, mirror, description)
    vertices, faces = read_ply(tmp_path / "star.ply")
    assert np.allclose(vertices, sample.posed, atol=1e-6) and np.array_equal(faces, sample.faces)
    assert np.array_equal(np.loadtxt(tmp_path / "star.mirror", dtype=int), mirror)
    assert json.loads((tmp_path / "star.json").read_text())["kind"] == "sea-star"
