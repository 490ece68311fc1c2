# SPDX-License-Identifier: GPL-3.0-or-later
"""A Geometry Nodes group that gives each vertex the value at its mirror image."""

import bpy

from . import mesh_data, stored_map
from .operator_base import MeshOperator

#: Data type of a field to the name of its group and the type of its sockets.
TYPES = {
    "FLOAT": ("Symmetric Float", "NodeSocketFloat"),
    "FLOAT_VECTOR": ("Symmetric Vector", "NodeSocketVector"),
    "FLOAT_COLOR": ("Symmetric Color", "NodeSocketColor"),
}


class INTRINSIC_SYMMETRY_OT_add_node_group(MeshOperator, bpy.types.Operator):
    """Make a Geometry Nodes group that samples a value at the mirror image of each vertex, and stays live"""

    bl_idname = "intrinsic_symmetry.add_node_group"
    bl_label = "Add Node Group"

    data_type: bpy.props.EnumProperty(
        name="Data Type",
        description="What the group samples",
        items=[
            ("FLOAT", "Float", "A number for each vertex"),
            ("FLOAT_VECTOR", "Vector", "A vector for each vertex"),
            ("FLOAT_COLOR", "Color", "A color for each vertex"),
        ],
        default="FLOAT_VECTOR",
    )

    def run(self, _context, _object, _mode):
        name, _ = TYPES[self.data_type]
        if name in bpy.data.node_groups:
            raise mesh_data.MeshProblem(f'The node group "{name}" is there already, under Add > Group')
        return f'The node group "{build(self.data_type).name}" is under Add > Group in geometry node trees'


def build(data_type):
    """The node group: Value in; Value at the mirror image, Confidence and Side out."""
    name, socket = TYPES[data_type]
    group = bpy.data.node_groups.new(name, "GeometryNodeTree")
    group.interface.new_socket("Value", in_out="INPUT", socket_type=socket)
    group.interface.new_socket("Value", in_out="OUTPUT", socket_type=socket)
    group.interface.new_socket("Confidence", in_out="OUTPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("Side", in_out="OUTPUT", socket_type="NodeSocketInt")
    inside, outside = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    bary = group.nodes.new("ShaderNodeSeparateXYZ")
    _link(group, _named(group, stored_map.BARY, "FLOAT_VECTOR"), bary.inputs[0])
    total = None
    for place, corner in enumerate(stored_map.CORNERS):
        at = _value_at(group, data_type, inside.outputs[0], _named(group, corner, "INT"))
        total = _weighted_sum(group, data_type, at, bary.outputs[place], total)
    _link(group, total, outside.inputs["Value"])
    _link(group, _named(group, stored_map.CONFIDENCE, "FLOAT"), outside.inputs["Confidence"])
    _link(group, _named(group, stored_map.SIDE, "INT"), outside.inputs["Side"])
    _arrange(group)
    return group


def _link(group, output, socket):
    group.links.new(output, socket)


def _on(sockets):
    """The sockets of the data type that a node is set to."""
    return [socket for socket in sockets if socket.enabled]


def _named(group, name, data_type):
    node = group.nodes.new("GeometryNodeInputNamedAttribute")
    node.data_type = data_type
    node.inputs["Name"].default_value = name
    return _on(node.outputs)[0]


def _value_at(group, data_type, value, index):
    node = group.nodes.new("GeometryNodeFieldAtIndex")
    node.data_type, node.domain = data_type, "POINT"
    _link(group, index, node.inputs["Index"])
    _link(group, value, next(socket for socket in _on(node.inputs) if socket.name == "Value"))
    return _on(node.outputs)[0]


def _weighted_sum(group, data_type, value, weight, total):
    """value * weight + total; colours as vectors."""
    node = group.nodes.new("ShaderNodeMath" if data_type == "FLOAT" else "ShaderNodeVectorMath")
    node.operation = "MULTIPLY_ADD"
    operands = node.inputs[:3]
    _link(group, value, operands[0])
    _link(group, weight, operands[1])
    if total is not None:
        _link(group, total, operands[2])
    else:
        operands[2].default_value = 0.0 if data_type == "FLOAT" else (0.0, 0.0, 0.0)
    return node.outputs[0]


def _arrange(group):
    """Columns from left to right, by the kind of node."""
    columns = ("NodeGroupInput", "GeometryNodeInputNamedAttribute", "GeometryNodeFieldAtIndex",
               "ShaderNodeSeparateXYZ", "ShaderNodeMath", "ShaderNodeVectorMath", "NodeGroupOutput")
    heights = dict.fromkeys(columns, 0)
    for node in group.nodes:
        node.location = (220 * columns.index(node.bl_idname), heights[node.bl_idname])
        heights[node.bl_idname] -= 180


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_add_node_group,))
