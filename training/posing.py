"""Asymmetric posing by linear blend skinning: bends limbs, keeps lengths along the surface nearly."""

from __future__ import annotations

import numpy as np

from .implicit import capsule_distance
from .skeleton import Skeleton, unit


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation matrix about a unit axis (Rodrigues)."""
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def about(joint: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The 4 x 4 transform that applies `turn` with `joint` fixed."""
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = turn, joint - turn @ joint
    return transform


def chain(parents: list[int], joints, turns) -> np.ndarray:
    """World transform of every bone from its local rotation; parents come before children."""
    world: list[np.ndarray] = []
    for parent, joint, turn in zip(parents, joints, turns):
        local = about(np.asarray(joint), turn)
        world.append(world[parent] @ local if parent >= 0 else local)
    return np.array(world)


def skin(vertices: np.ndarray, weights: np.ndarray, transforms: np.ndarray) -> np.ndarray:
    """Linear blend skinning: weights (n, bones), transforms (bones, 4, 4)."""
    homogeneous = np.c_[vertices, np.ones(len(vertices))]
    blended = (weights @ transforms[:, :3].reshape(len(transforms), 12)).reshape(-1, 3, 4)
    return np.einsum("vij,vj->vi", blended, homogeneous)


def capsule_weights(vertices: np.ndarray, skeleton: Skeleton, softness: float) -> np.ndarray:
    """Skinning weights (n, bones) by distance to the bones; rows sum to one."""
    distance = np.stack([capsule_distance(vertices, skeleton, k, 0.8) for k in range(len(skeleton.start))], 1)
    weights = np.exp(-(distance - distance.min(1, keepdims=True)) / softness)
    weights[weights < 0.02] = 0
    return weights / weights.sum(1, keepdims=True)


def random_pose(rng, vertices: np.ndarray, skeleton: Skeleton, amount: float) -> np.ndarray:
    """Pose the rest shape: each bone but the root turns by a normal angle (`amount` radians) about a random axis."""
    turns = [
        rotation(unit(rng.normal(size=3)), rng.normal() * amount if parent >= 0 else 0.0) for parent in skeleton.parent
    ]
    transforms = chain(skeleton.parent, skeleton.start, turns)
    return skin(vertices, capsule_weights(vertices, skeleton, rng.uniform(0.02, 0.05)), transforms)
