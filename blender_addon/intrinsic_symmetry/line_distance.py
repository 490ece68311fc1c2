# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance from the line between left and right, within a band around it, and the soft sides that it gives.

Each vertex takes the nearest point of the line from a neighbour that has one, nearest first (E. W. Dijkstra, "A note
on two problems in connexion with graphs", 1959); the distance is straight, so that zigzag edges do not lengthen it.
"""

import heapq

import numpy as np
from intrinsym import Merge

from . import mesh_data


def line_distances(mesh, lines, positions, most):
    """(vertices,) distance from the nearest of the FixedLines, in the unit of `positions`; infinite where it is more
    than `most`, or where no edges lead to a line."""
    starts, ends, edges = _segments(lines, positions)
    distance = np.full(len(positions), np.inf)
    around, queue = _neighbours(mesh), []
    for segment, vertices in enumerate(edges.tolist()):
        for vertex in vertices:
            _offer(queue, distance, vertex, segment, positions, starts, ends, most)
    while queue:
        reached, vertex, segment = heapq.heappop(queue)
        if reached > distance[vertex]:
            continue
        for neighbour in around[vertex]:
            for near in range(max(segment - 1, 0), min(segment + 2, len(starts))):
                _offer(queue, distance, neighbour, near, positions, starts, ends, most)
    return distance


def _offer(queue, distance, vertex, segment, positions, starts, ends, most):
    """Lets a vertex have a segment of the line as its nearest, if it is."""
    start, along, point = starts[segment], ends[segment] - starts[segment], positions[vertex]
    share = np.clip((point - start) @ along / max(along @ along, 1e-30), 0, 1)
    reached = float(np.linalg.norm(point - start - share * along))
    if reached < distance[vertex] and reached <= most:
        distance[vertex] = reached
        heapq.heappush(queue, (reached, vertex, segment))


def _segments(lines, positions):
    """(segments, 3) starts and ends of the pieces of the lines, and (segments, 4) vertices beside each."""
    starts, ends, edges = [np.zeros((0, 3))], [np.zeros((0, 3))], [np.zeros((0, 4), int)]
    for line in lines:
        points, beside = line.positions(positions), line.edges
        if line.closed:
            points, beside = np.vstack([points, points[:1]]), np.vstack([beside, beside[:1]])
        starts.append(points[:-1])
        ends.append(points[1:])
        edges.append(np.hstack([beside[:-1], beside[1:]]))
    return np.vstack(starts), np.vstack(ends), np.vstack(edges)


def _neighbours(mesh):
    """Vertices at the other ends of each vertex' edges, as a list of arrays."""
    both = mesh_data.edges(mesh)
    both = np.vstack([both, both[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    counts = np.bincount(both[:, 0], minlength=len(mesh.vertices))
    return [piece.tolist() for piece in np.split(both[:, 1], np.cumsum(counts)[:-1])]


def left_shares(symmetry, distance, width):
    """(vertices,) how much of each vertex is left, 0..1: a half on the line, all or nothing from half a width on, and
    smooth between. Of a vertex and its mirror image it sums to 1, whatever the pose does to their distances."""
    share = np.where(distance >= 0.5 * width, 1.0, distance / max(0.5 * width, 1e-30))
    share = symmetry.mirror_values(share * share * (3 - 2 * share), Merge.AVERAGE)
    return 0.5 * (1 + symmetry.side * share)
