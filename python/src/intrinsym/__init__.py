"""Intrinsym: the intrinsic mirror symmetry of a surface mesh, whatever its pose.

Five lines give a map::

    import intrinsym
    mesh = intrinsym.Mesh.read("human.ply")
    found = mesh.detect()
    if found:                        # found.outcome says whether it is doubtful
        print(found[0].partner)      # (vertices,) the mirror image of each vertex

The same from arrays: ``intrinsym.detect(V, F)``. Everything that the C library can do is here, with numpy
arrays in and out; the library checks what it is given, and its errors come as exceptions with its text.
Functions may be called from several threads at once, and let other threads go on; a detection uses up to ``threads`` of its own.
"""

from ._library import ENVIRONMENT_VARIABLE, library_path, library_version
from .detection import Detection
from .errors import (
    ArgumentError,
    CancelledError,
    InternalError,
    IntrinsymError,
    LimitError,
    MeshError,
    MeshFileError,
    ModelError,
    OptionError,
)
from .mesh import Eigenpairs, Mesh, Polygons, detect, eigen
from .options import Effort, OptionSpec, option_specs
from .progress import Progress
from .report import Judgement, Outcome, Reason, Repairs, Report, SignPrediction, SymmetryReport
from .surface import CurveLine, SurfacePoints
from .symmetry import Evidence, Merge, Symmetry, SymmetryKind

__version__ = library_version()

__all__ = [
    "ENVIRONMENT_VARIABLE",
    "ArgumentError",
    "CancelledError",
    "CurveLine",
    "Detection",
    "Effort",
    "Eigenpairs",
    "Evidence",
    "InternalError",
    "IntrinsymError",
    "Judgement",
    "LimitError",
    "Merge",
    "Mesh",
    "MeshError",
    "MeshFileError",
    "ModelError",
    "OptionError",
    "OptionSpec",
    "Outcome",
    "Polygons",
    "Progress",
    "Reason",
    "Repairs",
    "Report",
    "SignPrediction",
    "SurfacePoints",
    "Symmetry",
    "SymmetryKind",
    "SymmetryReport",
    "detect",
    "eigen",
    "library_path",
    "library_version",
    "option_specs",
]
