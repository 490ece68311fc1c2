# SPDX-License-Identifier: GPL-3.0-or-later
"""The map of a mesh whose half was rebuilt: pairs are known by construction."""

import intrinsym
import numpy as np

from . import mesh_data, seams, stored_map, vertex_map
from .half_labels import LINE, LOSES, STAYS
from .regions import components, holding, mirrored


def alone(mesh, symmetry):
    """(vertices,) bool: those of shells without mirror images."""
    shell = components(len(symmetry.partner), mesh_data.edges(mesh).astype(np.int64))
    return ~np.isin(shell, shell[symmetry.partner >= 0])


def is_mirrored(mesh, symmetry, winner):
    """Whether all shells that have images have mirrored faces already, with the partners of the map, and none is to be
    copied from the side that wins, 1 or -1, or deleted on the other one."""
    offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
    partner = symmetry.partner.astype(np.int64)
    alike = mirrored(offsets, corners, partner) & (partner[partner] == np.arange(len(partner)))
    alike |= mirrored_points(offsets, corners, partner, seams.welded(mesh))
    alike &= symmetry.side[partner] == -symmetry.side
    shell = components(len(partner), mesh_data.edges(mesh).astype(np.int64))
    stays = np.isin(shell, shell[symmetry.side != winner])
    stays &= (stored_map.read_edit(mesh) != stored_map.LOST) | (symmetry.side != -winner)
    has_faces = np.bincount(corners, minlength=len(partner)) > 0
    return np.where(alone(mesh, symmetry), stays | ~has_faces, alike).all()


def mirrored_points(offsets, corners, partner, point):
    """(vertices,) bool: those whose points, (vertices,) the least vertex of each, have the mirror images of their partners'
    faces, and the other way round, though left and right may not be split alike. None without such points."""
    own = np.arange(len(partner))
    if (point == own).all():
        return point != own
    image = np.where(partner < 0, -1, point[partner])
    is_one = (image == image[point]) & (image[image] == point)
    return (mirrored(offsets, point[corners], np.where(point == own, image, -1)) & is_one)[point] & is_one


def known(mesh, core_mesh, halves, source, winner, symmetry):
    """An `intrinsym.Symmetry` for the sources that `half_copy` writes, where `winner`, 1 or -1, is the side that was
    copied, and `symmetry` is the map of before: what differed then and stays keeps its images."""
    count, model = len(halves.labels) + len(halves.shares), np.where(source < 0, -1 - source, source)
    labels = np.append(halves.labels, np.full(len(halves.shares), LINE))[model]
    own, copied = np.arange(len(source)), source < 0
    twin = np.append(halves.twin, np.full(len(halves.shares), -1))[model]
    at = np.full(2 * count, -1)
    at[model + count * copied] = own
    other = at[model + count * ~copied]
    partner = np.where(labels == LINE, own, np.where((other < 0) & (twin >= 0), at[twin], other))
    partner = np.where(labels == STAYS, -1, partner)
    before = np.append(symmetry.side, np.zeros(len(halves.shares), int))[model]
    split = (before == 0) & (twin >= 0)  # on the line, or apart there
    side = np.where(copied | (labels == LOSES), -winner, winner) * ((labels != LINE) & ~split)
    stays = (labels == STAYS) | (partner < 0)
    side = np.where(stays, before, side)
    exact = vertex_map.at_vertices(core_mesh, partner)
    partner = np.where(exact.faces == vertex_map.NONE, -1, partner)
    lines = _lines(mesh_data.edges(mesh), partner)
    confidence, partner, points = _with_others(core_mesh, partner, exact, symmetry, labels != STAYS, at, source)
    found = core_mesh.restore(intrinsym.SymmetryKind.REFLECTION, partner, confidence, side, points)
    found.fixed_curve = lines
    return found


def _with_others(core_mesh, partner, exact, symmetry, chosen, at, source):
    """Confidence, partners and surface points, of which the chosen ones, (vertices,) bool, without `exact` points have those of
    the `symmetry` that was, as far as their faces are there; `at` are the new numbers of the old vertices."""
    rows = np.flatnonzero((partner < 0) & chosen & (source >= 0) & (source < len(symmetry.partner)))
    old = rows[symmetry.partner[source[rows]] >= 0]
    corners = np.full((len(partner), 3), -1)
    corners[old] = at[symmetry.surface_points.corners[source[old]].astype(np.int64)]
    offsets, used = (np.asarray(part).astype(np.int64) for part in core_mesh.polygons)
    faces = holding(offsets, used, corners, (corners >= 0).all(axis=1))
    kept = faces >= 0
    own = source[kept]
    confidence, weights = (partner >= 0).astype(float), exact.barycentrics.copy()
    confidence[kept], weights[kept] = symmetry.confidence[own], symmetry.surface_points.barycentrics[own]
    partner = np.where(kept, corners[np.arange(len(kept)), weights.argmax(axis=1)], partner)
    points = intrinsym.SurfacePoints(
        np.where(kept, vertex_map.unsigned(faces), exact.faces),
        np.where(kept[:, None], vertex_map.unsigned(corners), exact.corners),
        weights,
    )
    return confidence, partner, points


def _lines(edges, partner):
    """The line, as `intrinsym.CurveLine`s, through the vertices that are their own partners."""
    on_line = partner == np.arange(len(partner))
    around = {}
    for start, end in edges[on_line[edges].all(axis=1)].tolist():
        around.setdefault(start, []).append(end)
        around.setdefault(end, []).append(start)
    walks = [_walked(around, first) for first in sorted(around, key=lambda vertex: (len(around[vertex]) == 2, vertex))]
    return [_curve_line(walk) for walk in walks if len(walk) > 1]


def _walked(around, at):
    """Vertices along edges that were not walked before."""
    walk = [at]
    while around[at]:
        following = around[at].pop()
        around[following].remove(at)
        walk.append(at := following)
    return walk


def _curve_line(walk):
    closed = walk[0] == walk[-1]
    ends = list(zip(walk, walk[1:])) + ([] if closed else [(walk[-1], walk[-2])])
    return intrinsym.CurveLine(np.array(ends, np.uint32), np.zeros(len(ends), np.float32), closed)
