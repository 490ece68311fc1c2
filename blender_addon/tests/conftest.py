# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender with the extension installed from its zip, as a user does it, and bodies of examples/ in it."""

import os
import shutil
import tempfile
from pathlib import Path

_RESOURCES = tempfile.mkdtemp(prefix="intrinsym_blender_")
os.environ["BLENDER_USER_RESOURCES"] = _RESOURCES  # before bpy is imported

import bpy  # noqa: E402
import bmesh  # noqa: E402, I001
import numpy as np  # noqa: E402
import pytest  # noqa: E402
from mathutils import Matrix  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
MODULE = "bl_ext.user_default.intrinsic_symmetry"


def extension_zip():
    found = sorted((ROOT / "out" / "blender").glob("intrinsic_symmetry-*.zip"))
    if not found:
        pytest.exit("out/blender holds no extension: make blender-extension", returncode=1)
    return found[-1]


def pytest_configure():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install()


def install():
    bpy.ops.extensions.package_install_files(
        repo="user_default", filepath=str(extension_zip()), enable_on_install=True
    )


def pytest_unconfigure():
    shutil.rmtree(_RESOURCES, ignore_errors=True)


def module(name):
    """A module of the installed extension."""
    import importlib

    return importlib.import_module(f"{MODULE}.{name}")


def new_object(mesh, name="object"):
    """Links a mesh to the scene as the active and only selected object."""
    bpy.context.view_layer.update()
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    object = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(object)
    bpy.context.view_layer.objects.active = object
    object.select_set(True)
    return object


def read_example(name):
    """A mesh of examples/, polygons as they are."""
    import intrinsym

    source = intrinsym.Mesh.read(EXAMPLES / f"{name}.ply")
    offsets, corners = source.polygons
    faces = [corners[a:b].tolist() for a, b in zip(offsets[:-1], offsets[1:])]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(source.vertices.tolist(), [], faces)
    return mesh


def truth_of(name):
    return np.loadtxt(EXAMPLES / f"{name}.mirror", dtype=np.int64)


def touching_shells(truth, apart):
    """The human with an uneven ball at the farthest left vertex and the mirrored one at its image; their poles touch it, but for
    a distance. The vertices of each side that touch."""
    mesh, data = read_example("human"), bmesh.new()
    points = positions(mesh)
    hand, count = int(points[:, 0].argmax()), len(points)
    data.from_mesh(mesh)
    for number, vertex in enumerate((hand, int(truth[hand]))):
        new = bmesh.ops.create_icosphere(data, subdivisions=2, radius=0.05)["verts"]
        uneven = np.array([each.co for each in new]) * (1, 2, 3) + np.random.default_rng(0).uniform(-0.005, 0.005, (len(new), 3))
        uneven = (uneven - uneven[0]) * ((-1, 1, 1) if number else (1, 1, 1)) @ np.array(Matrix.Rotation(number, 3, (1, 2, 3)))
        for each, place in zip(new, points[vertex] + apart + uneven):
            each.co = place
        if number:
            bmesh.ops.reverse_faces(data, faces=list({face for each in new for face in each.link_faces}))
    data.to_mesh(mesh)
    data.free()
    size = (len(mesh.vertices) - count) // 2
    return new_object(mesh), [(hand, count), (int(truth[hand]), count + size)]


def attribute(mesh, name):
    return module("mesh_data").read_attribute(mesh.attributes[name])


def positions(mesh):
    return module("mesh_data").positions(mesh).astype(float)


def select(object, vertices):
    """Selects vertices, and the edges and faces between them, in object mode."""
    flags = np.zeros(len(object.data.vertices), bool)
    flags[vertices] = True
    module("ops_select").write_selection(bpy.context, object.data, flags)


def edit_faces(object, faces):
    """Selects faces, in edit mode."""
    enter("OBJECT")
    select(object, [])
    chosen = np.zeros(len(object.data.polygons), bool)
    chosen[faces] = True
    object.data.polygons.foreach_set("select", chosen)
    bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    enter("EDIT")


def faces_around(mesh, vertex, chosen):
    """Faces of the left side by their distance from a vertex, of which some are chosen by a slice; and their mirror
    images."""
    side, partner, place = attribute(mesh, "sym_side"), attribute(mesh, "sym_vertex"), positions(mesh)[vertex]
    left = [face.index for face in mesh.polygons if (side[list(face.vertices)] == 1).all()]
    near = sorted(left, key=lambda face: np.linalg.norm(np.array(mesh.polygons[face].center) - place))[chosen]
    of = {frozenset(face.vertices): face.index for face in mesh.polygons}
    return near, [of[frozenset(partner[list(mesh.polygons[face].vertices)].tolist())] for face in near]


def ring(edge):
    """The edges that a loop cut crosses."""
    found = {edge}
    for loop in edge.link_loops:
        while len(loop.face.verts) == 4:
            loop = loop.link_loop_next.link_loop_next
            if loop.edge in found:
                break
            found.add(loop.edge)
            loop = loop.link_loop_radial_next
    return list(found)


def selected(object):
    """Numbers of the selected vertices, in any mode."""
    with module("mesh_data").object_mode(bpy.context):
        return np.flatnonzero(module("mesh_data").selected_vertices(object.data))


@pytest.fixture(autouse=True)
def clean_scene():
    """Each test starts in object mode, without objects, in vertex select mode, and shows nothing."""
    yield
    if bpy.context.object and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for object in list(bpy.data.objects):
        bpy.data.objects.remove(object)
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    if hasattr(bpy.types.WindowManager, "intrinsic_symmetry_show"):
        bpy.context.window_manager.intrinsic_symmetry_show.colours = "NONE"


_detected = {}


def _with_symmetry(name):
    """An object with its symmetry detected once a session."""
    if name not in _detected or _detected[name] not in bpy.data.meshes.keys():
        object = new_object(read_example(name), name)
        assert bpy.ops.intrinsic_symmetry.detect() == {"FINISHED"}
        object.data.use_fake_user = True
        _detected[name] = object.data.name
        bpy.data.objects.remove(object)
    return new_object(bpy.data.meshes[_detected[name]].copy(), name)


@pytest.fixture
def human():
    """The posed human, 13,380 vertices, quads, its connectivity mirrored; with its symmetry."""
    return _with_symmetry("human")


@pytest.fixture
def quadruped():
    """An animal in stride whose left and right share no connectivity; with its symmetry."""
    return _with_symmetry("quadruped")


@pytest.fixture
def truth():
    return truth_of("human")


@pytest.fixture(params=["OBJECT", "EDIT"])
def mode(request):
    """Each test that asks for it runs in both modes."""
    return request.param


def enter(mode):
    if bpy.context.object.mode != mode:
        bpy.ops.object.mode_set(mode=mode)


def said(capfd, operator, **settings):
    """What an operator reports, beside finishing."""
    capfd.readouterr()
    assert operator(**settings) == {"FINISHED"}
    return "".join(capfd.readouterr())
