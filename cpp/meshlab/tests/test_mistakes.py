# SPDX-License-Identifier: GPL-3.0-or-later
"""What is refused, in which words; and that nothing changes then."""

import numpy as np
import pymeshlab
import pytest
from conftest import COMPUTE, FILTERS, KEPT_ALIVE, MIRROR, PACKAGE, PLUGIN, SELECT_VERTICES, TOOLS, example, loose_triangles


def refused(ms: pymeshlab.MeshSet, name: str, **parameters: object) -> str:
    KEPT_ALIVE.append(ms)
    with pytest.raises(pymeshlab.PyMeshLabException) as caught:
        ms.apply_filter(name, **parameters)
    return str(caught.value)


def test_the_build_of_the_other_precision_is_refused():
    with pytest.raises(pymeshlab.PyMeshLabException, match="different floating point precision"):
        pymeshlab.load_plugin(str(PACKAGE / "meshlab" / PLUGIN))


def test_all_filters_are_there():
    names = pymeshlab.filter_list()
    assert all(name in names for name in FILTERS)


@pytest.mark.parametrize("name", FILTERS)
def test_a_point_cloud_and_no_layer_are_refused(name):
    points = pymeshlab.MeshSet()
    points.add_mesh(pymeshlab.Mesh(np.random.default_rng(1).normal(size=(20, 3))))
    assert refused(points, name)
    assert refused(pymeshlab.MeshSet(), name)


def test_a_mesh_without_area_and_one_with_a_number_that_is_none_are_refused():
    flat = pymeshlab.MeshSet()
    flat.add_mesh(pymeshlab.Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]])))
    assert "area" in refused(flat, COMPUTE)
    broken = pymeshlab.MeshSet()
    vertices = np.eye(3)
    vertices[1, 1] = np.nan
    broken.add_mesh(pymeshlab.Mesh(vertices, np.array([[0, 1, 2]])))
    assert "1" in refused(broken, COMPUTE)


def test_parameters_outside_their_range_are_refused_and_change_nothing():
    ms = example("quadruped")
    assert "counted from 1" in refused(ms, COMPUTE, symmetry=0)
    assert "samples: 7 is outside" in refused(ms, COMPUTE, samples=7)
    assert "Symmetry 2 was asked for, 1 found" in refused(ms, COMPUTE, symmetry=2)
    assert not ms.current_mesh().has_vertex_color()
    with pytest.raises(pymeshlab.PyMeshLabException):
        ms.current_mesh().vertex_custom_scalar_attribute_array("sym_vertex")


def test_mistakes_with_attributes(quadruped):
    custom = {"attribute": "Custom attribute"}
    assert "Write the name" in refused(quadruped, MIRROR, **custom)
    assert "no custom attribute nothing" in refused(quadruped, MIRROR, custom_name="nothing", **custom)
    bare = example("quadruped")
    assert "no quality" in refused(bare, MIRROR, attribute="Quality")
    assert "no colour" in refused(bare, MIRROR, attribute="Color")


@pytest.mark.parametrize("name, value", [("sym_vertex", 1000000000), ("sym_vertex", 0.5), ("sym_confidence", 2.0),
                                         ("sym_side", 7.0), ("sym_face", 1000000000)])
def test_a_spoilt_map_is_refused(quadruped, name, value):
    expression = f"(vi == 5) ? {value} : {name}"
    quadruped.compute_new_custom_scalar_attribute_per_vertex(name=name, expr=expression)
    values = quadruped.current_mesh().vertex_custom_scalar_attribute_array(name)
    assert values[5] == value and values[6] != value
    message = refused(quadruped, SELECT_VERTICES)
    assert name in message or "vertex 5 has" in message


def test_a_mesh_without_symmetry_is_refused_by_the_tools(tmp_path):
    ms = loose_triangles(tmp_path)
    assert "No symmetry was found" in refused(ms, TOOLS[0])
