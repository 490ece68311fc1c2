"""Generated assemblies with the bones of a person: segmented, jointed, in armour, robots, dressed, under a hat."""

from __future__ import annotations

import numpy as np

from training.damage import Sample, flip_edges
from training.implicit import rest_mesh
from training.posing import rotation
from training.skeleton import MIRROR, Skeleton, unit

from .assembly import Assembly
from .shells import FRONT, X, Y, Z, Cut, Lathe, Sheet, ball, block, disc


def human(assembly: Assembly, fingers: bool) -> None:
    """The bones of a person, and a pose: standing, striding, arms anyhow."""
    rng, size = assembly.rng, lambda value: value * assembly.rng.uniform(0.9, 1.1)
    torso = [("pelvis", 0.5, 0.59, 0.085), ("belly", 0.59, 0.68, 0.075), ("chest", 0.68, 0.82, 0.09), ("neck", 0.82, 0.88, 0.036), ("head", 0.88, 1.0, 0.062)]
    parent = None
    for name, low, high, radius in torso:
        assembly.bone(name, [0, 0, low], [0, 0.01 * (name == "head"), high], [size(radius), size(radius)], parent)
        parent = name
    limbs = [
        ("thigh", "pelvis", [0.06, 0, 0.49], [0.07, 0.012, 0.28], 0.052, 0.04), ("shin", "thigh", [0.07, 0.012, 0.28], [0.075, -0.012, 0.06], 0.038, 0.026),
        ("foot", "shin", [0.075, -0.02, 0.03], [0.09, 0.1, 0.018], 0.03, 0.022), ("arm", "chest", [0.125, 0, 0.79], [0.205, -0.01, 0.65], 0.036, 0.03),
        ("forearm", "arm", [0.205, -0.01, 0.65], [0.265, 0.02, 0.52], 0.029, 0.022), ("hand", "forearm", [0.265, 0.02, 0.52], [0.295, 0.035, 0.455], 0.026, 0.022),
    ]  # fmt: skip
    for name, parent, start, end, first, last in limbs:
        assembly.bone_pair(name, start, end, [size(first), size(last)], parent)
    if fingers:
        for number, spread in enumerate((0.04, 0.015, -0.005, -0.022)):
            start = np.array([0.295, 0.035 + 0.8 * spread, 0.458 + 0.035 * (number == 0)])
            end = start + unit(np.array([0.5, 0.3 + 10 * spread, -1.0])) * (0.05 - 0.004 * abs(number - 2))
            assembly.bone_pair(f"finger {number}", start, end, [0.0085, 0.0065], "hand")
            assembly.turn(f"finger {number}", Y, -0.1, 0.7)
    for name, axis, low, high in [
        ("belly", Y, -0.25, 0.25), ("chest", Z, -0.4, 0.4), ("neck", X, -0.3, 0.3), ("head", Z, -0.7, 0.7), ("thigh", X, -0.5, 1.3),
        ("shin", X, -1.5, -0.05), ("foot", X, -0.3, 0.5), ("arm", X + 0.3 * Y, -0.6, 1.8), ("forearm", X, 0.1, 1.6), ("hand", Y, -0.4, 0.5),
    ]:  # fmt: skip
        assembly.turn(name, axis, low, high)
    assembly.turns["pelvis"] = rotation(unit(rng.normal(size=3)), rng.uniform(0, 0.6))


class Body:
    """One smooth surface around bones: rows of (start, end, first radius, last radius). It is its own mirror image if `middle`."""

    def __init__(self, bones, cell: float, middle: bool = True):
        self.skeleton, self.cell, self.middle = Skeleton(), cell, middle
        for start, end, first, last in bones:
            self.skeleton.add(start, end, first, last, -1)

    def made(self, cut: Cut) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and triangles; remeshed, each is sampled on a grid of its own."""
        own = cut.style == "remeshed"
        rng = cut.rng if own else np.random.default_rng(0)
        vertices, faces = rest_mesh(self.skeleton, self.cell / np.sqrt(cut.detail), 0.014, self.middle and not own, rng)
        if cut.style == "recut":
            faces = flip_edges(cut.rng, Sample(vertices, vertices, faces), 0.3).faces
        return vertices, faces


def body_of(assembly: Assembly, cell: float, thicker: float = 1.0, names=None) -> Body:
    """The bones of a figure, or some of them, as one surface."""
    bones = assembly.skeleton
    chosen = [assembly.bones[name] for name in names or assembly.bones]
    return Body([(bones.start[k], bones.end[k], thicker * bones.start_radius[k], thicker * bones.end_radius[k]) for k in chosen], cell)


# Lumps of the moulded parts: (start, end, first radius, last radius), those beside the middle of a middle part on both sides.
MOULDS = {
    "pelvis": [([0, 0, 0.53], [0, 0, 0.58], 0.07, 0.07), ([0.05, 0.01, 0.5], [0.055, 0, 0.53], 0.045, 0.05), ([0.04, -0.05, 0.52], [0.04, -0.04, 0.55], 0.04, 0.035)],
    "chest": [([0, 0, 0.7], [0, -0.01, 0.79], 0.07, 0.06), ([0.02, -0.01, 0.8], [0.1, 0, 0.79], 0.032, 0.03), ([0.04, 0.055, 0.74], [0.045, 0.06, 0.73], 0.03, 0.03), ([0.05, -0.05, 0.75], [0.04, -0.05, 0.7], 0.03, 0.025)],
    "head": [([0, -0.02, 0.94], [0, 0.0, 0.95], 0.058, 0.055), ([0, 0.035, 0.91], [0, 0.045, 0.895], 0.034, 0.026), ([0, 0.06, 0.94], [0, 0.07, 0.925], 0.022, 0.022), ([0.055, -0.01, 0.94], [0.06, -0.02, 0.95], 0.022, 0.022)],
    "hand": [([0.265, 0.02, 0.52], [0.283, 0.03, 0.485], 0.022, 0.025), ([0.283, 0.03, 0.485], [0.3, 0.03, 0.44], 0.023, 0.022), ([0.272, 0.045, 0.505], [0.27, 0.07, 0.475], 0.022, 0.022)],
    "foot": [([0.075, -0.025, 0.03], [0.085, 0.05, 0.026], 0.03, 0.026), ([0.085, 0.05, 0.025], [0.092, 0.1, 0.02], 0.027, 0.022), ([0.075, -0.02, 0.03], [0.075, -0.012, 0.06], 0.028, 0.026)],
    "thigh": [([0.06, 0, 0.46], [0.07, 0.01, 0.3], 0.05, 0.035), ([0.075, 0.02, 0.42], [0.075, 0.03, 0.35], 0.035, 0.03), ([0.07, 0.02, 0.29], [0.07, 0.022, 0.28], 0.033, 0.03)],
    "shin": [([0.07, 0.01, 0.25], [0.075, -0.01, 0.09], 0.028, 0.022), ([0.073, -0.022, 0.22], [0.075, -0.025, 0.16], 0.028, 0.024)],
}  # fmt: skip


def mould(assembly: Assembly, bones) -> None:
    """Parts shaped like a body's, on these bones: no two of their sides are alike but those that the plane mirrors."""
    for bone in bones:
        middle = bone in assembly.bones
        lumps = [(np.array(start), np.array(end), *assembly.rng.uniform(0.95, 1.1, 2) * radii) for start, end, *radii in MOULDS[bone]]
        if middle:
            lumps += [(start * MIRROR, end * MIRROR, *radii) for start, end, *radii in lumps if start[0] > 0]
        size = max(np.ptp([end for lump in lumps for end in lump[:2]], axis=0).max(), 0.1)
        (assembly.add if middle else assembly.add_pair)(bone, Body(lumps, 0.1 * size + 0.004, middle), bone)


def segments(assembly: Assembly, gap: tuple[float, float] = (-0.07, 0.07), section: float = 2.0, ends: float = 3.5, skip=(), moulded: float = 0.65) -> None:
    """Each bone as a closed body of its own; at each joint they overlap, touch (every third) or leave a gap. Some figures are
    moulded, the others' limbs turned on a lathe."""
    if assembly.rng.random() < moulded:
        bones = [name for name in MOULDS if name not in skip]
        mould(assembly, bones)
        skip = (*skip, *bones)
    for name, index in assembly.bones.items():
        if name.startswith("right ") or name.removeprefix("left ") in skip:
            continue
        start, end = assembly.skeleton.start[index], assembly.skeleton.end[index]
        first, last = assembly.skeleton.start_radius[index], assembly.skeleton.end_radius[index]
        apart = 0.0 if assembly.rng.random() < 1 / 3 else assembly.rng.uniform(*gap)
        path = np.array([start + apart * (end - start), end - apart * (end - start)])
        swell = assembly.rng.uniform(1.0, 1.15)
        radii = np.array([[first, 0.85 * first], [swell * (first + last) / 2] * 2, [last, 0.9 * last]])
        small = "finger" in name
        front = Z if abs(unit(end - start)[1]) > 0.7 else FRONT
        shape = Lathe(path, radii, 6 if small else 13, 8 if small else 18, ends, section, 0.15, front)
        add = assembly.add_pair if name.startswith("left ") else assembly.add
        add(name.removeprefix("left "), shape, name.removeprefix("left "))


def face(assembly: Assembly, eyes: float = 0.013) -> None:
    """Nose, ears and eyes on the head."""
    at = assembly.middle("head") + [0, assembly.skeleton.start_radius[assembly.bones["head"]] * 0.95, 0]
    assembly.add("nose", ball(at + [0, 0.012, -0.005], [0.009, 0.014, 0.014], bulge=0.3), "head")
    assembly.add_pair("eye", ball(at + [0.024, -0.006, 0.014], eyes), "head")
    assembly.add_pair("ear", ball(at + [0.06, -0.06, 0], [0.007, 0.014, 0.022], bulge=0.3), "head")


def mannequin(assembly: Assembly, number: int) -> None:
    """A segmented figure."""
    human(assembly, fingers=number % 2 == 0)
    segments(assembly)
    if number % 3 == 0:
        face(assembly)


def jointed(assembly: Assembly, number: int) -> None:
    """A figure with balls in its joints."""
    human(assembly, fingers=number % 2 == 1)
    segments(assembly, gap=(0.06, 0.11))
    for name, index in list(assembly.bones.items()):
        joint = ball(assembly.skeleton.start[index], assembly.skeleton.start_radius[index] * 0.8, 6, 10)
        if name.startswith("left "):
            assembly.add_pair("ball of " + name.removeprefix("left "), joint, name.removeprefix("left "))
        elif not name.startswith("right ") and name != "pelvis":
            assembly.add("ball of " + name, joint, name)
    if number % 2 == 0:
        face(assembly)


def armour(assembly: Assembly, number: int) -> None:
    """A figure in plates and a helmet."""
    human(assembly, fingers=False)
    segments(assembly)
    middle, radius = assembly.middle, lambda bone: assembly.skeleton.start_radius[assembly.bones[bone]]
    head, wide = middle("head"), radius("head")
    assembly.add("helmet", ball(head + [0, -0.01, 0.015], [1.25 * wide, 1.25 * wide, 0.085], 12, 22, bulge=0.1), "head")
    assembly.add("visor", ball(head + [0, 1.05 * wide, 0.005], [0.8 * wide, 0.35 * wide, 0.045], 8, 16, bulge=0.5), "head")
    crest = np.array([head + [0, 0.9 * wide, 0.09], head + [0, 0, 0.13], head + [0, -1.5 * wide, 0.05]])
    assembly.add("crest", Lathe(crest, [[0.006, 0.012], [0.008, 0.03], [0.006, 0.012]], 14, 10, 3.0, 2.0, 0.2, Z), "head")
    assembly.add("breastplate", ball(middle("chest") + [0, 0.03, 0], [1.2 * radius("chest"), 1.05 * radius("chest"), 0.09], 11, 22, bulge=0.25), "chest")
    assembly.add("belt", disc(middle("pelvis", 0.8), Z, 1.15 * radius("pelvis"), 0.015), "pelvis")
    assembly.add("buckle", block(middle("pelvis", 0.8) + [0, 1.18 * radius("pelvis"), 0], [0.018, 0.006, 0.014], 5, 10), "pelvis")
    for plate, bone, share, length in (("pauldron", "arm", 0.1, 0.05), ("vambrace", "forearm", 0.55, 0.045), ("cuisse", "thigh", 0.45, 0.07), ("greave", "shin", 0.5, 0.075)):
        at = middle("left " + bone, share)
        axis = middle("left " + bone, 1.0) - middle("left " + bone, 0.0)
        assembly.add_pair(plate, ball(at, [1.35 * radius("left " + bone), 1.3 * radius("left " + bone), length], 9, 16, axis, 0.3), bone)
    for row in range(3):
        at = middle("pelvis", 0.3 - 0.25 * row) + [0.055 + 0.008 * row, 0.075 - 0.01 * row, 0]
        assembly.add_pair(f"tasset {row}", block(at, [0.03, 0.008, 0.022], 6, 12, 0.2), "pelvis")
    if number % 2:
        drape = np.array([[0, -0.09, 0.8], [0, -0.13, 0.55], [0, -0.16, 0.2]])
        assembly.add("cape", Sheet(drape, [0.2, 0.3, 0.38], -Y, 16, 12), "chest")


def robot(assembly: Assembly, number: int) -> None:
    """Some thirty blocks and discs that touch."""
    human(assembly, fingers=number % 2 == 1)
    segments(assembly, gap=(0.0, 0.0), section=5.0, ends=9.0, skip=("neck",), moulded=0.0)
    middle = assembly.middle
    for joint, axis in (("thigh", X), ("shin", X), ("arm", X), ("forearm", X + 0.3 * Y)):
        radius = assembly.skeleton.start_radius[assembly.bones["left " + joint]]
        assembly.add_pair("hub of " + joint, disc(middle("left " + joint, 0.0), axis, 0.7 * radius, 1.1 * radius, 14), joint)
    assembly.add("neck", disc(middle("neck"), Z, 0.03, 0.03), "neck")
    assembly.add("lamp", disc(middle("chest", 0.7) + [0, 0.1, 0], Y, 0.022, 0.008), "chest")
    assembly.add("pack", block(middle("chest", 0.5) + [0, -0.13, 0], [0.07, 0.035, 0.06], 9, 16), "chest")
    assembly.add("grille", block(middle("head", 0.2) + [0, 0.066, 0], [0.03, 0.006, 0.012], 5, 12), "head")
    assembly.add_pair("eye", disc(middle("head", 0.6) + [0.025, 0.066, 0], Y, 0.012, 0.006, 12), "head")
    antenna = middle("head", 1.0) + [0.03, -0.01, 0]
    assembly.add_pair("antenna", Lathe(np.array([antenna, antenna + [0.012, 0, 0.06]]), [0.005, 0.003], 8, 8), "head")
    assembly.add_pair("antenna tip", ball(antenna + [0.012, 0, 0.066], 0.008, 5, 8), "head")
    assembly.add_pair("nozzle", Lathe(middle("chest", 0.2) + np.array([[0.035, -0.14, 0], [0.035, -0.15, -0.06]]), [0.012, 0.022], 6, 12, 8.0), "chest")


def dressed(assembly: Assembly, number: int) -> None:
    """A body with eyes in two layers, teeth, lashes, hair cards, a shirt and shoes."""
    human(assembly, fingers=number % 2 == 0)
    assembly.add("body", body_of(assembly, 0.0155), None)
    head, wide = assembly.middle("head"), assembly.skeleton.start_radius[assembly.bones["head"]]
    eye = head + [0.026, 0.82 * wide, 0.012]
    assembly.add_pair("eye", ball(eye, 0.013, 6, 10, Y), "head")
    assembly.add_pair("cornea", ball(eye, 0.0135, 6, 10, Y), "head")
    for k in range(6):
        root = eye + [0.004 * (k - 2.5), 0.013 - 0.0006 * (k - 2.5) ** 2, 0.005]
        tip = root + [0.0015 * (k - 2), 0.012, 0.004 + 0.001 * (k % 2)]
        assembly.add_pair(f"lash {k}", Sheet(np.array([root, (root + tip) / 2 - [0, 0, 0.001], tip]), [0.003, 0.0006], Z, 4, 2), "head")
    for row, (height, drop) in enumerate(((-0.016, -0.006), (-0.03, 0.005))):
        for k in range(5):
            angle = 0.16 + 0.27 * k
            at = head + [0.024 * np.sin(angle), 0.6 * wide + 0.022 * np.cos(angle), height]
            assembly.add_pair(f"tooth {row} {k}", ball(at, [0.003 + 0.0004 * k, 0.002 + 0.0004 * k, abs(drop)], 4, 8), "head")
    hair(assembly, head, wide, sides=2, rows=8 + number)
    if number % 2 == 0:
        trunk = ("belly", "chest", "left arm", "right arm")
        assembly.add("shirt", body_of(assembly, 0.019, 1.18, trunk), None)
    foot = assembly.middle("left foot")
    assembly.add_pair("shoe", Lathe(foot + np.array([[-0.01, -0.085, 0.004], [0.012, 0.08, -0.004]]), [[0.036, 0.036], [0.04, 0.036], [0.034, 0.024]], 12, 16, 4.0, 3.0, 0.1, Z), "foot")
    assembly.add_pair("sole", Lathe(foot + np.array([[-0.01, -0.085, -0.032], [0.012, 0.08, -0.032]]), [[0.036, 0.008], [0.042, 0.008], [0.036, 0.008]], 10, 12, 6.0, 3.0, 0.0, Z), "foot")


def hair(assembly: Assembly, head, wide: float, sides: int, rows: int) -> None:
    """Hair cards around the head; on one side they have no counterpart."""
    for k in range(rows):
        around = 0.3 + 2.6 * k / rows
        root = head + [0.75 * wide * np.sin(around), 0.75 * wide * np.cos(around), 0.055 + 0.006 * (k % 2)]
        out = unit(np.array([np.sin(around), np.cos(around) - 0.3, 0]))
        length = 0.1 + 0.015 * ((3 * k) % 4)
        path = np.array([root, root + 0.035 * out - [0, 0, 0.03], root + 0.04 * out - [0, 0, length]])
        sheet = Sheet(path, [0.016, 0.024, 0.012], out, 8, 3, 0.2)
        if sides == 2:
            assembly.add_pair(f"hair {k}", sheet, "head")
        else:
            assembly.add(f"hair {k}", sheet, "head", None)


def hat(assembly: Assembly, number: int) -> None:
    """A figure under a great hat, tilted, its tip bent to one side."""
    human(assembly, fingers=False)
    segments(assembly)
    face(assembly)
    top = assembly.middle("head", 0.75)
    assembly.bone("hat", top, top + [0, 0, 0.3], [0.1, 0.03], "head")
    assembly.turn("hat", unit(assembly.rng.normal(size=3) * [1, 1, 0]), 0.15, 0.45)
    size = assembly.rng.uniform(0.9, 1.3)
    bend = (top + [0, 0, 0.1], Z, 0.25 * size, unit(assembly.rng.normal(size=3) * [1, 1, 0.1]), assembly.rng.uniform(0.5, 1.1))
    assembly.add("hat cone", Lathe(top + size * np.array([[0, 0, 0.0], [0, -0.02, 0.2], [0, -0.06, 0.36]]), size * np.array([0.12, 0.09, 0.05, 0.012]), 22, 26, 5.0, 2.0, 0.1), "hat", "", bend)
    assembly.add("hat brim", ball(top, [0.22 * size, 0.24 * size, 0.012], 13, 34, bulge=0.1), "hat")
    assembly.add("hat band", disc(top + [0, 0, 0.05 * size], Z, 0.122 * size, 0.014), "hat")
    if number % 2:
        assembly.add("feather", Sheet(top + np.array([[0.11, 0, 0.05], [0.15, -0.06, 0.12], [0.16, -0.16, 0.16]]), [0.01, 0.04, 0.01], X, 14, 4), "hat", None)


def half_hair(assembly: Assembly, number: int) -> None:
    """Hair on one side only: cards, or one large mass."""
    human(assembly, fingers=False)
    if number % 2:
        assembly.add("body", body_of(assembly, 0.0165), None)
    else:
        segments(assembly)
    face(assembly)
    head, wide = assembly.middle("head"), assembly.skeleton.start_radius[assembly.bones["head"]]
    if number % 3 == 0:
        lock = np.array([[0.02, -0.02, 0.07], [wide, -0.02, 0.0], [1.5 * wide, 0.0, -0.12], [1.2 * wide, 0.05, -0.3]])
        assembly.add("mass of hair", Lathe(head + lock, [[0.05, 0.06], [0.06, 0.07], [0.05, 0.06], [0.02, 0.02]], 22, 20, 3.0), "head", None)
    else:
        hair(assembly, head, wide, sides=1, rows=10 + 2 * number)
