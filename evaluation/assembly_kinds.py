"""Kinds of generated assemblies: figures, birds, furniture and vehicles of many parts."""

from __future__ import annotations

import numpy as np

from training.skeleton import unit

from . import figures
from .assembly import Assembly
from .figures import segments
from .shells import X, Y, Z, Lathe, Sheet, ball, block, disc


def bird(assembly: Assembly, number: int) -> None:
    """A bird with rows of feathers on wings and tail."""
    rng = assembly.rng
    assembly.bone("trunk", [0, -0.15, 0.4], [0, 0.15, 0.45], [0.1, 0.11], None)
    assembly.bone("neck", [0, 0.15, 0.46], [0, 0.25, 0.56], [0.06, 0.045], "trunk")
    assembly.bone("head", [0, 0.25, 0.57], [0, 0.33, 0.6], [0.05, 0.045], "neck")
    assembly.bone("tail", [0, -0.2, 0.4], [0, -0.3, 0.38], [0.06, 0.04], "trunk")
    wing = [("arm", "trunk", [0.1, 0.08, 0.47], [0.27, 0.0, 0.5], 0.035), ("forearm", "arm", [0.27, 0.0, 0.5], [0.46, 0.06, 0.5], 0.026), ("hand", "forearm", [0.46, 0.06, 0.5], [0.62, 0.03, 0.49], 0.02)]
    leg = [("thigh", "trunk", [0.06, 0.0, 0.34], [0.075, 0.03, 0.22], 0.03), ("shin", "thigh", [0.075, 0.03, 0.22], [0.08, -0.03, 0.06], 0.016), ("foot", "shin", [0.08, -0.03, 0.05], [0.08, 0.03, 0.03], 0.016)]
    for name, parent, start, end, radius in wing + leg:
        assembly.bone_pair(name, start, end, [radius, 0.85 * radius], parent)
    for name, axis, low, high in (("arm", Y, -0.6, 0.6), ("forearm", Z, -0.2, 0.7), ("hand", Z, -0.6, 0.2), ("thigh", X, -0.5, 0.7), ("shin", X, -0.5, 0.5), ("neck", X, -0.3, 0.4), ("head", Z, -0.8, 0.8), ("tail", X, -0.3, 0.3), ("foot", X, -0.3, 0.3)):
        assembly.turn(name, axis, low, high)
    segments(assembly, moulded=0.0)
    assembly.add("upper beak", Lathe(np.array([[0, 0.35, 0.605], [0, 0.4, 0.6], [0, 0.43, 0.575]]), [[0.02, 0.016], [0.014, 0.012], [0.004, 0.004]], 10, 12, 4.0, 2.0, 0.1, Z), "head")
    assembly.add("lower beak", Lathe(np.array([[0, 0.35, 0.59], [0, 0.41, 0.575]]), [[0.016, 0.01], [0.005, 0.004]], 8, 10, 4.0, 2.0, 0.1, Z), "head")
    assembly.add_pair("eye", ball([0.042, 0.3, 0.605], 0.011), "head")
    for toe in range(3):
        path = np.array([[0.08, 0.0, 0.03], [0.08 + 0.03 * (toe - 0.8), 0.1 - 0.012 * abs(toe - 1), 0.018]])
        assembly.add_pair(f"toe {toe}", Lathe(path, [0.011, 0.006], 8, 8, 3.0, 2.0, 0.1, Z), "foot")
    rows = [("primary", "hand", 8, 0.24, 0.0, 0.6), ("secondary", "forearm", 8, 0.18, 0.0, 0.1), ("tertial", "arm", 4, 0.14, 0.0, 0.0), ("covert", "hand", 6, 0.1, 0.012, 0.5), ("second covert", "forearm", 7, 0.09, 0.012, 0.1)]
    for row, bone, count, length, lift, spread in rows:
        for k in range(count):
            share = (k + 0.5) / count
            root = assembly.middle("left " + bone, share) + [0, -0.01, lift + 0.002 * k]
            aim = unit(np.array([spread * (0.3 + share), -1.0, -0.05]))
            reach = length * (1 + 0.25 * share) * rng.uniform(0.97, 1.03)
            path = np.array([root, root + 0.5 * reach * aim - [0, 0, 0.006], root + reach * aim])
            curl = lambda mirror, at=root, to=aim, far=reach: (at * mirror, to * mirror, far, unit(np.cross(to * mirror, Z)), rng.uniform(-0.25, 0.25))
            assembly.add_pair(f"{row} {k}", Sheet(path, [0.016, 0.036, 0.03, 0.006], Z, 10, 4), bone, curl)
    for k in range(4):
        aim = unit(np.array([0.22 * k, -1.0, -0.05]))
        root = np.array([0.008 * k, -0.27, 0.39 - 0.003 * k])
        feather = Sheet(np.array([root, root + 0.12 * aim, root + 0.25 * aim]), [0.02, 0.045, 0.04, 0.01], Z, 10, 4)
        if k:
            assembly.add_pair(f"tail feather {k}", feather, "tail")
        else:
            assembly.add("tail feather", feather, "tail")


def furniture(assembly: Assembly, number: int) -> None:
    """A cabinet with doors and drawers, or an armchair; every second one at rest."""
    (cabinet if number % 3 else armchair)(assembly, moved=number % 2 == 1)


def cabinet(assembly: Assembly, moved: bool) -> None:
    """A cabinet on four legs, two doors on hinges, three drawers."""
    wide, deep, high = (assembly.rng.uniform(*span) for span in ((0.3, 0.45), (0.18, 0.25), (0.35, 0.5)))
    assembly.bone("case", [0, 0, 0], [0, 0, high], [0.1, 0.1], None)
    assembly.bone_pair("door", [wide, deep, 0.3], [0, deep, 0.3], [0.1, 0.1], "case")
    assembly.add("case", block([0, -0.01, high], [wide, deep, high], 16, 32), "case")
    assembly.add("top", block([0, 0, 2 * high + 0.02], [1.08 * wide, 1.1 * deep, 0.02], 6, 28), "case")
    assembly.add("crown", Lathe(np.array([[-0.5 * wide, -deep, 2 * high + 0.08], [0.5 * wide, -deep, 2 * high + 0.08]]), [[0.02, 0.03], [0.04, 0.06], [0.02, 0.03]], 13, 12, 4.0, 3.0, 0.2, Z), "case")
    assembly.add_pair("door", block([wide / 2, deep + 0.012, 0.62 * high], [0.49 * wide, 0.012, 0.58 * high], 12, 22), "door")
    assembly.add_pair("panel", block([wide / 2, deep + 0.026, 0.62 * high], [0.36 * wide, 0.006, 0.42 * high], 9, 18), "door")
    assembly.add_pair("handle", ball([0.08 * wide, deep + 0.045, 0.6 * high], [0.012, 0.02, 0.03], bulge=0.2), "door")
    for row in range(3):
        height = (1.35 + 0.25 * row) * high
        assembly.bone(f"drawer {row}", [0, 0, height], [0, deep, height], [0.1, 0.1], "case")
        assembly.add(f"drawer {row}", block([0, deep + 0.014, height], [0.94 * wide, 0.014, 0.11 * high], 8, 26), f"drawer {row}")
        assembly.add_pair(f"knob {row}", ball([0.5 * wide, deep + 0.045, height], 0.018), f"drawer {row}")
        if moved:
            assembly.shifts[f"drawer {row}"] = Y * assembly.rng.uniform(0, 0.2)
    legs = (("front", deep, [0.035, 0.03, 0.02]), ("back", -deep, [0.03, 0.028, 0.026]))
    for name, y, radii in legs:
        path = np.array([[0.88 * wide, 0.85 * y, 0.0], [0.9 * wide, 0.9 * y, -0.2]])
        assembly.add_pair(f"{name} leg", Lathe(path, radii, 10, 12, 6.0, 3.0), "case")
    if moved:
        assembly.turn("door", -Z, 0.1, 1.4, 0.0)


def armchair(assembly: Assembly, moved: bool) -> None:
    """An armchair with slats, cushions, arms and four legs; moved, its back leans and a cushion slips."""
    wide = assembly.rng.uniform(0.25, 0.35)
    assembly.bone("seat", [0, -0.2, 0.4], [0, 0.2, 0.4], [0.1, 0.1], None)
    assembly.bone("back", [0, -0.22, 0.42], [0, -0.3, 0.9], [0.1, 0.1], "seat")
    assembly.bone("cushion", [0, 0, 0.45], [0, 0.1, 0.45], [0.1, 0.1], "seat")
    assembly.add("seat", block([0, 0, 0.4], [wide, 0.25, 0.025], 10, 30), "seat")
    assembly.add("cushion", ball([0, 0.02, 0.47], [0.85 * wide, 0.21, 0.05], 12, 24, bulge=0.1), "cushion")
    assembly.add("back cushion", ball([0, -0.2, 0.66], [0.75 * wide, 0.05, 0.16], 12, 22, bulge=0.4), "back")
    assembly.add("rail", Lathe(np.array([[-wide, -0.3, 0.92], [0, -0.32, 0.94], [wide, -0.3, 0.92]]), [0.03, 0.035, 0.03], 15, 14, 6.0, 3.0, 0.1, Z), "back")
    for k in range(4):
        x = wide * (0.15 + 0.26 * k)
        assembly.add_pair(f"slat {k}", Lathe(np.array([[x, -0.24, 0.43], [x, -0.29, 0.7], [x, -0.31, 0.9]]), [[0.02, 0.008]] * 2, 12, 10, 10.0, 5.0), "back")
    for name, y in (("front", 0.2), ("back", -0.22)):
        assembly.add_pair(f"{name} leg", Lathe(np.array([[0.9 * wide, y, 0.38], [0.95 * wide, 1.15 * y, 0.0]]), [0.03, 0.024 + 0.01 * (y > 0), 0.02], 12, 12, 6.0, 3.0), "seat")
        assembly.add_pair(f"{name} post", Lathe(np.array([[wide, y, 0.42], [wide, y - 0.02, 0.6]]), [0.02, 0.026, 0.02], 9, 10, 6.0), "seat")
    assembly.add_pair("arm", Lathe(np.array([[wide, -0.27, 0.62], [wide, 0.27, 0.62]]), [[0.035, 0.02], [0.04, 0.022], [0.045, 0.026]], 14, 14, 4.0, 3.0, 0.1, Z), "seat")
    if moved:
        assembly.turn("back", X, 0.0, 0.3, 0.0)
        assembly.turn("cushion", Z, -0.3, 0.3, 0.05)


def vehicle(assembly: Assembly, number: int) -> None:
    """A car or an aeroplane; every second one at rest, the others with doors open or flaps down."""
    (car if number % 3 else aeroplane)(assembly, moved=number % 2 == 1)


def car(assembly: Assembly, moved: bool) -> None:
    """A car: doors, wheels, lamps, seats; its steering wheel and exhaust are on one side."""
    assembly.bone("chassis", [0, -0.5, 0.2], [0, 0.5, 0.2], [0.1, 0.1], None)
    assembly.bone("hood", [0, 0.22, 0.3], [0, 0.5, 0.28], [0.1, 0.1], "chassis")
    hinge = {"front door": 0.2, "rear door": -0.08}
    assembly.add("chassis", Lathe(np.array([[0, -0.55, 0.2], [0, 0.55, 0.19]]), [[0.22, 0.1], [0.24, 0.11], [0.21, 0.08]], 20, 26, 8.0, 5.0, 0.0, Z), "chassis")
    assembly.add("cabin", Lathe(np.array([[0, -0.42, 0.34], [0, 0.26, 0.32]]), [[0.19, 0.1], [0.2, 0.13], [0.17, 0.06]], 14, 22, 4.0, 4.0, 0.1, Z), "chassis")
    assembly.add("hood", block([0, 0.38, 0.295], [0.18, 0.15, 0.012], 6, 24), "hood")
    for name, y in (("front bumper", 0.57), ("rear bumper", -0.57)):
        assembly.add(name, block([0, y, 0.13], [0.23, 0.02, 0.03 + 0.008 * (y > 0)], 6, 24), "chassis")
    for name, y in hinge.items():
        assembly.bone_pair(name, [0.24, y, 0.2], [0.24, y - 0.26, 0.2], [0.1, 0.1], "chassis")
        assembly.add_pair(name, block([0.252, y - 0.13, 0.23], [0.012, 0.125, 0.09], 9, 20), name)
        assembly.add_pair("handle of " + name, ball([0.27, y - 0.22, 0.27], [0.006, 0.02, 0.006]), name)
    assembly.add_pair("mirror", ball([0.3, 0.16, 0.33], [0.03, 0.014, 0.02], bulge=0.4), "front door")
    for name, y, radius in (("front", 0.36, 0.085), ("rear", -0.36, 0.092)):
        assembly.bone_pair(f"{name} wheel", [0.22, y, 0.09], [0.28, y, 0.09], [0.1, 0.1], "chassis")
        assembly.add_pair(f"{name} tyre", disc([0.23, y, 0.09], X, radius, 0.03, 24), f"{name} wheel")
        assembly.add_pair(f"{name} hub", ball([0.262, y, 0.09], [0.5 * radius, 0.5 * radius, 0.01], 6, 14, X), f"{name} wheel")
        assembly.add_pair(f"{name} lamp", ball([0.16, 1.57 * y, 0.22], [0.04, 0.012, 0.022 + 0.006 * (y > 0)], bulge=0.3), "chassis")
        assembly.add_pair(f"{name} seat", block([0.1, 0.5 * y - 0.05, 0.3], [0.06, 0.05, 0.05], 7, 14, 0.1), "chassis")
    assembly.add("steering wheel", disc([0.1, 0.16, 0.33], Y + 0.4 * Z, 0.04, 0.006, 16), "chassis", None)
    assembly.add("exhaust", Lathe(np.array([[-0.14, -0.5, 0.09], [-0.14, -0.6, 0.085]]), [0.016, 0.018], 6, 10, 8.0, 2.0, 0.0, Z), "chassis", None)
    if moved:
        assembly.turn("hood", X, 0.0, 0.8, 0.0)
        for name in hinge:
            assembly.turn(name, Z, -1.0, -0.05, 0.0)
        assembly.turn("front wheel", Z, 0.2, 0.4, 0.0)


def aeroplane(assembly: Assembly, moved: bool) -> None:
    """An aeroplane with engines, flaps, rudder and wheels; moved, its wings bend up and its flaps are down."""
    assembly.bone("hull", [0, -0.5, 0.2], [0, 0.5, 0.2], [0.1, 0.1], None)
    assembly.bone("rudder", [0, -0.48, 0.3], [0, -0.56, 0.42], [0.1, 0.1], "hull")
    bones = [("wing", "hull", [0.07, 0.05, 0.18], [0.6, -0.1, 0.22]), ("flap", "wing", [0.2, -0.06, 0.19], [0.4, -0.12, 0.2]), ("elevator", "hull", [0.03, -0.45, 0.25], [0.2, -0.52, 0.26])]
    for name, parent, start, end in bones:
        assembly.bone_pair(name, start, end, [0.1, 0.1], parent)
    assembly.add("hull", Lathe(np.array([[0, -0.58, 0.26], [0, -0.2, 0.2], [0, 0.58, 0.19]]), [0.02, 0.06, 0.08, 0.08, 0.06], 26, 22, 3.0, 2.0, 0.05, Z), "hull")
    assembly.add("fin", Lathe(np.array([[0, -0.44, 0.26], [0, -0.52, 0.46]]), [[0.01, 0.07], [0.007, 0.04]], 10, 16, 8.0, 2.0, 0.2, -Y), "hull")
    assembly.add("rudder", block([0, -0.58, 0.36], [0.005, 0.025, 0.08], 8, 12), "rudder")
    assembly.add("canopy", ball([0, 0.4, 0.255], [0.04, 0.09, 0.03], 9, 14, bulge=0.3), "hull")
    assembly.add_pair("wing", Lathe(np.array([[0.06, 0.02, 0.18], [0.62, -0.12, 0.22]]), [[0.012, 0.12], [0.006, 0.05]], 20, 18, 10.0, 2.0, 0.2), "wing")
    assembly.add_pair("flap", block([0.28, -0.13, 0.192], [0.09, 0.03, 0.005], 6, 18), "flap")
    assembly.add_pair("aileron", block([0.48, -0.155, 0.21], [0.08, 0.022, 0.004], 6, 16), "wing")
    assembly.add_pair("elevator", Lathe(np.array([[0.02, -0.48, 0.25], [0.22, -0.54, 0.26]]), [[0.007, 0.06], [0.005, 0.03]], 10, 14, 10.0, 2.0, 0.2), "elevator")
    for name, x in (("inner", 0.2), ("outer", 0.38)):
        path = np.array([[x, -0.02, 0.15], [x, 0.14, 0.145]])
        assembly.add_pair(f"{name} engine", Lathe(path, [0.02, 0.035, 0.035 - 0.02 * (x - 0.2)], 12, 14, 6.0, 2.0, 0.0, Z), "wing")
        assembly.add_pair(f"{name} spinner", ball([x, 0.15, 0.145], [0.014, 0.014, 0.025], 6, 10, Y), "wing")
    assembly.add_pair("wheel", disc([0.1, 0.0, 0.06], X, 0.03, 0.012, 16), "hull")
    assembly.add_pair("strut", Lathe(np.array([[0.1, 0.0, 0.17], [0.1, 0.0, 0.07]]), [0.008, 0.008], 6, 8, 10.0), "hull")
    assembly.add("nose wheel", disc([0, 0.4, 0.07], X, 0.025, 0.01, 16), "hull")
    if moved:
        assembly.turn("wing", Y, -0.25, 0.1, 0.02)
        assembly.turn("flap", X + 0.1 * Y, 0.1, 0.6, 0.0)
        assembly.turn("elevator", X, -0.4, 0.4, 0.0)
        assembly.turn("rudder", Z, -0.4, 0.4, 0.0)


KINDS = {
    "mannequin": figures.mannequin, "jointed": figures.jointed, "armour": figures.armour, "robot": figures.robot, "dressed": figures.dressed,
    "bird": bird, "furniture": furniture, "vehicle": vehicle, "hat": figures.hat, "half-hair": figures.half_hair,
}  # fmt: skip
