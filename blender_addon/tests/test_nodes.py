# SPDX-License-Identifier: GPL-3.0-or-later
"""The Geometry Nodes group."""

import bpy
import numpy as np
import pytest
from conftest import module

ops = bpy.ops.intrinsic_symmetry


def _store_with_group(object, data_type, source):
    """A modifier that stores, as "mirrored", what the group gives for the attribute `source`."""
    name, _ = module("ops_nodes").TYPES[data_type]
    tree = bpy.data.node_groups.new("test", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    new, link = tree.nodes.new, tree.links.new
    inside, outside = new("NodeGroupInput"), new("NodeGroupOutput")
    group = new("GeometryNodeGroup")
    group.node_tree = bpy.data.node_groups[name]
    store = new("GeometryNodeStoreNamedAttribute")
    store.data_type, store.domain = data_type, "POINT"
    store.inputs["Name"].default_value = "mirrored"
    link(inside.outputs[0], store.inputs["Geometry"])
    link(module("ops_nodes")._named(tree, source, data_type), group.inputs["Value"])
    link(group.outputs["Value"], next(s for s in store.inputs if s.name == "Value" and s.enabled))
    link(store.outputs[0], outside.inputs[0])
    object.modifiers.new("nodes", "NODES").node_group = tree


@pytest.mark.parametrize("data_type, columns", [("FLOAT", 1), ("FLOAT_VECTOR", 3), ("FLOAT_COLOR", 4)])
def test_the_group_gives_the_value_at_the_mirror_image(quadruped, data_type, columns):
    mesh_data, mesh = module("mesh_data"), quadruped.data
    values = np.random.default_rng(0).random((len(mesh.vertices), columns))
    mesh_data.write_attribute(mesh, "mine", data_type, values)
    assert ops.add_node_group(data_type=data_type) == {"FINISHED"}
    _store_with_group(quadruped, data_type, "mine")
    evaluated = quadruped.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    found = mesh_data.read_attribute(evaluated.attributes["mirrored"]).reshape(len(values), -1)[:, :3]
    wanted = module("stored_map").load(mesh).mirror_values(values)[:, :3]
    assert np.abs(found - wanted).max() < 1e-5
    with pytest.raises(RuntimeError, match="there already"):
        ops.add_node_group(data_type=data_type)
    for group in list(bpy.data.node_groups):
        bpy.data.node_groups.remove(group)
