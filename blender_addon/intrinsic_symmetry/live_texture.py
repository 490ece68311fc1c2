# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirroring of texture paint: after a stroke, the texels of the other side whose image points it has changed
have what is there.

A texel of the other side is a place in a triangle of the UV map. Its image point is the same place among the image
points of that triangle's corners, brought to the nearest triangle that the stroke has touched, and what it has
painted is read there. Only triangles near the stroke and near its mirror image are looked at.
"""

import bpy
import numpy as np
from mathutils.bvhtree import BVHTree

from . import mesh_data
from .elements import barycentric
from .live_carry import differing
from .live_paint import PaintChannel

#: How far beyond a triangle's border texels belong to it, as those of no triangle do in Blender's own strokes.
_MARGIN = 2.0
#: A change of a larger share of the image is no stroke, and stays as it is.
_MOST_OF_IMAGE = 0.25
#: Share of a texel that counts: less than a byte holds.
_STILL = 1e-3


def canvas(object):
    """The image that is painted and the name of its UV map, or nothing."""
    paint, material = bpy.context.scene.tool_settings.image_paint, object.active_material
    active, image = object.data.uv_layers.active, paint.canvas if paint.mode == "IMAGE" else None
    if paint.mode == "MATERIAL" and material is not None and len(material.texture_paint_images):
        image = material.texture_paint_images[material.paint_active_slot]
        named = object.data.uv_layers.get(material.texture_paint_slots[material.paint_active_slot].uv_layer)
        active = named or active
    usable = image is not None and active is not None and image.source != "TILED"
    return (image, active.name) if usable and image.channels == 4 else None


def keys_of(object):
    """Names of the image and the UV map, and its size, as the key of a track; none in other modes."""
    found = canvas(object) if object.mode == "TEXTURE_PAINT" else None
    return [("TEXTURE", found[0].name, found[1], *found[0].size)] if found else []


class Stroke:
    """What one stroke changed: flat numbers of texels, their values, and which of them we wrote."""

    def __init__(self, texels, before, after, ours):
        self.texels, self.before, self.after, self.ours = texels, before, after, ours

    def looks(self, pixels):
        """Below zero, if what the user painted looks as before it; above, as after it."""
        own = ~self.ours
        now = pixels[self.texels[own]]
        return np.abs(now - self.before[own]).sum() - np.abs(now - self.after[own]).sum()


class TextureTrack(PaintChannel):
    """The active image. Takes the place of both a Track and its channel in a live session."""

    def __init__(self, object, carrier, key, kept, undone):
        super().__init__(object, key)
        self.channel, self._carrier = self, carrier
        goes_on = kept is not None and (undone or np.array_equal(kept[0], self.values))
        last, self.history, self.done = kept if goes_on else (self.values, [], 0)
        if goes_on and undone:
            self._complete(last)

    @property
    def kept(self):
        """What another track of the same image goes on with."""
        return self.values, self.history, self.done

    def is_alive(self):
        try:
            return keys_of(self._object) == [self.key]
        except ReferenceError:
            return False

    def _read(self):
        image = canvas(self._object)[0]
        pixels = np.empty(4 * image.size[0] * image.size[1], np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(-1, 4)

    def _write(self, pixels):
        image = canvas(self._object)[0]
        image.pixels.foreach_set(pixels.ravel())
        image.update()  # bytes do not hold all
        self.values = self._read()

    def update(self, _lit):
        """Somebody may have painted."""
        pixels = self._read()
        changed = np.flatnonzero(differing(pixels, self.values))
        if not len(changed) or len(changed) > _MOST_OF_IMAGE * len(pixels):
            self.values = pixels
            return
        before, mirror = self.values, _Mirror(self._object, self._carrier, *self.key[2:])
        texels, values, share = mirror.carried(changed, before[changed], pixels[changed])
        self.values = pixels
        if len(texels):
            pixels[texels] = (1 - share) * pixels[texels] + values
            self._write(pixels)
        both = np.concatenate([changed, texels])
        self.history = self.history[: self.done]
        self.history.append(Stroke(both, before[both], self.values[both], np.arange(len(both)) >= len(changed)))
        del self.history[: -bpy.context.preferences.edit.undo_steps - 1]
        self.done = len(self.history)

    def _complete(self, last):
        """After an undo or redo: Blender brings back what the user painted; our part comes from the image that was last
        there, and from the history."""
        state, history, began = last.copy(), self.history, self.done
        while self.done and history[self.done - 1].looks(self.values) < 0:
            self.done -= 1
            state[history[self.done].texels] = history[self.done].before
        while began <= self.done < len(history) and history[self.done].looks(self.values) > 0:
            state[history[self.done].texels] = history[self.done].after
            self.done += 1
        wanted = self.values.copy()
        for stroke in history:
            ours = stroke.texels[stroke.ours]
            wanted[ours] = state[ours]
        if not np.array_equal(wanted, self.values):
            self._write(wanted)


class _Mirror:
    """The mesh, its UV map and its symmetry, for one stroke."""

    def __init__(self, object, carrier, uv_map, *size):
        mesh = object.data
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        corners, faces = np.empty(3 * count, np.int32), np.empty(count, np.int32)
        mesh.loop_triangles.foreach_get("loops", corners)
        mesh.loop_triangles.foreach_get("polygon_index", faces)
        self._vertices = mesh_data.triangles(mesh)
        self._size = np.array(size)
        uvs = mesh_data.read_attribute(mesh.attributes[uv_map])
        self._uvs = uvs[corners.reshape(-1, 3)] * self._size - 0.5  # in texels: whole numbers are their centres
        self._open = mesh_data.open_elements(mesh, object.mode, "FACE")[faces]
        self._points = mesh_data.positions(mesh).astype(float)
        self._carrier = carrier

    def carried(self, changed, before, after):
        """Flat numbers of the texels that follow, (texels, 4) what was painted there, and (texels, 1) its share in them."""
        touched = self._touching(changed)
        texels, triangles, weights = self._raster(touched)
        of_stroke = np.isin(texels, changed)
        sizes = np.zeros(self._size.prod(), np.float32)
        sizes[changed] = np.abs(after - before).sum(axis=1)
        sides = np.einsum("tc,tc->t", weights, self._carrier.side[self._vertices[triangles]])
        side = np.sign((sizes[texels] * np.sign(sides))[of_stroke].sum())
        sources = np.unique(triangles[of_stroke & (sides * side > -1)])
        if not side or not len(sources):
            return np.zeros(0, np.int64), np.zeros((0, 4)), np.zeros((0, 1))
        sources = self._around(sources)
        targets = self._followers(sources, side)
        around = self._touching(self._raster(targets)[0])  # a margin may lie in another triangle
        texels, triangles, weights = self._raster(around)
        losing = np.einsum("tc,tc->t", weights, self._carrier.side[self._vertices[triangles]]) * side < 0
        losing &= np.isin(triangles, targets) & ~np.isin(texels, changed)
        texels, triangles, weights = texels[losing], triangles[losing], weights[losing]
        places, found = self._image_places(sources, triangles, weights)
        values = _sampled(changed, np.column_stack([after, np.ones(len(after))]), self._size, places)
        found &= values[:, 4] > _STILL
        return texels[found], values[found, :4], values[found, 4:]

    def _touching(self, changed):
        """Triangles whose box in the UV map, with its margin, holds changed texels."""
        places = np.stack([changed % self._size[0], changed // self._size[0]], axis=1)
        first, wide = places.min(axis=0), np.ptp(places, axis=0) + 1
        sums = np.zeros(wide + 1, np.int32)  # of the texels before each, in the box of the changed ones
        sums[tuple((places - first + 1).T)] = 1
        sums = sums.cumsum(axis=0).cumsum(axis=1)
        low, high = self._boxes(np.arange(len(self._uvs)))
        (x, y), (right, top) = np.clip(low - first, 0, wide).T, np.clip(high + 1 - first, 0, wide).T
        return np.flatnonzero(sums[right, top] - sums[x, top] - sums[right, y] + sums[x, y])

    def _boxes(self, triangles):
        """(triangles, 2) lowest and highest texels of each triangle and its margin."""
        uvs = self._uvs[triangles]
        low, high = np.ceil(uvs.min(axis=1) - _MARGIN), np.floor(uvs.max(axis=1) + _MARGIN)
        return np.clip(low, 0, self._size - 1).astype(int), np.clip(high, 0, self._size - 1).astype(int)

    def _raster(self, triangles):
        """Flat numbers of the texels of triangles, each once, the triangle of each and its place there, (texels, 3)."""
        low, high = self._boxes(triangles)
        wide = high - low + 1
        counts = wide.prod(axis=1)
        which = np.repeat(np.arange(len(triangles)), counts)
        step = np.arange(counts.sum()) - np.repeat(counts.cumsum() - counts, counts)
        x, y = low[which, 0] + step % wide[which, 0], low[which, 1] + step // wide[which, 0]
        corners = self._uvs[triangles]
        weights, heights = _flat_barycentric(np.stack([x, y], axis=1), corners, which)
        outside = -np.minimum(weights * heights[which], 0).min(axis=1)
        kept = np.flatnonzero(outside <= _MARGIN)
        texels = y[kept] * self._size[0] + x[kept]
        order = np.lexsort((outside[kept], texels))
        texels, first = np.unique(texels[order], return_index=True)
        kept = kept[order[first]]
        inside = np.maximum(weights[kept], 0)
        return texels, triangles[which[kept]], inside / inside.sum(axis=1, keepdims=True)

    def _around(self, triangles):
        """The triangles and those that share a vertex with them."""
        near = np.zeros(len(self._points), bool)
        near[self._vertices[triangles]] = True
        return np.flatnonzero(near[self._vertices].any(axis=1))

    def _followers(self, sources, side):
        """Triangles that may be painted and have a corner on the losing side, whose image is in the sources."""
        near = np.zeros(len(self._points), bool)
        near[self._vertices[sources]] = True
        follows = near[self._carrier.corners].any(axis=1) & self._carrier.has_image
        losing = (self._carrier.side[self._vertices] == -side).any(axis=1)
        return np.flatnonzero(follows[self._vertices].any(axis=1) & losing & self._open)

    def _image_places(self, sources, triangles, weights):
        """(texels, 2) places in the UV map of the image points, and which of them there are."""
        carrier = self._carrier
        images = np.einsum("vc,vcx->vx", carrier.weights, self._points[carrier.corners])
        places = np.einsum("tc,tcx->tx", weights, images[self._vertices[triangles]])
        found = carrier.has_image[self._vertices[triangles]].all(axis=1)
        used, local = np.unique(self._vertices[sources], return_inverse=True)
        tree = BVHTree.FromPolygons(self._points[used].tolist(), local.reshape(-1, 3).tolist())
        hits = [tree.find_nearest(place) for place in places.tolist()]
        nearest = sources[np.array([-1 if hit[2] is None else hit[2] for hit in hits], int)]
        at = np.array([hit[0] or (0, 0, 0) for hit in hits], float).reshape(-1, 3)
        inside = barycentric(at, self._points[self._vertices[nearest]])
        return np.einsum("tc,tcu->tu", inside, self._uvs[nearest]), found


def _flat_barycentric(points, corners, which):
    """(points, 3) place of each of (points, 2) in a triangle of (triangles, 3, 2), and (triangles, 3) heights."""
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # opposite to each corner
    doubled = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    doubled = np.where(np.abs(doubled) < 1e-12, np.inf, doubled)
    away = points[:, None] - np.roll(corners, -1, axis=1)[which]
    side = sides[which]
    weights = (side[:, :, 0] * away[:, :, 1] - side[:, :, 1] * away[:, :, 0]) / doubled[which, None]
    return weights, np.abs(doubled)[:, None] / np.maximum(np.linalg.norm(sides, axis=2), 1e-12)


def _sampled(changed, values, size, places):
    """(places, components) the values of flat texels, 0 elsewhere, between the four texels around each of (places, 2)."""
    low = np.floor(places).astype(int)
    share, total = places - low, np.zeros((len(places), values.shape[1]))
    for x in (0, 1):
        for y in (0, 1):
            texel = low + (x, y)
            number = np.where(((texel >= 0) & (texel < size)).all(axis=1), texel[:, 1] * size[0] + texel[:, 0], -1)
            row = np.minimum(np.searchsorted(changed, number), len(changed) - 1)
            weight = np.abs(1 - x - share[:, 0]) * np.abs(1 - y - share[:, 1]) * (changed[row] == number)
            total += weight[:, None] * values[row]
    return total
