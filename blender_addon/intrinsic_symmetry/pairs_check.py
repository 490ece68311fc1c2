# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether pairs of vertices that a file holds can be those of a mesh."""

import numpy as np

from . import mesh_data

#: Of random pairs, the partners of neighbours are as far apart as any two vertices: the share of that from which on they
#: are refused, if they are also so many times as far apart as the neighbours.
_FAR, _FARTHER = 0.5, 3
#: By how much rounding may take a number out of its range.
_ROUNDED = 1e-6


def check(columns, about, mesh, core_mesh):
    """Raises MeshProblem where the pairs are of another mesh, or of none."""
    count = len(columns["partner"])
    if count != core_mesh.vertex_count:
        raise mesh_data.MeshProblem(f"The file speaks of {count} vertices, the mesh has {core_mesh.vertex_count}")
    if about.get("connectivity", "") not in ("", f"{core_mesh.connectivity_hash:016x}"):
        raise mesh_data.MeshProblem("The file belongs to a mesh with other faces")
    _check_ranges(columns, count, core_mesh.face_count)
    for line in about.get("lines", ()):
        _check_line(line, count)
    partner, ends = columns["partner"], mesh_data.edges(mesh).astype(np.int64)
    _check_mutual(partner, ends)
    _check_sides(partner, columns.get("side", np.zeros(count)))
    _check_neighbours(partner, ends, mesh_data.positions(mesh).astype(float))


def _check_ranges(columns, vertices, faces):
    last = {"partner": vertices - 1, "face": faces - 1, **{f"corner_{place}": vertices - 1 for place in range(3)}}
    for name, values in columns.items():
        low, high = (-1, last[name]) if name in last else (-1, 1) if name == "side" else (0, 1)
        wrong = values[~((values >= low - _ROUNDED) & (values <= high + _ROUNDED))]
        if len(wrong):
            none = ", for none," if name in last else ""
            more = ". Vertices and faces count from 0" if name in last else ""
            raise mesh_data.MeshProblem(
                f"The column {name} holds {wrong[0]}: it goes from {low}{none} to {high}{more}"
            )


def _check_line(line, vertices):
    wrong = line.edges[(line.edges < 0) | (line.edges >= vertices)]
    if len(wrong):
        raise mesh_data.MeshProblem(f"The line between left and right holds the vertex {wrong[0]}: there is none")
    if len(line.edges) != len(line.parameters) or not ((line.parameters >= 0) & (line.parameters <= 1)).all():
        raise mesh_data.MeshProblem("The line between left and right needs one parameter from 0 to 1 for each edge")


def _check_mutual(partner, ends):
    """Most partners have to lead back to their vertex or a neighbour of it."""
    found = np.flatnonzero(partner >= 0)
    own, back = found, partner[partner[found]]
    steps = np.sort(np.stack([own, back], axis=1), axis=1) @ (len(partner), 1)
    edges = np.sort(ends, axis=1) @ (len(partner), 1)
    share = ((own == back) | np.isin(steps, edges)).mean() if len(found) else 1.0
    if share <= 0.5:
        raise mesh_data.MeshProblem(
            f"Only {share:.0%} of the vertices are the partner of their partner: these are not pairs of a symmetry"
        )


def _check_sides(partner, side):
    """Most partners have to be on the other side."""
    sided = np.flatnonzero((partner >= 0) & (side != 0))
    if len(sided) and (side[partner[sided]] == side[sided]).mean() > 0.5:
        raise mesh_data.MeshProblem("Most partners are on the same side: the column side is not of these pairs")


def _check_neighbours(partner, ends, positions):
    """Neighbours have to have partners that are nearer to each other than any two vertices."""
    ends = ends[(partner[ends] >= 0).all(axis=1)]
    if not len(ends):
        return
    others = np.roll(partner[ends[:, 1]], len(ends) // 2)
    pairs = ends.T, partner[ends].T, (partner[ends[:, 0]], others)
    edge, image, any_two = (np.median(np.linalg.norm(positions[a] - positions[b], axis=1)) for a, b in pairs)
    if image > _FAR * any_two and image > _FARTHER * edge:
        raise mesh_data.MeshProblem(
            "Neighbours have partners that are far from each other: these are not pairs of this mesh"
        )
