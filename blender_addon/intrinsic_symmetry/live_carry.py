# SPDX-License-Identifier: GPL-3.0-or-later
"""What live mirroring does to arrays: which vertices follow which, and where they go.

Values are (vertices, components): positions, weights, colours; of a colour attribute of face corners, (corners,
components). Of positions the change is carried, and turned and stretched on its way, by one matrix a vertex; those are
three displacements of `intrinsym.Symmetry.carry_displacement`, one along each axis. Of all else the value is. No bpy here.
"""

import numpy as np
from intrinsym import SymmetryKind

from . import local_frames, vertex_map
from .places import Places, gathered, means


def differing(one, other):
    """(rows,) bool: which rows of two arrays are not equal."""
    different = one != other
    return np.logical_or.reduce([different[:, column] for column in range(different.shape[1])])


class Carrier:
    """The map of a mesh, ready to carry what happens to some vertices."""

    def __init__(self, symmetry):
        points, self.symmetry = symmetry.surface_points, symmetry
        self._set(symmetry.side, symmetry.partner >= 0, points.corners, points.barycentrics)
        itself = symmetry.partner == np.arange(len(self.side))
        self.follows |= self.on_line & vertex_map.pairs(symmetry) & self.on_line[symmetry.partner] & ~itself

    def _set(self, side, has_image, corners, weights):
        self.side, self.has_image = side, has_image
        self.corners = np.where(has_image[:, None], corners, 0).astype(np.intp)
        self.weights = np.where(has_image[:, None], weights, 0).astype(float)
        self.on_line = has_image & (side == 0)
        if self.symmetry.kind == SymmetryKind.HALF_TURN:
            self.on_line[:] = False
        self.follows = ~self.on_line  # and on the line those with a partner, as of halves that are not welded
        self.turn = self.fitted_to = self.of_corners = None

    def fit(self, positions):
        """Fits the matrices to a pose, (vertices, 3) float32; nothing is done if they fit it already."""
        if self.fitted_to is not None and np.array_equal(self.fitted_to, positions):
            return
        self.turn, self.fitted_to = local_frames.turns(self.symmetry, positions), positions.copy()
        self.places = Places(positions)
        self._fit_line()

    def is_fitted(self):
        return self.turn is not None

    def _fit_line(self):
        """Normals of the plane that a vertex on the line stays in: the direction that its matrix reverses best, the mean of those
        at one place. There the change of a partner is mirrored in that plane, so that both stay together."""
        rows, partner = np.flatnonzero(self.on_line), self.symmetry.partner
        of = np.unique(self.places.of[rows], return_inverse=True)[1].ravel()
        turn = means(of, self.turn[rows].reshape(-1, 9)).reshape(-1, 3, 3)
        self.normals = np.zeros((len(self.side), 3))
        self.normals[rows] = np.linalg.eigh(turn + turn.transpose(0, 2, 1))[1][of, :, 0]
        joined = rows[self.follows[rows] & (self.places.of[partner[rows]] == self.places.of[rows])]
        normals = self.normals[joined]
        self.turn[joined] = np.eye(3) - 2 * normals[:, :, None] * normals[:, None]

    def clamped(self, vertices, change):
        """The part of a change, (given vertices, 3), that stays on the line; vertices elsewhere keep all of it."""
        normals = self.normals[vertices]
        return change - normals * (normals * change).sum(axis=1, keepdims=True)

    def followers(self, moved):
        """(vertices,) bool: those whose image is touched by the moved ones, (vertices,) bool."""
        touched = moved[self.corners]
        touched &= self.weights > 0
        return touched.any(axis=1) & self.follows

    def route(self, vertices):
        return Route(self, vertices)


class CornerCarrier(Carrier):
    """That of face corners, whose images are points between three corners of a face. Where the map has a vertex on the
    line, the face says of which side its corner is."""

    def __init__(self, carrier, offsets, vertex, images):
        """`images`, (corners, 3), are the corners; each counts as its vertex does in the image of the corner's."""
        self.symmetry, side = carrier.symmetry, carrier.side[vertex]
        of_faces = np.repeat(np.sign(np.add.reduceat(side.astype(int), offsets[:-1])), np.diff(offsets))
        has_image = carrier.has_image[vertex] & (images >= 0).all(axis=1)
        self._set(np.where(side == 0, of_faces, side), has_image, images, carrier.weights[vertex])


class Route:
    """The way of a change to some vertices from their images.

    The sums are in the library's order, so that the result is the same to the last bit.
    """

    def __init__(self, carrier, vertices):
        weights = carrier.weights[vertices]
        self._corners = [np.ascontiguousarray(corner) for corner in carrier.corners[vertices].T]
        self._weights = [np.ascontiguousarray(weight)[:, None] for weight in weights.T]
        self._total = (weights[:, 0] + weights[:, 1] + weights[:, 2])[:, None]
        self._carrier, self._vertices, self._axes, self._pairs = carrier, vertices, None, None

    def carry(self, change):
        """(given vertices, components) the change at the images; `change` is of all vertices, float64."""
        there = 0
        for corner, weight in zip(self._corners, self._weights):
            there += weight * change.take(corner, axis=0)
        there /= self._total
        return there

    def turned(self, there):
        """(given vertices, 3) directions at the images, as they are at the vertices."""
        if self._axes is None:
            turn = self._carrier.turn[self._vertices]
            self._axes = [np.ascontiguousarray(turn[:, :, axis]) for axis in range(3)]
        return sum(axis * there[:, number, None] for number, axis in enumerate(self._axes))

    def together(self, carried, change):
        """(given vertices, 3) what arrives, but vertices at one place go to one place if their mirror images did, as
        in `mirroring.carried_together`."""
        places = self._carrier.places
        if self._pairs is None:
            row = np.full(len(change), -1)
            row[self._vertices] = np.arange(len(self._vertices))
            pairs = row[places.pairs]
            self._pairs = pairs[(pairs >= 0).all(axis=1)]
            self._images = self._carrier.symmetry.partner[self._vertices[self._pairs]]
        return gathered(carried, self._pairs[places.alike(change, self._images)])


class Change:
    """What one operation has done to one array so far: `base` before it, `current` now, `written` by us.

    Every update starts from `base` again, so that an operation that is cancelled leaves nothing behind. The channel
    that the values are of says what arrives on the other side (`carried`) and what stays on the line (`on_line`).
    """

    def __init__(self, carrier, values, channel):
        self.carrier, self._channel = carrier, channel
        self.base, self.current = values.copy(), values.copy()
        self.moved = np.zeros(len(values), bool)  # changed, and not by us
        self.written = np.zeros(len(values), bool)
        self.touched = np.zeros(len(values), bool)  # written at some time of this operation
        self._plan = None

    def take(self, vertices, values):
        """Keeps what somebody else has done to vertices."""
        self.current[vertices] = values
        self.moved[vertices] = differing(values, self.base[vertices])
        self.written[vertices] = False

    def follow(self, selected, fixed, share=None):
        """Brings the other side after what was moved. Returns the vertices to write, their values in `current`: the
        same array as long as the same vertices move.

        selected  (vertices,) bool: moved by the user's own will; never overwritten
        fixed     (vertices,) bool: never written at all
        share     (vertices,) float, how much of a change arrives; or nothing for all of it
        """
        side = self._winning_side(selected)
        if self._plan is None or not self._plan.is_for(self.moved, side):
            self._plan = Plan(self, side, fixed)
        plan = self._plan
        before = self.current[plan.candidates]
        self._change_line(plan.line)
        self._write(plan, share)
        changed = differing(self.current[plan.candidates], before)
        self.touched[plan.candidates[changed]] = True
        return plan.candidates if changed.any() else plan.candidates[:0]

    def _write(self, plan, share):
        targets = plan.targets
        carried = self._channel.carried(plan, self.base, self.current)
        if share is not None:
            carried *= share[targets, None]
        self.current[plan.left] = self.base[plan.left]
        self.current[targets] = self.base[targets] + carried
        self.written[plan.left], self.written[targets], self.moved[targets] = False, True, False

    def _change_line(self, vertices):
        self.current[vertices] = self._channel.on_line(self.carrier, vertices, self.base, self.current)

    def _winning_side(self, selected):
        """The side whose change is carried, or 0 for both: the one with selected vertices; without a selection, as in
        sculpt mode, the one with more change. Nothing if vertices of both are selected: the line is the user's own then."""
        side, moved = self.carrier.side, self.moved
        chosen = moved & selected
        if chosen.any():
            left, right = (chosen & (side == 1)).any(), (chosen & (side == -1)).any()
            return None if left and right else int(left) - int(right)
        size = np.zeros(len(moved))
        size[moved] = np.linalg.norm(self.current[moved].astype(float) - self.base[moved], axis=1)
        return int(np.sign(size[side == 1].sum() - size[side == -1].sum()))

    def settle(self):
        """Ends the operation. Returns the step for the history, or nothing if all is as before."""
        changed = np.flatnonzero(self.moved | self.touched)
        step = None
        if (self.current[changed] != self.base[changed]).any():
            step = Step(changed, self.base[changed], self.current[changed], self.touched[changed])
        self.base[changed] = self.current[changed]
        self.moved[:] = self.written[:] = self.touched[:] = False
        self._plan = None
        return step


class Plan:
    """What follows from one set of moved vertices, whatever their values: kept from update to update.

    line        moved, and only along the line
    sources     moved, and followed by others
    targets     follow
    left        have followed, and do not any more
    candidates  may be written: line, targets and left
    """

    def __init__(self, change, side, fixed):
        carrier, moved, written = change.carrier, change.moved, change.written
        losing = carrier.side == -side if side else np.zeros(len(moved), bool)
        sources = moved & ~losing
        targets = carrier.followers(sources) & carrier.has_image
        if side:
            targets = targets & (losing | carrier.on_line) | moved & losing
        targets &= ~fixed & (losing | ~moved)
        self._moved, self._side = moved.copy(), side
        self.line = np.flatnonzero(moved & carrier.on_line & ~fixed) if side is not None else np.zeros(0, int)
        self.sources, self.targets = np.flatnonzero(sources), np.flatnonzero(targets)
        self.left = np.flatnonzero(written & ~targets)
        self.candidates = np.concatenate((self.line, self.targets, self.left))
        self.route, self.change = carrier.route(self.targets), np.zeros(change.base.shape)

    def is_for(self, moved, side):
        """Whether these vertices are moved, and nothing else has to be put back."""
        return not len(self.left) and side == self._side and np.array_equal(moved, self._moved)


class Step:
    """One operation: what it changed, and which of that was written by us."""

    def __init__(self, vertices, before, after, ours):
        self.vertices, self.before, self.after, self.ours = vertices, before, after, ours


class History:
    """The operations of this session. Blender keeps its undo step before ours is written; so what an undo or redo
    brings back may lack our part, and is completed from here."""

    def __init__(self, most):
        self.steps, self.done, self._most = [], 0, most

    def add(self, step):
        del self.steps[self.done:]
        self.steps.append(step)
        del self.steps[: -self._most]
        self.done = len(self.steps)

    def find(self, state, found):
        """The state, (vertices, components), that `found` is or lacks our part of; nothing if there is none. `state` is
        the one that was last there."""
        numbers = [*range(self.done, -1, -1), *range(self.done + 1, len(self.steps) + 1)]
        state, at = state.copy(), self.done
        for number in numbers:
            at = self._go(state, at, number)
            differs = (state != found).any(axis=1)
            if number:
                step = self.steps[number - 1]
                differs[step.vertices[step.ours]] = False
            if not differs.any():
                self.done = number
                return state
        return None

    def _go(self, state, at, number):
        for step in reversed(self.steps[number:at]):
            state[step.vertices] = step.before
        for step in self.steps[at:number]:
            state[step.vertices] = step.after
        return number
