# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay: what it draws, and that it goes away. The drawing itself is looked at in docs/blender.md."""

import bpy
import numpy as np
from conftest import enter, module, select


def _shape(object):
    return module("overlay_data").shape_of(object, bpy.context.evaluated_depsgraph_get())


def test_pair_lines_end_at_the_partners(human, truth, mode):
    chosen = np.arange(0, 13000, 131)
    select(human, chosen)
    enter(mode)
    shape = _shape(human)
    assert module("overlay_data").fits(shape, human.data)
    ends, colours = module("overlay_data").pair_lines(shape)
    assert np.allclose(ends[0::2], shape.positions[chosen])
    assert np.allclose(ends[1::2], shape.positions[truth[chosen]], atol=1e-5)
    assert colours.shape == (2 * len(chosen), 4)


def test_few_pairs_of_a_large_selection(human):
    select(human, np.arange(13000))
    ends, _ = module("overlay_data").pair_lines(_shape(human))
    assert 50 < len(ends) // 2 <= module("overlay_data").MOST_PAIRS


def test_the_line_lies_on_the_surface(human, truth, mode):
    enter(mode)
    shape = _shape(human)
    lines = module("stored_map").fixed_lines(human.data)
    ends = module("overlay_data").line_segments(shape, lines)
    fixed = shape.positions[truth == np.arange(len(truth))]
    assert len(ends) >= 2 * (len(fixed) - 1)
    distance = np.linalg.norm(ends[:, None] - fixed[None], axis=2).min(axis=1)
    assert distance.max() < 2e-3 * np.ptp(shape.positions, axis=0).max()


def test_colours(human, mode):
    enter(mode)
    shape = _shape(human)
    colours = module("overlay_data").surface_colours(shape, human, "SIDE")
    side = shape.attributes["sym_side"]
    assert len(np.unique(colours, axis=0)) == 3 and (colours[side == 1] == colours[side == 1][0]).all()
    confidence = module("overlay_data").confidence_colours(np.array([0.0, 1.0]))
    assert confidence[0, 0] > confidence[0, 2] and confidence[1, 2] > confidence[1, 0]
    assert module("overlay_data").surface_colours(shape, human, "EIGENFUNCTION") is None


def test_nothing_is_shown_of_a_stale_map(human):
    enter("EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.quads_convert_to_tris()
    bpy.ops.mesh.subdivide()
    assert not module("overlay_data").fits(_shape(human), human.data)


def test_it_switches_off_cleanly(human):
    overlay, show = module("overlay"), bpy.context.window_manager.intrinsic_symmetry_show
    before = sorted(a.name for a in human.data.attributes)
    handlers = len(bpy.app.handlers.depsgraph_update_post)
    assert not overlay.is_on()
    show.line = True
    show.colours = "CONFIDENCE"
    assert overlay.is_on()
    show.line = False
    assert overlay.is_on()
    show.colours = "NONE"
    assert not overlay.is_on()
    assert len(bpy.app.handlers.depsgraph_update_post) == handlers
    assert sorted(a.name for a in human.data.attributes) == before and not human.data.materials


def test_modifiers_that_only_move_are_followed(human):
    rest = _shape(human).positions
    human.modifiers.new("cast", "CAST").factor = 0.5
    bpy.context.view_layer.update()
    assert np.abs(_shape(human).positions - rest).max() > 0.01
    human.modifiers.new("subdivide", "SUBSURF").levels = 1
    bpy.context.view_layer.update()
    assert np.array_equal(_shape(human).positions, rest)
