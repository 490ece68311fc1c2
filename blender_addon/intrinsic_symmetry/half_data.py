# SPDX-License-Identifier: GPL-3.0-or-later
"""What the vertices and face corners of a rebuilt half take from the surface that was there.

Vertices of the copy lie at the mirror images of their models. Positions, shape keys, weights and attributes are
interpolated there.
"""

import functools

import bpy
import numpy as np
from mathutils.kdtree import KDTree

from . import mesh_data, side_names, stored_map
from .half_labels import LOSES, WINS
from .local_frames import turns as turns_of
from .regions import parts, uv_islands
from .rigid_pieces import brought
from .surface import Mix, Surface
from .weights import read_weights, write_weights


def vertex_mix(source, halves, symmetry):
    """The Mix of old vertices for new ones with the sources that `half_copy` writes."""
    old = len(halves.labels)
    points, shares = symmetry.surface_points, halves.shares
    own = np.repeat(np.arange(old)[:, None], 3, axis=1)
    cut = np.stack([halves.winning, halves.losing, halves.losing], axis=1)
    there = np.where(symmetry.partner[:, None] < 0, own, points.corners.astype(np.int64))
    rows = np.vstack([own, cut, there])
    weights = np.vstack([
        np.tile((1.0, 0.0, 0.0), (old, 1)),
        np.stack([1 - shares, shares, 0 * shares], axis=1),
        np.where(symmetry.partner[:, None] < 0, (1.0, 0.0, 0.0), points.barycentrics),
    ])
    return Mix(rows, weights).at(np.where(source >= 0, source, old + len(shares) - 1 - source))


def _make_missing_groups(object, weights):
    """Makes the counterparts of the groups in which there are any of the weights, (vertices, groups); how many."""
    names = [group.name for group in object.vertex_groups]
    others = [side_names.counterpart(name, names) for name, is_so in zip(names, weights.any(axis=0)) if is_so]
    missing = [name for name in dict.fromkeys(others) if name not in names and not side_names.is_too_long(name)]
    for name in missing:
        object.vertex_groups.new(name=name)
    return len(missing)


class Old:
    """The data of an object before its half is rebuilt."""

    def __init__(self, object, halves, symmetry):
        mesh, keys = object.data, object.data.shape_keys
        self.positions = mesh_data.positions(mesh).astype(float)
        self.keys = [mesh_data.key_positions(key).astype(float) for key in keys.key_blocks] if keys else []
        self.weights = read_weights(object) if object.vertex_groups else None
        self.offsets, self.corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        self.values = {
            domain: {each.name: mesh_data.read_attribute(each) for each in mesh.attributes if _is_own(each, domain)}
            for domain in ("POINT", "CORNER")
        }
        of_faces = [each for each in mesh.attributes if is_of_faces(each)]
        for domain in ("FACE", "EDGE"):
            self.values[domain] = {each.name: mesh_data.read_attribute(each) for each in of_faces if each.domain == domain}
        self._kinds = {each.name: each.data_type for each in mesh.attributes}
        self.lift = stored_map.read_lift(mesh)
        self.ends, made = mesh_data.edges(mesh).astype(np.int64), stored_map.read_edit(mesh) == stored_map.MADE
        self._beside = [_beside(key - self.positions, symmetry.surface_points, made) for key in self.keys]
        if self.keys:
            self._give_twins(object, halves, symmetry, made)
        self._hidden = mesh_data.changeable(mesh, "EDIT") == 0
        self.uvs = {layer.name for layer in mesh.uv_layers}
        self.surface = Surface(mesh, halves.carried(self.positions - self.lift), halves.labels == LOSES)

    def _give_twins(self, object, halves, symmetry, made):
        """Gives the keys at the twins of what an edit has `made` or moved on the winning side alone, (vertices,) bool, that side's.
        On the active key the edit has moved what has other faces, too."""
        keys, moves = object.data.shape_keys.key_blocks, [key - self.positions for key in self.keys]
        others = side_names.counterpart_columns([key.name for key in keys])
        turns = functools.cache(lambda: turns_of(symmetry, self.positions))
        for number, other in enumerate(others):
            edited = stored_map.read_edit(object.data) > 0 if keys[other].name == mesh_data.shown_key(object) else made
            edited = edited & (halves.labels == WINS) & (halves.twin >= 0) & ~made[halves.twin]
            rows = np.flatnonzero(edited) if other >= 0 else np.zeros(0, np.int64)
            twin = halves.twin[rows]
            if len(rows) and (moves[other][rows].any() or moves[number][twin].any()):
                turn = np.where(halves.at_rest[rows, None, None], halves.reflection, turns()[twin])
                self.keys[number][twin] = self.positions[twin] + np.einsum("vxy,vy->vx", turn, moves[other][rows])

    def give_positions(self, object, mix, places, lift, moving, model, added):
        """Base shape and shape keys: the vertices are at `places`, (vertices, 3), and move as the surface there and, those
        that are `moving`, (vertices,) bool, beside that as their models do on the other side; `lift` is a function that turns
        the old vertices' lift. Those that were added move as their models do."""
        mesh, keys = object.data, object.data.shape_keys
        moved, models = places - mix.of(self.positions), model.of(self.positions)
        keys = list(keys.key_blocks) if keys else []
        others = side_names.counterpart_columns([key.name for key in keys])
        shells = parts(added, mesh_data.edges(mesh).astype(np.int64))
        for key, points, own, other in zip(keys, self.keys, self._beside, others):
            there = mix.of(points) + moved
            if other >= 0:
                there += np.where(moving[:, None], lift(self._beside[other]) - mix.of(own), 0)
            wanted = model.of(self.keys[other]) if other >= 0 else models
            for shell in shells:
                there[shell] = brought(models[shell], places[shell], wanted[shell], -1)
            mesh_data.set_key_positions(key, there)
        mesh.vertices.foreach_set("co", np.ascontiguousarray(places, np.float32).ravel())

    def give_points(self, object, mix, copies, added):
        """Weights and attributes of the copied vertices. Those that were added keep their models', of groups with left and
        right exchanged."""
        mesh, taking = object.data, copies & ~added
        for name, values in self.values["POINT"].items():
            attribute = mesh.attributes[name]
            now = mesh_data.read_attribute(attribute)
            now[taking] = mix.at(taking).of(values)
            mesh_data.update_attribute(attribute, now)
        if self.weights is not None:
            now = read_weights(object)
            made = ((0, 0), (0, _make_missing_groups(object, now[added])))
            now, self.weights = np.pad(now, made), np.pad(self.weights, made)
            new = now.copy()
            new[taking] = mix.at(taking).of(self.weights)
            flipped = side_names.counterpart_columns([group.name for group in object.vertex_groups])
            new[added] = np.pad(now[added], ((0, 0), (0, 1)))[:, flipped]
            write_weights(object, now, new)

    def give_hidden(self, mesh, mix):
        """Hides vertices where what was there is hidden, and all edges and faces at them. What is hidden is not selected."""
        if not self._hidden.any():
            return
        hidden = mix.of(self._hidden)
        offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        values = {
            "vert": ("POINT", hidden),
            "edge": ("EDGE", hidden[mesh_data.edges(mesh)].any(axis=1)),
            "poly": ("FACE", np.logical_or.reduceat(hidden[corners], offsets[:-1])),
        }
        for kind, (domain, flags) in values.items():
            there = mesh.attributes.get(f".hide_{kind}")
            flags = flags if there is None else flags | mesh_data.read_attribute(there)
            mesh_data.write_attribute(mesh, f".hide_{kind}", "BOOLEAN", flags, domain)
            if f".select_{kind}" in mesh.attributes:
                chosen = mesh.attributes[f".select_{kind}"]
                mesh_data.update_attribute(chosen, mesh_data.read_attribute(chosen) & ~flags)

    def give_faces(self, mesh, copied, was):
        """Attributes of copied faces, (faces,) bool, that there were before, as those that were split off or pulled out, and of
        their corners and edges; `was`, (vertices,), are the numbers that the vertices had. (faces,) bool, which ones."""
        offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        touched = np.isin(self.corners, was[corners[np.repeat(copied, np.diff(offsets))]])
        chosen = np.flatnonzero(np.logical_and.reduceat(touched, self.offsets[:-1]))
        old = {frozenset(self._old_face(face)): face for face in chosen}
        found, pairs = np.zeros(len(copied), bool), {"FACE": [], "CORNER": [], "EDGE": []}
        count = {"FACE": len(copied), "CORNER": len(corners), "EDGE": len(mesh.edges)}
        if not old:
            return found
        edges = {frozenset(ends): row for row, ends in enumerate(self.ends.tolist())} if self.values["EDGE"] else {}
        edge_of = mesh_data.read_attribute(mesh.attributes[".corner_edge"])
        for face in np.flatnonzero(copied).tolist():
            loops = np.arange(offsets[face], offsets[face + 1])
            numbers = was[corners[loops]].tolist()
            before = old.get(frozenset(numbers))
            if before is None or len(self._old_face(before)) != len(numbers):
                continue
            pairs["FACE"].append((face, before))
            places = {vertex: self.offsets[before] + at for at, vertex in enumerate(self._old_face(before))}
            pairs["CORNER"] += [(loop, places[number]) for loop, number in zip(loops, numbers)]
            ends = zip(edge_of[loops], zip(numbers, numbers[1:] + numbers[:1]))
            pairs["EDGE"] += [(edge, edges[frozenset(each)]) for edge, each in ends if frozenset(each) in edges]
        for domain, rows in pairs.items():
            rows, sources = np.array(rows, np.int64).reshape(-1, 2).T
            for name, values in self.values[domain].items() if len(rows) else ():
                if name not in mesh.attributes:  # Blender leaves out flags that nothing has
                    mesh_data.write_attribute(mesh, name, self._kinds[name], np.zeros(count[domain]), domain)
                now = mesh_data.read_attribute(mesh.attributes[name])
                now[rows] = values[sources]
                mesh_data.update_attribute(mesh.attributes[name], now)
        found[[face for face, _ in pairs["FACE"]]] = True
        return found

    def _old_face(self, face):
        return self.corners[self.offsets[face] : self.offsets[face + 1]].tolist()

    def give_corners(self, mesh, copied, places):
        """Attributes of the corners of copied faces, (faces,) bool; the vertices are at `places`."""
        if not self.values["CORNER"] or not copied.any():
            return
        offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        face = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
        chosen = np.flatnonzero(copied[face])
        middle = np.add.reduceat(places[corners], offsets[:-1]) / np.diff(offsets)[:, None]
        below = self.surface.nearest(middle, np.flatnonzero(copied))[face[chosen]]
        beside = self.surface.nearest(places, np.unique(corners[chosen]))[corners[chosen]]
        for name, values in self.values["CORNER"].items():
            island = uv_islands(self.offsets, self.corners, values) if name in self.uvs else 0 * self.corners
            mix = self.surface.mix(places[corners[chosen]], below, beside, island)
            now = mesh_data.read_attribute(mesh.attributes[name])
            now[chosen] = mix.of(values)
            mesh_data.update_attribute(mesh.attributes[name], now)


class Attached:
    """What names vertices of a mesh by their numbers: hooks, and children of vertices."""

    def __init__(self, mesh):
        users = [object for object in bpy.data.objects if object.data == mesh]
        hooks = [each for user in users for each in user.modifiers if each.type == "HOOK" and user.library is None]
        self._hooks = [(hook, list(hook.vertex_indices)) for hook in hooks]
        self._children = [
            (child, list(child.parent_vertices))
            for child in bpy.data.objects
            if child.parent in users and child.parent_type in ("VERTEX", "VERTEX_3") and child.library is None
        ]

    @property
    def names(self):
        return [each.name for each, _ in self._hooks + self._children]

    def renumber(self, source, old, places):
        """Gives them the new numbers of the vertices with the sources that `half_copy` writes; of those that are not
        there any more, the ones nearest to their `old` places."""
        if not self._hooks and not self._children:
            return
        number, there = np.full(len(old), -1), np.flatnonzero((source >= 0) & (source < len(old)))
        number[source[there]] = there
        tree = KDTree(len(places))
        for vertex, place in enumerate(places.tolist()):
            tree.insert(place, vertex)
        tree.balance()

        def renumbered(vertices):
            return [tree.find(old[each])[1] if number[each] < 0 else int(number[each]) for each in vertices]

        for hook, vertices in self._hooks:
            if vertices:
                hook.vertex_indices_set(sorted(set(renumbered(vertices))))
        for child, vertices in self._children:
            child.parent_vertices = renumbered(vertices)


def _beside(moved, points, made):
    """(vertices, 3) how much farther than the surface below them a shape key moves what an edit has `made`, (vertices,) bool,
    as an extrusion on this key, or one that Blender leaves out of it."""
    if not (made.any() and moved.any()):
        return np.zeros_like(moved)
    below = points.positions(points.positions(moved))
    return np.where(made[:, None] & np.isfinite(below), moved - below, 0)


def is_of_faces(attribute):
    """Whether an attribute of faces or edges goes from one half to the other."""
    hidden = attribute.name.startswith(".") and attribute.name != ".sculpt_face_set"
    return attribute.domain in ("EDGE", "FACE") and attribute.data_type in mesh_data.LAYOUTS and not hidden


def _is_own(attribute, domain):
    """Whether an attribute is interpolated where the half was."""
    hidden = attribute.name.startswith(".") and attribute.name != ".sculpt_mask"
    other = hidden or attribute.name == "position" or stored_map.is_own(attribute.name)
    return attribute.domain == domain and attribute.data_type in mesh_data.LAYOUTS and not other
