"""One symmetry of a mesh, and the tools that mirror across it."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._handles import Handle
from ._library import LIBRARY, Mirroring, Summary
from .progress import ProgressLike, progress_of
from .surface import CurveLine, SurfacePoints

if TYPE_CHECKING:
    from .mesh import Mesh


class SymmetryKind(IntEnum):
    """How a symmetry moves the surface."""

    #: Reverses orientation: left and right are exchanged.
    REFLECTION = 0
    #: Keeps orientation and is its own inverse. It has no sides and no fixed curve.
    HALF_TURN = 1


class Merge(IntEnum):
    """Which vertices take the value of their mirror image."""

    #: Every vertex: the two sides are exchanged.
    SWAP = 0
    #: Every vertex takes the mean of its own and its image's value.
    AVERAGE = 1
    #: Vertices with side -1 take it; side 1 stays, and so does the fixed curve.
    POSITIVE_WINS = 2
    #: Vertices with side 1 take it; side -1 stays, and so does the fixed curve.
    NEGATIVE_WINS = 3


@dataclass(frozen=True)
class Evidence:
    """The figures that say how far a symmetry is to be trusted; the outcome follows from them.

    Shares are 0..1. Shells are connected components of the mesh.
    """

    #: Probability, 0..1, that the map is a symmetry of the shape at all; 1 for a restored one.
    plausibility: float
    #: Lower is better; comparable between symmetries of one mesh only.
    score: float
    #: Mean of the confidence over the surface, 0..1.
    mean_confidence: float
    #: Share of the vertices whose partner comes from mirrored connectivity: an exact bijection.
    exact_share: float
    #: Share of the surface whose vertices have a partner.
    paired_share: float
    #: Shells whose mirror image is another shell.
    shells_paired: int
    #: Shells that are their own mirror image.
    shells_self_mirrored: int
    #: Shells without a mirror image.
    shells_alone: int


class Symmetry:
    """One symmetry of a mesh. All arrays have one row for each vertex of the mesh that was given.

    The arrays are read when first asked for, and kept. It can be pickled, together with its mesh, and so cross to another process:
    there all values are the same, and the tools that mirror work as on a restored symmetry (:meth:`intrinsym.Mesh.restore`).
    """

    #: What a pickle holds.
    _STORED = ("_summary", "partner", "confidence", "side", "surface_points", "fixed_curve")

    def __init__(self, result: Handle, index: int, mesh: Mesh) -> None:
        self._result = result
        self._index = index
        self._mesh = mesh
        self._vertex_count = mesh.vertex_count

    def __getstate__(self) -> dict[str, Any]:
        state = {name: getattr(self, name) for name in self._STORED}
        return state | {"_index": 0, "_mesh": self._mesh, "_vertex_count": self._vertex_count}

    @cached_property
    def _result(self) -> Handle:
        """The library's object; that of one which came from another process is made anew."""
        arrays = (self.partner, self.confidence, self.side, self.surface_points)
        return self._mesh.restore(self.kind, *arrays)._result

    def __repr__(self) -> str:
        kind = self.kind.name.lower().replace("_", " ")
        return f"<{kind} of {self._vertex_count} vertices, mean confidence {self.mean_confidence:.2f}>"

    @cached_property
    def _summary(self) -> Summary:
        summary = Summary()
        LIBRARY.isym_result_summary(self._result.pointer, self._index, ctypes.byref(summary))
        return summary

    @property
    def kind(self) -> SymmetryKind:
        """Reflection or half turn."""
        return SymmetryKind(self._summary.kind)

    @cached_property
    def evidence(self) -> Evidence:
        """The figures that say how far it is to be trusted."""
        return Evidence(*(getattr(self._summary, field.name) for field in fields(Evidence)))

    @property
    def plausibility(self) -> float:
        """That of :attr:`evidence`."""
        return self.evidence.plausibility

    @property
    def mean_confidence(self) -> float:
        """That of :attr:`evidence`."""
        return self.evidence.mean_confidence

    @property
    def exact_share(self) -> float:
        """That of :attr:`evidence`."""
        return self.evidence.exact_share

    @cached_property
    def partner(self) -> NDArray[np.int32]:
        """(vertices,) int32: the vertex that is the mirror image; -1 for a vertex that no face uses.

        Of several vertices in one place, as at seams, it is the one at the mirrored corner of the mirrored face. Where left and
        right are not split alike, several vertices have one partner."""
        # NONE is -1 in a signed number.
        return self._read("partners", np.uint32).view(np.int32)

    @cached_property
    def confidence(self) -> NDArray[np.float32]:
        """(vertices,) float32: the estimated probability, 0..1, that the partner lies within 0.05 sqrt(area) of the truth."""
        return self._read("confidences", np.float32)

    @cached_property
    def side(self) -> NDArray[np.int8]:
        """(vertices,) int8: 1 and -1 on the two sides, 0 on the fixed curve, without partner, and everywhere for a
        half turn. Which side is 1 has no meaning."""
        return self._read("sides", np.int8)

    @cached_property
    def pair_colours(self) -> NDArray[np.uint8]:
        """(vertices, 3) uint8: red, green and blue (sRGB) of a colour that partners share and distinct pairs do not; grey
        without partner or confidence."""
        colours = np.empty((self._vertex_count, 3), np.uint8)
        LIBRARY.isym_result_pair_colours(self._result.pointer, self._index, colours, self._vertex_count)
        return colours

    def _read(self, name: str, kind: type[_arrays.Number]) -> NDArray[_arrays.Number]:
        values = np.empty(self._vertex_count, kind)
        getattr(LIBRARY, f"isym_result_{name}")(self._result.pointer, self._index, values, values.size)
        return values

    @cached_property
    def surface_points(self) -> SurfacePoints:
        """The exact mirror images, as points of the surface."""
        count = self._vertex_count
        faces = np.empty(count, np.uint32)
        corners, barycentrics = np.empty((count, 3), np.uint32), np.empty((count, 3), np.float32)
        LIBRARY.isym_result_surface_points(
            self._result.pointer, self._index, faces, corners, barycentrics, count
        )
        return SurfacePoints(faces, corners, barycentrics)

    @cached_property
    def fixed_curve(self) -> list[CurveLine]:
        """The lines that the symmetry leaves in place; empty for a half turn and for a restored symmetry."""
        line_count, point_count = ctypes.c_size_t(), ctypes.c_size_t()
        where = (self._result.pointer, self._index)
        LIBRARY.isym_result_curve_size(*where, ctypes.byref(line_count), ctypes.byref(point_count))
        lines, points = line_count.value, point_count.value
        if lines == 0:
            return []
        offsets, closed = np.empty(lines + 1, np.uint32), np.empty(lines, np.uint8)
        edges, parameters = np.empty((points, 2), np.uint32), np.empty(points, np.float32)
        LIBRARY.isym_result_curve(*where, offsets, closed, lines, edges, parameters, points)
        spans = [slice(offsets[line], offsets[line + 1]) for line in range(lines)]
        return [
            CurveLine(edges[span], parameters[span], bool(is_closed))
            for span, is_closed in zip(spans, closed)
        ]

    def curve_distances(self, positions: ArrayLike) -> NDArray[np.float64]:
        """(vertices,) distance of each vertex from the fixed curve along the surface, for (vertices, 3) positions in any
        pose, in their unit. Infinite where the curve cannot be reached: on other shells, without a curve, and for a
        restored symmetry. Raises ArgumentError."""
        given = _arrays.vectors(positions, self._vertex_count, "positions")
        distances = np.empty(self._vertex_count)
        LIBRARY.isym_result_curve_distances(self._result.pointer, self._index, given, distances, distances.size)
        return distances

    def mirror_selection(self, selected: ArrayLike, *, minimum_confidence: float = 0.0) -> NDArray[np.bool_]:
        """(vertices,) bool: the vertices whose mirror image lies in the selection, (vertices,) bool.

        Vertices with less confidence are not selected. A vertex of a denser side selects its partner even where
        that stands for several. Raises ArgumentError, OptionError.
        """
        given = _arrays.values_of(selected, self._vertex_count, "selected")
        chosen = _arrays.exactly(given != 0, (self._vertex_count,), np.uint8, "selected")
        mirrored = np.empty_like(chosen)
        LIBRARY.isym_result_mirror_selection(
            self._result.pointer, self._index, chosen, minimum_confidence, mirrored, mirrored.size
        )
        return mirrored.astype(bool)

    def mirror_face_selection(self, selected: ArrayLike, *, minimum_confidence: float = 0.0) -> NDArray[np.bool_]:
        """(faces,) bool: the faces that are the mirror image of the selection, (faces,) bool.

        A face whose corners have the corners of another face as partners is selected if that one is; any other, if
        all its corners are in the mirror image of the selected faces' corners. Faces with a corner of less confidence
        are not selected. Raises ArgumentError, OptionError.
        """
        given = _arrays.plain(selected, "selected")
        chosen = _arrays.exactly(given != 0, (given.size,), np.uint8, "selected")
        mirrored = np.empty_like(chosen)
        LIBRARY.isym_result_mirror_face_selection(
            self._result.pointer, self._index, chosen, minimum_confidence, mirrored, mirrored.size
        )
        return mirrored.astype(bool)

    def mirror_values(
        self,
        values: ArrayLike,
        merge: Merge = Merge.SWAP,
        *,
        minimum_confidence: float = 0.0,
        weight_by_confidence: bool = False,
    ) -> NDArray[np.float64]:
        """Mirrors an attribute, (vertices, ...) numbers, such as weights, colours, or masks; the same shape.

        Vertices below ``minimum_confidence`` keep their value; ``weight_by_confidence`` lets each change by the
        share of its confidence. Vectors in space need :meth:`carry_displacement` instead. Raises ArgumentError,
        and OptionError for a half turn, which has no sides, unless ``merge`` is swap or average.
        """
        given = _arrays.values_of(values, self._vertex_count, "values")
        components = given.size // max(self._vertex_count, 1)
        mirrored = np.empty_like(given)
        how = _mirroring(merge, minimum_confidence, weight_by_confidence)
        LIBRARY.isym_result_mirror_values(
            self._result.pointer, self._index, how, given, components, mirrored, self._vertex_count
        )
        return mirrored

    def carry_displacement(
        self,
        positions: ArrayLike,
        displacements: ArrayLike,
        merge: Merge = Merge.SWAP,
        *,
        minimum_confidence: float = 0.0,
        weight_by_confidence: bool = False,
    ) -> NDArray[np.float64]:
        """Carries displacements, (vertices, 3) in any unit, across the map in local frames, so that they are
        right in any pose: a shape key, or an edit. They are turned and stretched with the surface. (vertices, 3).

        ``positions`` are those of the shape that is displaced, in the pose it is in, (vertices, 3). The rest as
        in :meth:`mirror_values`.
        """
        shape = _arrays.vectors(positions, self._vertex_count, "positions")
        given = _arrays.vectors(displacements, self._vertex_count, "displacements")
        carried = np.empty_like(given)
        how = _mirroring(merge, minimum_confidence, weight_by_confidence)
        LIBRARY.isym_result_carry_displacement(
            self._result.pointer, self._index, how, shape, given, carried, self._vertex_count
        )
        return carried

    def symmetrize_positions(
        self,
        positions: ArrayLike,
        merge: Merge = Merge.AVERAGE,
        *,
        minimum_confidence: float = 0.0,
        weight_by_confidence: bool = False,
        progress: ProgressLike = None,
    ) -> NDArray[np.float64]:
        """Makes positions, (vertices, 3), symmetric: each side keeps its pose and takes the other's shape, or
        both the mean of the two. (vertices, 3).

        What is much smaller than the surface is carried whole; what is as large as a limb's pose stays. Raises
        CancelledError; the rest as in :meth:`mirror_values`.
        """
        given = _arrays.vectors(positions, self._vertex_count, "positions")
        moved = np.empty_like(given)
        how = _mirroring(merge, minimum_confidence, weight_by_confidence)
        progress_of(progress).run(
            lambda pointer: LIBRARY.isym_result_symmetrize_positions(
                self._result.pointer, self._index, how, given, pointer, moved, self._vertex_count
            )
        )
        return moved


def _mirroring(merge: Merge, minimum_confidence: float, weight_by_confidence: bool) -> Mirroring:
    return Mirroring(_arrays.constant(merge, "merge"), minimum_confidence, int(weight_by_confidence))
