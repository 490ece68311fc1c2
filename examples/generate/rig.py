"""Forward kinematics and linear blend skinning, the textbook forms."""

import numpy as np


def rotation(axis, degrees):
    """The 3 x 3 rotation about `axis` (Rodrigues' formula)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Rig:
    """Joints with a parent each. `heads`: name -> rest position; `parents`: name -> name or None."""

    def __init__(self, heads, parents):
        self.heads = {name: np.asarray(head, float) for name, head in heads.items()}
        self.parents = parents

    def transforms(self, pose):
        """World transform (linear part, translation) of every bone.

        `pose`: name -> list of (axis in rest coordinates, degrees), applied first to last."""
        known = {}

        def visit(name):
            if name is None:
                return np.eye(3), np.zeros(3)
            if name not in known:
                parent_linear, parent_shift = visit(self.parents[name])
                turn = np.eye(3)
                for axis, degrees in pose.get(name, []):
                    turn = rotation(axis, degrees) @ turn
                head = self.heads[name]
                known[name] = parent_linear @ turn, parent_linear @ (head - turn @ head) + parent_shift
            return known[name]

        for name in self.heads:
            visit(name)
        return known

    def skin(self, positions, weights, pose):
        """Linear blend skinning. `weights`: name -> one weight per vertex; they are normalised here."""
        moved, total = np.zeros_like(positions), np.zeros(len(positions))
        for name, (linear, shift) in self.transforms(pose).items():
            if name in weights:
                moved += weights[name][:, None] * (positions @ linear.T + shift)
                total += weights[name]
        return moved / total[:, None]
