# SPDX-License-Identifier: GPL-3.0-or-later
"""A character of several objects, with one map over all of them.

The tools work on one mesh. So the objects are joined into a temporary one, the tool works on that, and what it changed
is given back to each object: attributes (the map and the selection among them), weights, shape keys, positions. Each
object keeps its own share of the map, in the numbers of the joined mesh; its record names all the objects.
"""

from contextlib import contextmanager

import bpy
import numpy as np

from . import made_key, mesh_data, stored_map
from .stored_map import RECORD
from .weights import SMALLEST, read_weights, write_weights

#: INT attribute of each domain of the joined mesh, hidden as Blender's own are: number of the element, counted through all
#: objects.
_NUMBER = ".sym_number"
_DOMAINS = {"POINT": "vertices", "EDGE": "edges", "FACE": "polygons", "CORNER": "loops"}
#: Displacement below which a key does not move a vertex, as a share of the size.
_STILL = 1e-6
#: Not given back: positions are by themselves, and the joined mesh has other materials.
_NOT_GIVEN = {"position", ".edge_verts", ".corner_vert", ".corner_edge", "material_index"}


def members_of(object):
    """The objects that share the object's map: itself alone, if it has a map of its own or none. Raises MeshProblem
    where one is missing."""
    record = object.data.get(RECORD)
    if record is None or "members" not in record:
        return [object]
    names = list(record["members"].values())
    members = [_member(record, number, name) for number, name in enumerate(names)]
    if None in members:
        name = names[members.index(None)]
        raise mesh_data.MeshProblem(f'The symmetry spans several objects, and "{name}" is missing: Detect again')
    if object not in members:
        raise mesh_data.MeshProblem("The symmetry is that of the objects this one was copied from: Detect again")
    return members


def _member(record, number, name):
    """The object of a name that has this share of a map; or, if it was renamed, the only one that has; or nothing."""
    whole = record["whole"]

    def shares(object):
        own = object.data.get(RECORD, {}) if object.type == "MESH" else {}
        fits = "members" in own and own.get("member", number) == number
        return fits and all(own["whole"][name] == whole[name] for name in ("connectivity", "checksum"))

    objects = bpy.context.view_layer.objects
    if name in objects and shares(objects[name]):
        return objects[name]
    found = [object for object in objects if shares(object)]
    return found[0] if len(found) == 1 else None


def there(object):
    """Those of the objects that share its map that can be found."""
    try:
        return members_of(object)
    except mesh_data.MeshProblem:
        return [object]


def selected(context):
    """The selected meshes, the active one first. Raises MeshProblem."""
    others = [other for other in context.selected_objects if other.type == "MESH" and other != context.active_object]
    members = [context.active_object, *others]
    if len({member.data for member in members}) < len(members):
        raise mesh_data.MeshProblem("Some of the selected objects share a mesh: make it single-user first")
    mesh_data.refuse_fixed(members)
    return members


@contextmanager
def whole(members, edited=None, held=None):
    """One object for a tool to work on, in object mode: the object itself, or the joined ones. What was changed is
    given back at the end, if nothing was raised. Of those not in `edited`, if that is given, nothing is selected.
    Hidden ones are given the map alone; `held`, a list, gets the names of those that would have changed. Raises
    MeshProblem if the mesh of one cannot be written."""
    mesh_data.refuse_fixed(members)
    with joined(members, edited) as body:
        if len(members) == 1:
            yield body
            return
        before = _State(body)
        yield body
        after = _State(body)
        for number, member in enumerate(members):
            place = _Place(body, members, number)
            if member.visible_get():
                _give_back(member, place, before, after)
            else:
                _give_map(member.data, place, before, after)
                if held is not None and _would_change(place.rows(), before, after):
                    held.append(member.name)
        _keep_records(members, body)


@contextmanager
def joined(members, edited=None):
    """The object itself, or a temporary one of all."""
    if len(members) == 1:
        yield members[0]
        return
    copies = [_numbered_copy(members, number, edited) for number in range(len(members))]
    meshes, body = [copy.data for copy in copies], copies[0]
    try:
        chosen = {"selected_objects": copies, "selected_editable_objects": copies}
        with bpy.context.temp_override(active_object=body, object=body, **chosen):
            bpy.ops.object.join()
        record = members[0].data.get(RECORD)
        if record is not None:
            body.data[RECORD] = (record["whole"] if "whole" in record else record).to_dict()
        _choose_as(body, bpy.context.active_object)
        _lock_as(body, members)
        yield body
    finally:
        for object in [object for object in bpy.data.objects if object.data in meshes]:
            bpy.data.objects.remove(object)
        for mesh in meshes:
            bpy.data.meshes.remove(mesh)


def _numbered_copy(members, number, edited):
    copy = members[number].copy()
    copy.data = mesh = members[number].data.copy()
    bpy.context.scene.collection.objects.link(copy)
    for domain, elements in _DOMAINS.items():
        numbers = _offset(members, number, elements) + np.arange(len(getattr(mesh, elements)))
        mesh_data.write_attribute(mesh, f"{_NUMBER}_{domain.lower()}", "INT", numbers, domain)
    records = [member.data.get(RECORD, {}) for member in members[: number + 1]]
    if all("members" in record for record in records):
        stored_map.number_as_whole(mesh, sum(record["vertices"] for record in records[:-1]))
    if (members[0].matrix_world.inverted() @ copy.matrix_world).determinant() < 0:
        mesh.flip_normals()  # a mirrored object would be inside out in the joined one
    if edited is not None and members[number] not in edited:
        for name in [name for name in mesh.attributes.keys() if name.startswith(".select_")]:
            mesh_data.remove_attribute(mesh, name)
    return copy


def _offset(members, number, elements):
    return sum(len(getattr(member.data, elements)) for member in members[:number])


def _choose_as(body, active):
    """Makes active on the joined object what is so on the active one."""
    key, group, attribute = mesh_data.key_name(active), active.vertex_groups.active, active.data.attributes.active
    if body.data.shape_keys is not None:
        body.active_shape_key_index = max(body.data.shape_keys.key_blocks.find(key), 0)  # the basis
    if group is not None and group.name in body.vertex_groups:  # those of a mesh without vertices are not joined
        body.vertex_groups.active_index = body.vertex_groups[group.name].index
    if attribute is not None and attribute.name in body.data.attributes:
        body.data.attributes.active = body.data.attributes[attribute.name]


def _lock_as(body, members):
    """Locks on the joined object the groups and shape keys that are locked on one of the members."""
    groups, keys = body.vertex_groups, body.data.shape_keys
    for member in members:
        for group in member.vertex_groups:
            if group.lock_weight and group.name in groups:
                groups[group.name].lock_weight = True
        own = member.data.shape_keys
        for key in own.key_blocks if own and keys else []:
            if key.lock_shape and key.name in keys.key_blocks:
                keys.key_blocks[key.name].lock_shape = True


def of_members(body, members, shapes):
    """(vertices, 3) the shown positions of the joined object, with other shapes, by number, for some of the members."""
    points = mesh_data.shown_positions(body).astype(float)
    for number, shape in shapes.items():
        place = _Place(body, members, number)
        points[place.rows()] = place.brought(shape)
    return points


def owners(body, members):
    """(vertices,) number of the member that each vertex of the joined object is of."""
    number = np.empty(len(body.data.vertices), int)
    for index in range(len(members)):
        number[_Place(body, members, index).rows()] = index
    return number


def shown(body, members, domain="POINT"):
    """(elements,) bool: those of the joined object that are of objects that are not hidden."""
    flags = np.ones(len(getattr(body.data, _DOMAINS[domain])), bool)
    if len(members) > 1:
        for number in [number for number, member in enumerate(members) if not member.visible_get()]:
            flags[_Place(body, members, number).rows(domain)] = False
    return flags


class _Place:
    """Where one of the objects is in the joined one."""

    def __init__(self, body, members, number):
        self.body, self.members, self._number = body, members, number
        self._turn = np.array((members[number].matrix_world.inverted() @ body.matrix_world).to_3x3())
        self._origin = np.array((body.matrix_world.inverted() @ members[number].matrix_world).translation)

    def rows(self, domain="POINT"):
        """Its elements, in its own order, in the joined mesh."""
        elements = _DOMAINS[domain]
        order = np.argsort(mesh_data.read_attribute(self.body.data.attributes[f"{_NUMBER}_{domain.lower()}"]))
        first = _offset(self.members, self._number, elements)
        return order[first : first + len(getattr(self.members[self._number].data, elements))]

    def turned(self, vectors):
        """(own vertices, 3) vectors of the joined mesh in the object's own space."""
        return vectors[self.rows()] @ self._turn.T

    def images_of(self, values):
        """(own vertices,) of the joined mesh's values, those at the mirror images."""
        partner = mesh_data.read_attribute(self.body.data.attributes[stored_map.PARTNER])[self.rows()]
        return np.where(partner < 0, 0, values[partner])

    def brought(self, points):
        """(own vertices, 3) points of the object in the space of the joined mesh."""
        return points @ np.linalg.inv(self._turn).T + self._origin


class _State:
    """What a tool may change, by name."""

    def __init__(self, object):
        self.attributes = {
            attribute.name: (attribute.data_type, attribute.domain, mesh_data.read_attribute(attribute))
            for attribute in object.data.attributes
            if attribute.data_type in mesh_data.LAYOUTS and attribute.name not in _NOT_GIVEN
        }
        self.positions = mesh_data.positions(object.data)
        columns = read_weights(object).T
        self.weights = {group.name: columns[group.index] for group in object.vertex_groups}
        keys = object.data.shape_keys
        self.keys = {key.name: mesh_data.key_positions(key) for key in keys.key_blocks} if keys else {}


def _give_back(member, place, before, after):
    mesh = member.data
    _give_attributes(mesh, place, before.attributes, after.attributes)
    _give_weights(member, place.rows(), before.weights, after.weights)
    moved = place.turned(after.positions - before.positions)
    if moved.any():
        points = mesh_data.positions(mesh) + moved
        mesh.vertices.foreach_set("co", np.ascontiguousarray(points, np.float32).ravel())
    for name in after.keys:
        _give_key(member, place, name, before, after)
    mesh.update()


def _would_change(rows, before, after):
    """Whether positions, weights or keys of some vertices of the joined mesh are other ones."""
    def differs(one, two):
        return one is not two and np.abs(one[rows] - two[rows]).max(initial=0) > SMALLEST

    nothing = np.zeros(len(before.positions))
    return (
        differs(before.positions, after.positions)
        or any(differs(before.weights.get(name, nothing), column) for name, column in after.weights.items())
        or any(differs(before.keys.get(name, after.positions), points) for name, points in after.keys.items())
    )


def _give_map(mesh, place, before, after):
    """What is not work of the user is given to hidden objects, too."""
    _give_attributes(mesh, place, *(_of_map(state.attributes) for state in (before, after)))


def _of_map(attributes):
    return {name: attribute for name, attribute in attributes.items() if stored_map.is_own(name)}


def _give_attributes(mesh, place, before, after):
    for name in before.keys() - after.keys():
        if name in mesh.attributes:
            mesh_data.remove_attribute(mesh, name)
    for name, (kind, domain, values) in after.items():
        missing = name in stored_map.KINDS and name not in mesh.attributes
        if missing or name not in before or not np.array_equal(before[name][2], values):
            own = values[place.rows(domain)]
            if name in mesh.attributes or stored_map.is_own(name) or own.any():
                mesh_data.write_attribute(mesh, name, kind, own, domain)


def _give_weights(member, rows, before, after):
    moved = {name: (column - before.get(name, 0))[rows] for name, column in after.items()}
    moved = {name: change for name, change in moved.items() if (np.abs(change) > SMALLEST).any()}
    for name in moved:
        if name not in member.vertex_groups:
            member.vertex_groups.new(name=name)
    old = read_weights(member)
    new = old.copy()
    for name, change in moved.items():
        new[:, member.vertex_groups[name].index] += change
    write_weights(member, old, new)


def _give_key(member, place, name, before, after):
    """Moves a key by as much as it was moved, or makes it, if it moves anything of the object; one that was
    there, only where it moves the mirror image of something of the object."""
    keys, points = member.data.shape_keys, after.keys[name]
    if keys is not None and name in keys.key_blocks:
        key, moved = keys.key_blocks[name], place.turned(points - before.keys[name])
        if moved.any():
            mesh_data.set_key_positions(key, mesh_data.key_positions(key) + moved)
        return
    model = place.body.data.shape_keys.key_blocks[name]
    if name in before.keys:
        changed = not np.array_equal(points, before.keys[name])  # by a tool that has read the map
        if not (changed and place.images_of(_moved_by(before, model)).any()):
            return
    moved = place.turned(points - after.keys[model.relative_key.name])
    if np.abs(moved).max(initial=0) > _STILL * np.abs(after.positions).max():
        if keys is None:
            member.shape_key_add(name=place.body.data.shape_keys.reference_key.name, from_mix=False)
        made_key.like_another(member, model, moved, place.members)


def _moved_by(state, key):
    """(vertices,) bool: what a key of the joined mesh moves."""
    moved = np.abs(state.keys[key.name] - state.keys[key.relative_key.name]).max(axis=1)
    return moved > _STILL * np.abs(state.positions).max()


def _keep_records(members, body):
    """Gives each object its record; where the tool removed the map, it is removed."""
    for member in members:
        if RECORD in body.data:
            names = [each.name for each in members]
            stored_map.store_share(member.data, body.data[RECORD].to_dict(), names, members.index(member))
        else:
            stored_map.clear(member.data)
