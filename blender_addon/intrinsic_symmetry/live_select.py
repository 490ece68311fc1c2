# SPDX-License-Identifier: GPL-3.0-or-later
"""Live selection: in edit mode, what is selected on one side lights up on the other."""

import bmesh
import bpy
import numpy as np


def follow(session, object, undone):
    """`session.lit` says which vertices are selected by us alone."""
    mesh, channel = object.data, session.channel
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
    """Partners of what the user took out of the selection, if he did that on one side of a selection of both."""
    removed = before & ~selected
    partners = symmetry.mirror_selection(removed)
    if not removed.any() or (partners & ~selected).any() or not (selected & ~partners).any():
        return np.zeros_like(selected)
    return partners


def _write(mesh, channel, symmetry, selected, wanted):
    vertex_mode, edge_mode, _ = bpy.context.tool_settings.mesh_select_mode
    bm = channel.bm
    if not vertex_mode and not edge_mode:
        faces = np.fromiter((face.select for face in bm.faces), bool, len(bm.faces))
        mirrored = symmetry.mirror_face_selection(faces) & ~faces
        bm.faces.ensure_lookup_table()
        for face in np.flatnonzero(mirrored).tolist():
            if not bm.faces[face].hide:
                bm.faces[face].select_set(True)
    else:
        for vertex in np.flatnonzero(wanted & ~selected).tolist():
            channel.vertices[vertex].select_set(True)
        for vertex in np.flatnonzero(selected & ~wanted).tolist():
            channel.vertices[vertex].select_set(False)
        bm.select_flush(True)
    bmesh.update_edit_mesh(mesh, loop_triangles=False, destructive=False)
