# SPDX-License-Identifier: GPL-3.0-or-later
"""Intrinsic Symmetry: the mirror image of every vertex, in any pose and with any connectivity.

The mathematics is in the package `intrinsym`, the wheel beside this add-on. Here is what Blender needs of it:

    preferences     defaults, from the library's own table of options
    mesh_data       meshes and attributes as numpy arrays, in any mode
    stored_map      the map that is kept on a mesh, and when it is refused
    undo            puts the map's record back after undo in edit mode
    entered         the shape with which edit mode was entered
    detection       one detection in a worker thread
    labels          what the network and the user say of each eigenfunction
    eigenfunctions  those that are shown in this session
    label_file      judgements as training data
    pairs_file      pairs of vertices as files; pairs_check says whether they can be a mesh's
    overlay         what is drawn over the viewport; overlay_data says what
    elements        mirror images of edges and faces
    side_names      left and right in names
    left_side       which side is called left
    counterparts    which group or key takes its values from which
    weights         vertex weights as an array
    made_key        settings of a shape key that is made
    assembly        several objects with one map
    seams           where such objects touch, and where vertices are split
    mirroring       which way values go, and how far
    carry           the map of an edited mesh, by carried_map, carried_walk and image_surface
    half_*          one half of a mesh rebuilt: half_line says where it ends, half_copy copies faces, half_map pairs
                    vertices, half_form places them, half_data gives them what was there
    surface         nearest points of a surface, and values there
    vertex_map      maps that are known vertex by vertex
    line_distance   distance from the line between left and right
    asymmetry       where the mirror image of each vertex should be
    neighbour_means values between known ones
    regions         what is connected
    local_frames    how directions are turned and stretched there
    posed_shape     the other side's lengths in the own pose; multilevel solves the equation for it
    live            what changes on one side happens on the other; live_carry says what, live_edit, live_paint,
                    live_texture and live_select read and write it
    ops_*           operators, one file for each thing that a user does
    panels          the sidebar tab Symmetry
    menus           the tools in Blender's own menus, and a pie menu
"""

from . import (
    entered,
    labels,
    live,
    menus,
    ops_attributes,
    ops_carry,
    ops_check,
    ops_detect,
    ops_detect_selected,
    ops_label,
    ops_live,
    ops_nodes,
    ops_pairs_file,
    ops_positions,
    ops_select,
    ops_shape_keys,
    ops_split_key,
    ops_symmetrize_exact,
    ops_symmetrize_topology,
    ops_transfer,
    ops_uv,
    ops_uv_mirror,
    ops_vertex_groups,
    overlay,
    panels,
    preferences,
    undo,
)

_MODULES = (
    preferences,
    labels,
    undo,
    entered,
    live,
    overlay,
    ops_detect,
    ops_carry,
    ops_detect_selected,
    ops_label,
    ops_nodes,
    ops_select,
    ops_check,
    ops_uv,
    ops_uv_mirror,
    ops_vertex_groups,
    ops_shape_keys,
    ops_attributes,
    ops_positions,
    ops_symmetrize_exact,
    ops_symmetrize_topology,
    ops_split_key,
    ops_pairs_file,
    ops_transfer,
    ops_live,
    panels,
    menus,
)


def register():
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
