# SPDX-License-Identifier: GPL-3.0-or-later
"""Eigenfunctions of meshes, kept for this session: what Correct and Label shows."""

from dataclasses import dataclass

import intrinsym
import numpy as np


@dataclass(frozen=True)
class Studied:
    """A mesh whose eigenfunctions are shown."""

    core_mesh: intrinsym.Mesh
    pairs: intrinsym.Eigenpairs


_studied = {}


def study(mesh, core_mesh, count):
    """Computes and keeps the lowest eigenfunctions of a mesh."""
    _studied[mesh.session_uid] = Studied(core_mesh, core_mesh.eigen(count))
    return _studied[mesh.session_uid]


def studied(mesh):
    """The Studied of a mesh in this session, or nothing."""
    return _studied.get(mesh.session_uid)


def active_values(mesh):
    """(vertices,) the eigenfunction to show, or nothing."""
    found = studied(mesh)
    number = mesh.intrinsic_symmetry_eigenfunction
    if found is None or not 1 <= number <= found.pairs.functions.shape[1]:
        return None
    return found.pairs.functions[:, number - 1]


def likeness(studied_pairs, other):
    """(count,) how much each eigenfunction is the same function on another triangulation of the same vertices:
    the absolute cosine in the mass, 1 for the same up to sign."""
    count = min(studied_pairs.functions.shape[1], other.functions.shape[1])
    mine, theirs = (np.nan_to_num(pairs.functions[:, :count]) for pairs in (studied_pairs, other))
    return np.abs(np.einsum("v,vk,vk->k", other.mass, mine, theirs))


def forget_all():
    _studied.clear()
