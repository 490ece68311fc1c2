# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh of 107,000 vertices: memory, and that every step is done in bulk."""

import resource
import time

import bmesh
import bpy
import numpy as np
from conftest import attribute, module, new_object, read_example

ops = bpy.ops.intrinsic_symmetry


def _large_human():
    mesh = read_example("human")
    data = bmesh.new()
    data.from_mesh(mesh)
    bmesh.ops.subdivide_edges(data, edges=data.edges, cuts=1, use_grid_fill=True)
    bmesh.ops.poke(data, faces=data.faces)
    data.to_mesh(mesh)
    data.free()
    return new_object(mesh, "large")


def _megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def test_a_large_mesh():
    object = _large_human()
    count = len(object.data.vertices)
    assert count > 100_000
    before = _megabytes()
    assert ops.detect() == {"FINISHED"}
    partner = attribute(object.data, "sym_vertex")
    assert np.array_equal(partner[partner], np.arange(count))  # the connectivity is mirrored
    object.vertex_groups.new(name="Arm.L").add(np.flatnonzero(_side(object) == 1).tolist(), 1, "ADD")
    start = time.perf_counter()
    assert ops.select_line() == {"FINISHED"}
    assert ops.select() == {"FINISHED"}
    assert ops.mirror_vertex_groups() == {"FINISHED"}
    assert time.perf_counter() - start < 20
    assert np.array_equal(np.flatnonzero(_weights(object, "Arm.R")), np.flatnonzero(_side(object) == -1))
    assert _megabytes() - before < 1500


def _weights(object, name):
    return module("weights").read_weights(object)[:, object.vertex_groups[name].index]


def _side(object):
    return attribute(object.data, "sym_side")
