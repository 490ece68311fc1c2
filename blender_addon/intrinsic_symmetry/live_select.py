# SPDX-License-Identifier: GPL-3.0-or-later
"""Live selection: in edit mode, what is selected on one side lights up on the other."""

import bmesh
import bpy
import numpy as np


def follow(session, object, undone):
    """`session.lit` says which vertices are selected by us alone."""
    mesh, channel = object.data, session.edit
    selected = channel.flags_of("select")
    before = np.zeros_like(selected) if session.lit is None else session.lit_with
    if np.array_equal(selected, before):
        return
    symmetry = session.carrier.symmetry
    wanted = selected | symmetry.mirror_selection(selected)
    if not undone:
        wanted &= ~_taken_away(symmetry, before, selected)
    wanted &= ~channel.flags_of("hide")
    _write(mesh, channel, symmetry, selected, wanted)
    still_lit = np.zeros_like(selected) if session.lit is None else session.lit & selected
    now = channel.flags_of("select")
    fresh = not (selected & before & ~(still_lit)).any()
    session.lit = (now & ~selected) | (np.zeros_like(selected) if fresh else still_lit)
    session.lit_with = now


def _taken_away(symmetry, before, selected):
    """What the user took out of the selection, and its partners, if he did that on one side of a selection of both."""
    removed = before & ~selected
    partners = symmetry.mirror_selection(removed)
    if not removed.any() or (partners & ~selected).any() or not (selected & ~partners).any():
        return np.zeros_like(selected)
    return partners | removed


def _write(mesh, channel, symmetry, selected, wanted):
    """Selects and deselects as the select mode has it."""
    vertex_mode, edge_mode, _ = bpy.context.tool_settings.mesh_select_mode
    on, off = np.flatnonzero(wanted & ~selected), np.flatnonzero(selected & ~wanted)
    vertices = channel.vertices
    if vertex_mode:
        chosen = [(vertices[vertex], bool(wanted[vertex])) for vertex in (*on.tolist(), *off.tolist())]
    elif edge_mode:
        edges = {edge for vertex in (*on.tolist(), *off.tolist()) for edge in vertices[vertex].link_edges}
        chosen = [(edge, all(wanted[vertex.index] for vertex in edge.verts)) for edge in edges]
    else:
        chosen = _mirrored_faces(channel.bm, symmetry, wanted)
    for element, is_selected in chosen:
        if not element.hide:
            element.select_set(is_selected)
    channel.bm.select_flush_mode()
    bmesh.update_edit_mesh(mesh, loop_triangles=False, destructive=False)


def _mirrored_faces(bm, symmetry, wanted):
    selected = np.fromiter((face.select for face in bm.faces), bool, len(bm.faces))
    both = selected | symmetry.mirror_face_selection(selected)
    bm.faces.ensure_lookup_table()
    inside = (bm.faces[face] for face in np.flatnonzero(both).tolist())
    return [(face, all(wanted[vertex.index] for vertex in face.verts)) for face in inside]
