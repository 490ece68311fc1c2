"""Triangle meshes of smooth unions of capsules: no symmetry of connectivity, whatever the shape's."""

import numpy as np
from skimage.measure import marching_cubes


class Capsules:
    """A smooth union of round cones, each from `start` (radius r0) to `end` (radius r1)."""

    def __init__(self, cones, blend):
        self.starts = np.array([cone[0] for cone in cones], float)
        self.ends = np.array([cone[1] for cone in cones], float)
        self.radii = np.array([cone[2:4] for cone in cones], float)
        self.blend = blend

    def cone_distances(self, points):
        """Approximate signed distance to each cone (points x cones)."""
        distances = []
        for start, end, (r0, r1) in zip(self.starts, self.ends, self.radii):
            axis = end - start
            t = np.clip((points - start) @ axis / (axis @ axis), 0, 1)
            gap = np.linalg.norm(points - start - t[..., None] * axis, axis=-1)
            distances.append(gap - (r0 + (r1 - r0) * t))
        return np.stack(distances, -1)

    def __call__(self, points):
        """The smooth minimum (log-sum-exp) of the distances: negative inside."""
        scaled = -self.cone_distances(points) / self.blend
        peak = scaled.max(-1)
        return -self.blend * (peak + np.log(np.exp(scaled - peak[..., None]).sum(-1)))

    def project(self, points, steps=4):
        """Newton steps onto the zero set along the gradient (central differences)."""
        h = 1e-5
        for _ in range(steps):
            gradient = np.stack([(self(points + h * e) - self(points - h * e)) / (2 * h) for e in np.eye(3)], -1)
            points = points - (self(points) / (gradient**2).sum(-1))[:, None] * gradient
        return points


def mesh(surface, low, high, spacing, turn, relaxations=8):
    """Marching cubes on a grid turned by the rotation `turn`, then evened out along the surface."""
    corners = np.array(np.meshgrid(*zip(low, high))).reshape(3, -1).T @ turn
    floor, ceiling = corners.min(0) - 0.37 * spacing, corners.max(0) + spacing
    axes = [np.arange(a, b, spacing) for a, b in zip(floor, ceiling)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    values = surface(grid.reshape(-1, 3) @ turn.T).reshape(grid.shape[:3])
    positions, faces, _, _ = marching_cubes(values, 0.0, spacing=(spacing,) * 3)
    positions = surface.project((positions + floor) @ turn.T)
    assert 2 * len(positions) - len(faces) == 4, "the surface must be one closed piece without handles"
    first, second = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), 1), axis=0).T
    degree = np.bincount(first, minlength=len(positions)) + np.bincount(second, minlength=len(positions))
    for _ in range(relaxations):
        total = np.zeros_like(positions)
        np.add.at(total, first, positions[second])
        np.add.at(total, second, positions[first])
        positions = surface.project(0.5 * positions + 0.5 * total / degree[:, None], steps=2)
    return positions, faces
