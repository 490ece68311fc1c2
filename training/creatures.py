"""Random symmetric skeletons: biped, quadruped, bird, insect, sea star, random, near-repeated blob, stout creatures.

Each function draws one skeleton that is its own mirror image about x = 0. z is up, y is forward.
"""

from __future__ import annotations

import numpy as np

from .skeleton import LimbShape, Skeleton, grow_limb, grow_spine


def biped(rng) -> Skeleton:
    """A person-like shape: torso, arms with or without fingers, legs with feet, head, sometimes more."""
    u, skeleton = rng.uniform, Skeleton()
    torso, width = u(0.4, 0.6), u(0.07, 0.13)
    heights = np.linspace(0, torso, 4)
    spine = grow_spine(rng, skeleton, np.c_[np.zeros((4, 2)), heights], width * u(0.85, 1.15, 4))
    shoulder, hip = u(0.08, 0.2), u(0.05, 0.13)
    shoulders = skeleton.add_pair([0, 0, torso], [shoulder, 0, torso], width * 0.8, width * 0.65, (spine[-1],) * 2)
    hips = skeleton.add_pair([0, 0, 0], [hip, 0, 0], width * 0.8, width * 0.65, (spine[0],) * 2)
    _arms(rng, skeleton, [shoulder, 0, torso], shoulders)
    _legs(rng, skeleton, [hip, 0, 0], hips)
    neck = grow_limb(rng, skeleton, [0, 0, torso], spine[-1], [0, u(-0.2, 0.1), 1],
                     LimbShape(u(0.08, 0.2), 1, u(0.04, 0.07), 0.9), "medial")
    grow_limb(rng, skeleton, neck.point, neck.bones, [0, u(-0.5, 0.1), 1],
              LimbShape(u(0.05, 0.15), 1, u(0.07, 0.12), u(0.8, 1.1)), "medial")
    if rng.random() < 0.15:
        grow_limb(rng, skeleton, [0, 0, 0], spine[0], [0, 1, u(-0.8, 0.3)], LimbShape(u(0.3, 0.8), 3, 0.05, 0.5), "medial")
    if rng.random() < 0.15:
        grow_limb(rng, skeleton, [shoulder / 2, 0.03, torso * 0.9], spine[-1], [1, u(0.2, 1), u(0, 1)],
                  LimbShape(u(0.3, 0.9), 2, 0.05, 0.6))
    return skeleton


def _arms(rng, skeleton, origin, parents) -> None:
    u, raised = rng.uniform, rng.uniform(-0.9, 0.5)
    shape = LimbShape(u(0.5, 0.85), int(rng.integers(2, 4)), u(0.036, 0.066), u(0.5, 0.8), 0.2)
    wrist = grow_limb(rng, skeleton, origin, parents, [np.cos(raised), u(-0.2, 0.2), np.sin(raised)], shape)
    hand = rng.random()
    if hand < 0.4:
        for _ in range(rng.integers(2, 4)):
            finger = LimbShape(u(0.05, 0.12), 1, wrist.radius * 0.6, 0.7)
            grow_limb(rng, skeleton, wrist.point, wrist.bones, wrist.direction + rng.normal(size=3) * 0.35, finger)
    elif hand < 0.7:
        grow_limb(rng, skeleton, wrist.point, wrist.bones, wrist.direction,
                  LimbShape(u(0.05, 0.1), 1, wrist.radius * 1.3, 0.9))


def _legs(rng, skeleton, origin, parents) -> None:
    u = rng.uniform
    shape = LimbShape(u(0.6, 1.05), int(rng.integers(2, 4)), u(0.054, 0.102), u(0.45, 0.8), 0.12)
    ankle = grow_limb(rng, skeleton, origin, parents, [u(0.05, 0.5), u(-0.15, 0.15), -1], shape)
    if rng.random() < 0.8:
        grow_limb(rng, skeleton, ankle.point, ankle.bones, [u(-0.1, 0.3), 1, u(-0.2, 0.1)],
                  LimbShape(u(0.1, 0.22), 1, ankle.radius, 0.8))


def quadruped(rng) -> Skeleton:
    """A four-legged animal: barrel, legs, neck, head with ears or horns, tail, sometimes a centaur's torso."""
    u, skeleton = rng.uniform, Skeleton()
    length, radii = u(0.6, 1.1), u(0.09, 0.2) * u(0.8, 1.15, 5)
    ys, zs = np.linspace(0, length, 5), np.cumsum(np.r_[0, rng.normal(size=4) * 0.03])
    spine = grow_spine(rng, skeleton, np.c_[np.zeros(5), ys, zs], radii)
    for end in (0, -1):
        shape = LimbShape(u(0.45, 1.0), int(rng.integers(2, 4)), u(0.052, 0.098), u(0.4, 0.75), 0.15)
        hip = [radii[end] * u(0.4, 0.8), ys[end], zs[end] - radii[end] * 0.3]
        foot = grow_limb(rng, skeleton, hip, spine[end], [u(0, 0.5), u(-0.25, 0.25), -1], shape)
        if rng.random() < 0.5:
            grow_limb(rng, skeleton, foot.point, foot.bones, [0, 1, -0.2], LimbShape(u(0.05, 0.12), 1, foot.radius * 1.1, 0.9))
    _neck_and_head(rng, skeleton, [0, ys[-1], zs[-1] + radii[-1] * 0.3], spine[-1], radii[-1])
    if rng.random() < 0.8:
        grow_limb(rng, skeleton, [0, 0, zs[0] + radii[0] * 0.4], spine[0], [0, -1, u(-0.8, 0.8)],
                  LimbShape(u(0.15, 1.0), 3, u(0.025, 0.06), u(0.5, 1), 0.2), "medial")
    if rng.random() < 0.12:
        chest = grow_limb(rng, skeleton, [0, ys[-1], zs[-1]], spine[-1], [0, 0.1, 1], LimbShape(0.5, 2, 0.1, 0.9, 0.1), "medial")
        grow_limb(rng, skeleton, chest.point + [0.1, 0, -0.03], chest.bones, [1, u(-0.5, 0.5), u(-1, 0.4)],
                  LimbShape(u(0.4, 0.7), 2, 0.045, 0.6))
    return skeleton


def _neck_and_head(rng, skeleton, origin, parent, chest_radius) -> None:
    u = rng.uniform
    neck_shape = LimbShape(u(0.12, 0.7), int(rng.integers(1, 4)), chest_radius * u(0.45, 0.75), u(0.55, 0.9), 0.15)
    neck = grow_limb(rng, skeleton, origin, parent, [0, 1, u(0, 1.6)], neck_shape, "medial")
    radius = max(neck.radius * u(0.9, 1.4), 0.05)
    head = grow_limb(rng, skeleton, neck.point, neck.bones, [0, 1, u(-0.8, 0.2)], LimbShape(u(0.12, 0.35), 1, radius, u(0.45, 0.9)), "medial")
    if rng.random() < 0.75:
        ear = LimbShape(u(0.08, 0.3), int(rng.integers(1, 3)), radius * 0.3, u(0.5, 1))
        grow_limb(rng, skeleton, neck.point + [radius * 0.5, 0, radius * 0.5], head.bones, [u(0.2, 1), u(-0.4, 0.2), 1], ear)
    if rng.random() < 0.15:
        grow_limb(rng, skeleton, head.point, head.bones, [0, 0.6, -0.8], LimbShape(u(0.2, 0.5), 2, 0.03, 0.7), "medial")


def bird(rng) -> Skeleton:
    """A bird or a flying reptile: body, wings of few feathers, legs, neck, beak, fan tail."""
    u, skeleton = rng.uniform, Skeleton()
    radii = u(0.09, 0.16) * np.array([0.6, 1.0, 0.9]) * u(0.9, 1.1, 3)
    length = u(0.3, 0.55)
    spine = grow_spine(rng, skeleton, np.c_[np.zeros(3), np.linspace(0, length, 3), [0, 0.03, 0.06]], radii)
    wing = grow_limb(rng, skeleton, [radii[1] * 0.7, length * 0.7, 0.05], spine[-1], [1, u(-0.3, 0.3), u(-0.2, 0.5)],
                     LimbShape(u(0.4, 0.9), int(rng.integers(2, 4)), u(0.04, 0.06), u(0.5, 0.9)))
    for _ in range(rng.integers(0, 4)):
        grow_limb(rng, skeleton, wing.point, wing.bones, wing.direction + [0, u(-1.4, 0), 0], LimbShape(u(0.1, 0.4), 1, wing.radius, 0.7))
    leg = grow_limb(rng, skeleton, [radii[0] * 0.6, length * 0.3, -radii[0] * 0.5], spine[0], [u(0, 0.4), u(-0.2, 0.3), -1],
                    LimbShape(u(0.2, 0.5), 2, 0.035, 0.7))
    for _ in range(rng.integers(0, 4)):
        grow_limb(rng, skeleton, leg.point, leg.bones, [u(-0.7, 0.7), 1, -0.1], LimbShape(u(0.06, 0.14), 1, 0.024, 0.8))
    _neck_and_head(rng, skeleton, [0, length, 0.06], spine[-1], radii[-1])
    for _ in range(rng.integers(0, 3)):
        grow_limb(rng, skeleton, [0.02, 0, 0], spine[0], [u(0.1, 0.7), -1, u(-0.2, 0.4)], LimbShape(u(0.15, 0.4), 1, 0.03, 0.8))
    grow_limb(rng, skeleton, [0, 0, 0], spine[0], [0, -1, u(-0.2, 0.5)], LimbShape(u(0.1, 0.4), 2, 0.04, 0.7), "medial")
    return skeleton


def insect(rng) -> Skeleton:
    """Head, thorax and abdomen with three to four pairs of legs, antennae, sometimes wings."""
    u, skeleton = rng.uniform, Skeleton()
    ys = np.cumsum(np.r_[0, u(0.2, 0.5), u(0.08, 0.15), u(0.15, 0.35), u(0.08, 0.2)])
    radii = np.array([u(0.05, 0.12), u(0.08, 0.18), u(0.05, 0.08), u(0.08, 0.13), u(0.06, 0.1)])
    spine = grow_spine(rng, skeleton, np.c_[np.zeros(5), ys, rng.normal(size=5) * 0.02], radii)
    pairs = int(rng.integers(3, 5))
    shape = LimbShape(u(0.35, 0.8), 3, u(0.026, 0.04), u(0.7, 1.0), 0.35)
    for k in range(pairs):
        along = ys[2] + (ys[3] - ys[2]) * k / (pairs - 1)
        leg = LimbShape(shape.length * u(0.75, 1.3), 3, shape.radius, shape.taper, shape.bend)
        grow_limb(rng, skeleton, [0.05, along, 0], spine[2], [1, (k / (pairs - 1) - 0.5) * 1.6, u(-0.4, 0.6)], leg)
    grow_limb(rng, skeleton, [0.04, ys[-1], 0.03], spine[-1], [u(0.2, 0.9), 1, u(0, 0.8)],
              LimbShape(u(0.1, 0.6), 2, 0.024, 0.9))
    if rng.random() < 0.4:
        grow_limb(rng, skeleton, [0.03, ys[2], 0.08], spine[2], [1, u(-1, 0.2), u(0.2, 1)], LimbShape(u(0.3, 0.8), 2, 0.05, 1.1))
    return skeleton


def sea_star(rng) -> Skeleton:
    """Arms round a disc, in pairs and with or without medial arms; nearly equal arms repeat eigenvalues."""
    u, skeleton = rng.uniform, Skeleton()
    core = u(0.08, 0.2)
    root = skeleton.add([0, 0, -0.02], [0, 0, 0.02], core, core, -1)
    arms = int(rng.integers(4, 8))
    length, radius, taper = u(0.4, 0.9), u(0.05, 0.09), u(0.4, 0.9)
    spread = rng.choice([0.0, 0.04, 0.3])  # regular, almost regular, plainly bilateral
    half = [k for k in range(arms) if 0 < k < arms / 2]
    for k in half + [0] + ([arms // 2] if arms % 2 == 0 else []):
        angle = 2 * np.pi * k / arms
        shape = LimbShape(length * np.exp(rng.normal() * spread), 3, radius * np.exp(rng.normal() * spread / 2), taper, 0.12)
        how = "pair" if k in half else "medial"
        grow_limb(rng, skeleton, [0, 0, 0], root, [np.sin(angle), np.cos(angle), 0], shape, how)
    return skeleton


def random_tree(rng) -> Skeleton:
    """A medial trunk with random mirrored and medial branches that may branch again."""
    u, skeleton = rng.uniform, Skeleton()
    count = int(rng.integers(1, 5))
    points, direction, step = [np.zeros(3)], np.array([0, 1.0, 0]), u(0.3, 1.2) / count
    for _ in range(count):
        points.append(points[-1] + direction * step)
        turned = direction + rng.normal(size=3) * [0, 0.4, 0.4]
        direction = turned / np.linalg.norm(turned)
    radii = np.clip(u(0.06, 0.22) * np.cumprod(u(0.7, 1.35, count + 1)), 0.05, 0.25)
    spine = grow_spine(rng, skeleton, np.array(points), radii)
    for _ in range(rng.integers(1, 5)):
        _random_branch(rng, skeleton, points, radii, spine, "pair")
    for _ in range(rng.integers(0, 4)):
        _random_branch(rng, skeleton, points, radii, spine, "medial")
    return skeleton


def _random_branch(rng, skeleton, points, radii, spine, how) -> None:
    u, place = rng.uniform, int(rng.integers(len(points)))
    direction = rng.normal(size=3)
    origin = points[place].copy()
    if how == "pair":
        direction[0] = abs(direction[0]) + 0.1
        origin[0] += radii[place] * u(0, 0.7)
    shape = LimbShape(u(0.2, 1.1), int(rng.integers(1, 4)), min(radii[place] * 0.8, u(0.03, 0.12)), u(0.45, 1.2), 0.3)
    tip = grow_limb(rng, skeleton, origin, spine[min(place, len(spine) - 1)], direction, shape, how)
    if how == "pair" and rng.random() < 0.3:
        for _ in range(rng.integers(1, 3)):
            twig = LimbShape(u(0.08, 0.4), 1, tip.radius * 0.8, 0.8)
            grow_limb(rng, skeleton, tip.point, tip.bones, tip.direction + rng.normal(size=3) * 0.7, twig)


def teddy(rng) -> Skeleton:
    """A stout upright creature, standing or sitting: a teddy bear, an armadillo."""
    return _stout(rng, rng.uniform(0.4, 0.6) * np.pi)


def beast(rng) -> Skeleton:
    """A stout creature on all fours: a pig, a bear, an elephant, a cow."""
    return _stout(rng, rng.uniform(-0.08, 0.15) * np.pi)


def _stout(rng, angle) -> Skeleton:
    """A round body that rises at `angle`, a big head with ears and a snout, four thick limbs, sometimes a tail."""
    u, skeleton, upright = rng.uniform, Skeleton(), angle > 0.25 * np.pi
    axis, belly = np.array([0, np.cos(angle), np.sin(angle)]), np.array([0, np.sin(angle), -np.cos(angle)])
    length, girth = u(0.3, 0.75), u(0.12, 0.28)
    points = np.linspace(0, length, 4)[:, None] * axis
    radii = girth * np.array([u(0.7, 1.1), u(0.9, 1.2), u(0.8, 1.1), u(0.6, 0.95)])
    spine = grow_spine(rng, skeleton, points, radii)
    _stout_head(rng, skeleton, points[-1], spine[-1], axis, girth)
    standing = [0, u(-0.2, 1.5) if upright else u(-0.25, 0.25), -1]
    reaching = belly * u(0.1, 1) + axis * u(-0.7, 0.5) if upright else [0, u(-0.25, 0.25), -1]
    for end, downward, outward in ((0, standing, u(0, 0.8)), (3, reaching, u(0, 1.5 if upright else 0.5))):
        shape = LimbShape(girth * u(0.8, 2.6), int(rng.integers(2, 4)), girth * u(0.25, 0.6), u(0.45, 1.0), 0.15)
        origin = points[end] + [radii[end] * u(0.4, 0.8), 0, 0] + belly * radii[end] * u(-0.2, 0.4)
        tip = grow_limb(rng, skeleton, origin, spine[min(end, 2)], np.array(downward) + [outward, 0, 0], shape)
        if rng.random() < 0.5:
            foot = LimbShape(tip.radius * u(0.6, 1.6), 1, tip.radius * u(0.9, 1.3), 0.9)
            grow_limb(rng, skeleton, tip.point, tip.bones, [u(-0.2, 0.4), 1, u(-0.2, 0.2)], foot)
        elif rng.random() < 0.3:
            for _ in range(rng.integers(2, 4)):
                claw = LimbShape(tip.radius * u(1, 2), 1, tip.radius * 0.45, 0.8)
                grow_limb(rng, skeleton, tip.point, tip.bones, tip.direction + rng.normal(size=3) * 0.5, claw)
    if rng.random() < 0.5:
        tail = LimbShape(girth * u(0.4, 3.5), 3, girth * u(0.1, 0.45), u(0.3, 0.9), 0.2)
        grow_limb(rng, skeleton, points[0], spine[0], -axis - belly * u(0, 1.5), tail, "medial")
    return skeleton


def _stout_head(rng, skeleton, origin, parent, axis, girth) -> None:
    u, size = rng.uniform, girth * rng.uniform(0.5, 1.0)
    neck_shape = LimbShape(girth * u(0.5, 1.6), 1, girth * u(0.4, 0.8), u(0.8, 1))
    neck = grow_limb(rng, skeleton, origin, parent, axis + [0, 0, u(0, 0.8)], neck_shape, "medial")
    skull = grow_limb(rng, skeleton, neck.point, neck.bones, [0, 1, u(-0.6, 0.4)], LimbShape(size * u(0.1, 0.8), 1, size, u(0.6, 1)), "medial")
    if rng.random() < 0.65:
        snout = LimbShape(size * u(0.7, 1.8), int(rng.integers(1, 3)), size * u(0.25, 0.6), u(0.5, 1))
        grow_limb(rng, skeleton, skull.point, skull.bones, [0, 1, u(-1, 0.2)], snout, "medial")
    if rng.random() < 0.85:
        ear = LimbShape(size * u(0.3, 1.5), int(rng.integers(1, 3)), size * u(0.2, 0.45), u(0.5, 1.2))
        grow_limb(rng, skeleton, neck.point + size * np.array([0.6, 0, 0.6]), skull.bones, [u(0.2, 1), u(-0.5, 0.3), u(0.1, 1)], ear)


def blob(rng) -> Skeleton:
    """A stout body with short limbs: close to a ball or a square cushion, so eigenvalues nearly repeat."""
    u, skeleton = rng.uniform, Skeleton()
    size = u(0.2, 0.35)
    root = skeleton.add([0, -size * u(0, 0.3), 0], [0, size * u(0, 0.3), 0], size, size, -1)
    for _ in range(rng.integers(1, 4)):
        direction = rng.normal(size=3)
        direction[0] = abs(direction[0]) + 0.05
        grow_limb(rng, skeleton, [0, 0, 0], root, direction, LimbShape(size * u(1.1, 1.6), 1, size * u(0.15, 0.4), 0.9))
    if rng.random() < 0.6:
        grow_limb(rng, skeleton, [0, 0, 0], root, rng.normal(size=3), LimbShape(size * u(1.1, 1.6), 1, size * u(0.15, 0.4), 0.9), "medial")
    return skeleton


def asymmetric_tree(rng) -> Skeleton:
    """A trunk with five to eight single branches of different lengths in all directions of space.

    Several branches out of one plane are needed: a bent tube, or a planar fork, is intrinsically symmetric.
    """
    u, skeleton = rng.uniform, Skeleton()
    count = int(rng.integers(2, 5))
    points = np.cumsum(np.r_[np.zeros((1, 3)), [0, 0.25, 0] + rng.normal(size=(count, 3)) * 0.1], axis=0)
    radii = u(0.08, 0.16) * u(0.7, 1.3, count + 1)
    spine = grow_spine(rng, skeleton, points, radii)
    for length in np.geomspace(0.25, 1.0, int(rng.integers(5, 9))) * u(0.85, 1.15):
        place = int(rng.integers(len(points)))
        shape = LimbShape(length, int(rng.integers(1, 4)), min(radii[place] * 0.8, u(0.04, 0.1)), u(0.5, 1.1), 0.3)
        tip = grow_limb(rng, skeleton, points[place], spine[min(place, count - 1)], rng.normal(size=3), shape, "single")
        if rng.random() < 0.4:
            grow_limb(rng, skeleton, tip.point, tip.bones, tip.direction + rng.normal(size=3) * 0.7, LimbShape(u(0.1, 0.4), 1, tip.radius, 0.8), "single")
    return skeleton


def lump(rng) -> Skeleton:
    """A stout body with five to eight single limbs of unlike length and girth: a blob without a symmetry."""
    u, skeleton = rng.uniform, Skeleton()
    size, count = u(0.2, 0.35), int(rng.integers(5, 9))
    root = skeleton.add([0, -size * u(0, 0.3), 0], [0, size * u(0, 0.3), 0], size, size, -1)
    lengths = np.linspace(u(1.2, 1.7), u(2.5, 4.5), count) * size
    girths = rng.permutation(np.linspace(u(0.2, 0.35), u(0.5, 0.8), count)) * size
    for length, girth in zip(lengths, girths):
        grow_limb(rng, skeleton, [0, 0, 0], root, rng.normal(size=3), LimbShape(length, 1, girth, 0.9), "single")
    return skeleton


def unbalanced(rng) -> Skeleton:
    """A symmetric creature made asymmetric: its -x limbs are stretched and two single branches are added."""
    kind = rng.choice(["biped", "quadruped", "bird", "insect"])
    skeleton = SYMMETRIC_KINDS[kind](rng)
    plane_bones = [k for k, side in enumerate(skeleton.side) if side == 0]
    for index in np.flatnonzero(np.array(skeleton.side) < 0):
        factor = rng.uniform(0.35, 0.75) if rng.random() < 0.5 else rng.uniform(1.35, 1.9)
        _stretch(skeleton, int(index), factor)
    for _ in range(2):
        bone = int(rng.choice(plane_bones))
        direction = rng.normal(size=3) + [1.0, 0, 0]
        shape = LimbShape(rng.uniform(0.3, 0.7), 2, 0.05, 0.7, 0.3)
        grow_limb(rng, skeleton, skeleton.end[bone], bone, direction, shape, "single")
    return skeleton


def _stretch(skeleton: Skeleton, bone: int, factor: float) -> None:
    shift = (skeleton.end[bone] - skeleton.start[bone]) * (factor - 1)
    skeleton.end[bone] = skeleton.end[bone] + shift
    for below in skeleton.descendants(bone) - {bone}:
        skeleton.start[below] = skeleton.start[below] + shift
        skeleton.end[below] = skeleton.end[below] + shift


SYMMETRIC_KINDS = {
    "biped": biped,
    "quadruped": quadruped,
    "bird": bird,
    "insect": insect,
    "sea-star": sea_star,
    "random": random_tree,
    "blob": blob,
}
# For training only: the sets of evaluation/ draw SYMMETRIC_KINDS in turn.
STOUT_KINDS = {"teddy": teddy, "beast": beast}
ASYMMETRIC_KINDS = {"asymmetric-tree": asymmetric_tree, "unbalanced": unbalanced, "lump": lump}
