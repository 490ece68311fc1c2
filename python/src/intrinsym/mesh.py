"""Meshes, and what is computed on them."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass
from typing import Any, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._handles import Handle, new_handle
from ._keywords import with_keywords_of
from ._library import LIBRARY
from .detection import Detection, report_of, symmetry_count
from .errors import ERROR_LENGTH, ArgumentError
from .options import Effort, options_handle
from .progress import Progress, ProgressLike, progress_of
from .surface import SurfacePoints
from .symmetry import Symmetry, SymmetryKind


class Polygons(NamedTuple):
    """Faces of any size: face f has the corners ``corners[offsets[f]:offsets[f + 1]]``."""

    #: (faces + 1,) whole numbers, rising from 0 to the number of corners.
    offsets: ArrayLike
    #: (corners,) vertex numbers from 0.
    corners: ArrayLike


#: (faces, k) vertex numbers from 0, k = 3 for triangles, 4 for quads; or Polygons.
Faces = Union[ArrayLike, Polygons]


@dataclass(frozen=True, eq=False)
class Eigenpairs:
    """Lowest eigenpairs of the Laplace-Beltrami operator, the constant function left out."""

    #: (count,) float64, rising, in units of 1 / area of the largest shell.
    values: NDArray[np.float64]
    #: (vertices, count) float64, orthonormal in the mass; NaN off the largest shell. Signs have no meaning.
    functions: NDArray[np.float64]
    #: (vertices,) float64, sums to 1; 0 off the largest shell.
    mass: NDArray[np.float64]


class Mesh:
    """A validated mesh. It never changes; any number of calls in any threads may use it at once.

    ``vertices``: (n, 3) numbers in any unit. ``faces``: see :data:`Faces`. Both are copied. Non-manifold edges,
    several shells, boundaries, inconsistent orientation, duplicate and degenerate faces and unreferenced vertices
    are accepted. Raises MeshError for numbers that are not finite, indices past the end, and a mesh without any
    area; LimitError above 5 million vertices or 10 million triangles; ArgumentError for arrays of another shape, and
    for masked ones of which entries are masked. A mesh can be pickled.
    """

    def __init__(self, vertices: ArrayLike, faces: Faces) -> None:
        points = _arrays.points(vertices, "vertices")
        suffix = "_f32" if points.dtype == np.float32 else ""
        if isinstance(faces, Polygons):
            offsets = _flat(_arrays.indices(faces.offsets, "offset"))
            corners = _flat(_arrays.indices(faces.corners, "corner"))
        else:
            offsets, corners = _regular_faces(faces)
        function = getattr(LIBRARY, f"isym_mesh_from_polygons{suffix}")
        face_count = max(len(offsets) - 1, 0)
        self._own(
            new_handle("mesh", function, points, len(points), offsets, face_count, corners, len(corners))
        )

    def __reduce__(self) -> tuple[type[Mesh], tuple[NDArray[np.float64], Polygons]]:
        return Mesh, (self.vertices, self.polygons)

    def _own(self, handle: Handle) -> None:
        sizes = [ctypes.c_size_t() for _ in range(3)]
        LIBRARY.isym_mesh_size(handle.pointer, *map(ctypes.byref, sizes))
        self._handle = handle
        self.vertex_count, self.face_count, self._corner_count = (size.value for size in sizes)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Mesh:
        """Reads a PLY, OBJ, OFF, STL, glTF or GLB file. Raises MeshFileError, which names the line or byte,
        MeshError, LimitError."""
        mesh = cls.__new__(cls)
        mesh._own(new_handle("mesh", LIBRARY.isym_mesh_read, _arrays.path(path)))
        return mesh

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(vertices, 3) positions, a copy."""
        positions = np.empty((self.vertex_count, 3))
        LIBRARY.isym_mesh_positions(self._handle.pointer, positions, positions.size)
        return positions

    @property
    def polygons(self) -> Polygons:
        """The faces, a copy, as two arrays of uint32."""
        offsets = np.empty(self.face_count + 1, np.uint32)
        corners = np.empty(self._corner_count, np.uint32)
        LIBRARY.isym_mesh_polygons(self._handle.pointer, offsets, offsets.size, corners, corners.size)
        return Polygons(offsets, corners)

    @property
    def connectivity_hash(self) -> int:
        """64 bits over the number of vertices, face sizes and corners, not the positions; equal for equal
        connectivity on every machine. Keep it beside a stored map: where it has changed, the map is stale."""
        value = ctypes.c_uint64()
        LIBRARY.isym_mesh_connectivity_hash(self._handle.pointer, ctypes.byref(value))
        return value.value

    def detect(
        self,
        *,
        effort: Effort | None = None,
        symmetries: int | None = None,
        plausibility: int | None = None,
        threads: int | None = None,
        memory: int | None = None,
        time_limit: int | None = None,
        network: bool | None = None,
        eigenfunctions: int | None = None,
        samples: int | None = None,
        beam_width: int | None = None,
        proxy_vertices: int | None = None,
        model: str | os.PathLike[str] | None = None,
        known_signs: ArrayLike | None = None,
        previous: Detection | Symmetry | None = None,
        progress: ProgressLike = None,
    ) -> Detection:
        """Finds the intrinsic symmetries, the best first; none found is an empty Detection and no error.

        An option that is None has the library's default. Those for which no default stands here follow from ``effort``.

        Parameters
        ----------
        effort : {"fast", "default", "thorough"}
            How hard to try. Fast never looks twice, default looks again where its answer leaves doubts, thorough looks hard
            at once.
        symmetries : int, 1 to 32, default 1
            Most distinct symmetries to return; a square table has more than one.
        plausibility : int, 0 to 100 percent, default 50
            From where on a map counts as a symmetry; half of it is enough for one that mirrors vertices. Below, the map is
            given as doubtful.
        threads : int, 1 to 64, default 2
            Most threads of this call. The result does not depend on it.
        memory : int, 0 to 100000000 MB, default 0
            Most memory, mesh included, estimated before it is taken; 0 is no limit.
        time_limit : int, 1 to 1000000 seconds
            None for no limit. After so long the best map so far is the answer, as doubtful, or LimitError is raised. The result then
            depends on the machine.
        network : bool, default True
            Whether the sign network proposes even and odd eigenfunctions.
        eigenfunctions : int, 12 to 200
            Laplace-Beltrami eigenfunctions of the refined map.
        samples : int, 100 to 5000
            Surface samples on which candidate maps are refined.
        beam_width : int, 1 to 256
            Width of the beam search over even and odd eigenfunctions.
        proxy_vertices : int, 1000 to 100000000
            Vertices above which the map is found on a simplified mesh of about so many, and carried back.
        model : path
            File of a sign network of your own (ONNX); it is trusted input. It needs the ONNX Runtime library (1.24 or newer)
            that the environment variable ``ORT_DYLIB_PATH`` names.
        known_signs : array of int
            What a person knows of the first functions of :meth:`eigen`: 1 even, -1 odd, 0 unknown. It overrules the network.
        previous : Detection or Symmetry
            What was found on a mesh with the same connectivity and other positions, or a restored Symmetry. Its maps that
            are symmetries of the new shape, too, are kept, if the best one is: partners, confidence, sides and curves as they
            were, figures and report new (``report.kept``). That is some seven times as fast as a search. Otherwise this is a
            search. What is kept knows nothing of vertices that were slid along the surface, on one side alone: search anew
            after that. The newest Detection or the first is the fastest ``previous``; a restored Symmetry takes twice as long.
        progress : Progress, or a callback ``(stage, fraction)`` that may answer False to cancel

        Raises
        ------
        OptionError, ModelError, LimitError, CancelledError
        ArgumentError
            ``previous`` is of another connectivity.
        """
        chosen = options_handle(
            {
                "effort": effort,
                "symmetries": symmetries,
                "plausibility": plausibility,
                "threads": threads,
                "memory": memory,
                "time_limit": time_limit,
                "network": network,
                "eigenfunctions": eigenfunctions,
                "samples": samples,
                "beam_width": beam_width,
                "proxy_vertices": proxy_vertices,
            },
            model,
            known_signs,
        )
        return self._detect(chosen, previous, progress_of(progress))

    def _detect(
        self, options: Handle, previous: Detection | Symmetry | None, progress: Progress
    ) -> Detection:
        best = previous if isinstance(previous, Symmetry) else next(iter(previous or ()), None)
        function = LIBRARY.isym_mesh_detect if best is None else LIBRARY.isym_mesh_detect_again
        earlier = [] if best is None else [best._result.pointer]
        arguments = (self._handle.pointer, *earlier, options.pointer)
        result = progress.run(lambda pointer: new_handle("result", function, *arguments, pointer))
        symmetries = [Symmetry(result, index, self) for index in range(symmetry_count(result))]
        return Detection(symmetries, report_of(result))

    def eigen(self, count: int, *, progress: ProgressLike = None) -> Eigenpairs:
        """The ``count`` lowest eigenpairs, 1 to 1000, on the mesh's largest shell; fewer on a tiny mesh.

        Raises ArgumentError for another count, CancelledError.
        """
        wanted = _arrays.count(count, "count")
        handle = progress_of(progress).run(
            lambda pointer: new_handle(
                "eigen", LIBRARY.isym_mesh_eigen, self._handle.pointer, wanted, pointer
            )
        )
        rows, found = ctypes.c_size_t(), ctypes.c_size_t()
        LIBRARY.isym_eigen_size(handle.pointer, ctypes.byref(rows), ctypes.byref(found))
        values, mass = np.empty(found.value), np.empty(rows.value)
        functions = np.empty((rows.value, found.value))
        LIBRARY.isym_eigen_read(handle.pointer, values, functions, mass, rows.value, found.value)
        return Eigenpairs(values, functions, mass)

    def restore(
        self,
        kind: SymmetryKind,
        partner: ArrayLike,
        confidence: ArrayLike,
        side: ArrayLike,
        surface_points: SurfacePoints,
    ) -> Symmetry:
        """A symmetry from stored arrays, in the form of :class:`Symmetry`, so that its tools work on a map that
        was kept with a mesh.

        Positions may have changed since; the connectivity may not (see :attr:`connectivity_hash`). Raises
        ArgumentError, which names the first entry that cannot be right.
        """
        count = self.vertex_count
        arrays = [
            _arrays.exactly(partner, (count,), np.int32, "partner").view(np.uint32),
            _arrays.exactly(confidence, (count,), np.float32, "confidence"),
            _arrays.exactly(side, (count,), np.int8, "side"),
            _arrays.exactly(surface_points.faces, (count,), np.uint32, "faces"),
            _arrays.exactly(surface_points.corners, (count, 3), np.uint32, "corners"),
            _arrays.exactly(surface_points.barycentrics, (count, 3), np.float32, "barycentrics"),
        ]
        restore = LIBRARY.isym_result_restore
        result = new_handle("result", restore, self._handle.pointer, _arrays.constant(kind, "kind"), *arrays, count)
        return Symmetry(result, 0, self)


def _flat(array: NDArray[np.uint32]) -> NDArray[np.uint32]:
    if array.ndim != 1:
        raise ArgumentError(f"polygons need flat arrays, not one of shape {array.shape}", ERROR_LENGTH)
    return array


def _regular_faces(faces: ArrayLike) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
    """Offsets and corners of (faces, k) vertex numbers."""
    table = _arrays.indices(faces, "face")
    if table.ndim != 2 or table.shape[1] < 3:
        shape = f"faces has the shape {table.shape}"
        raise ArgumentError(f"{shape}; (faces, 3), (faces, 4) or Polygons is needed", ERROR_LENGTH)
    offsets = np.arange(len(table) + 1, dtype=np.uint32) * np.uint32(table.shape[1])
    return offsets, table.reshape(-1)


@with_keywords_of(Mesh.detect)
def detect(vertices: ArrayLike, faces: Faces, /, **keywords: Any) -> Detection:
    """``Mesh(vertices, faces).detect(...)``: see :class:`Mesh`, and :meth:`Mesh.detect` for the keywords."""
    return Mesh(vertices, faces).detect(**keywords)


@with_keywords_of(Mesh.eigen)
def eigen(vertices: ArrayLike, faces: Faces, /, count: int, **keywords: Any) -> Eigenpairs:
    """``Mesh(vertices, faces).eigen(count)``: see :class:`Mesh` and :meth:`Mesh.eigen`."""
    return Mesh(vertices, faces).eigen(count, **keywords)
