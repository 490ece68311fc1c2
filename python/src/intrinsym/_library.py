"""Finds and loads the C library, and declares its functions: the Python face of include/isym.h."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.ctypeslib import ndpointer

from .errors import error_of

#: Names a library to load instead of the one in the package; for development.
ENVIRONMENT_VARIABLE = "INTRINSYM_LIBRARY"


class Sized(ctypes.Structure):
    """A struct whose first field is its own size, as the library asks for."""

    _fields_ = [("size", ctypes.c_size_t)]

    def __init__(self, *values: Any) -> None:
        super().__init__(ctypes.sizeof(type(self)), *values)


class Summary(Sized):
    """``isym_summary``."""

    _fields_ = [
        ("kind", ctypes.c_int32),
        ("plausibility", ctypes.c_double),
        ("score", ctypes.c_double),
        ("mean_confidence", ctypes.c_double),
        ("exact_share", ctypes.c_double),
        ("paired_share", ctypes.c_double),
        ("shells_paired", ctypes.c_size_t),
        ("shells_self_mirrored", ctypes.c_size_t),
        ("shells_alone", ctypes.c_size_t),
    ]


class Mirroring(Sized):
    """``isym_mirroring``."""

    _fields_ = [
        ("merge", ctypes.c_int32),
        ("minimum_confidence", ctypes.c_float),
        ("weight_by_confidence", ctypes.c_int32),
    ]


class OptionSpecStruct(Sized):
    """``isym_option_spec``."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        ("help", ctypes.c_char_p),
        ("choices", ctypes.c_char_p),
        ("default_value", ctypes.c_double),
        ("minimum", ctypes.c_double),
        ("maximum", ctypes.c_double),
        ("is_expert", ctypes.c_int32),
    ]


#: ``isym_progress_callback``.
ProgressCallback = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_char_p, ctypes.c_double, ctypes.c_void_p)


def _array(kind: type) -> type:
    return ndpointer(dtype=kind, flags="C_CONTIGUOUS")


_HANDLE = ctypes.c_void_p
_OUT_HANDLE = ctypes.POINTER(ctypes.c_void_p)
_TEXT = ctypes.c_char_p
_SIZE = ctypes.c_size_t
_OUT_SIZE = ctypes.POINTER(ctypes.c_size_t)
_OUT_DOUBLE = ctypes.POINTER(ctypes.c_double)
_MIRRORING = ctypes.POINTER(Mirroring)
_I8 = _array(np.int8)
_U8, _U32 = _array(np.uint8), _array(np.uint32)
_F32, _F64 = _array(np.float32), _array(np.float64)

#: Functions that return a status, with their parameters.
CHECKED: dict[str, list[Any]] = {
    "isym_option_describe": [_SIZE, ctypes.POINTER(OptionSpecStruct)],
    "isym_options_new": [_OUT_HANDLE],
    "isym_options_set": [_HANDLE, _TEXT, ctypes.c_double],
    "isym_options_get": [_HANDLE, _TEXT, _OUT_DOUBLE],
    "isym_options_set_model": [_HANDLE, _TEXT],
    "isym_options_set_known_signs": [_HANDLE, _I8, _SIZE],
    "isym_options_free": [_HANDLE],
    "isym_progress_new": [_OUT_HANDLE],
    "isym_progress_set_callback": [_HANDLE, ProgressCallback, ctypes.c_void_p],
    "isym_progress_fraction": [_HANDLE, _OUT_DOUBLE],
    "isym_progress_cancel": [_HANDLE],
    "isym_progress_free": [_HANDLE],
    "isym_mesh_from_triangles": [_F64, _SIZE, _U32, _SIZE, _OUT_HANDLE],
    "isym_mesh_from_triangles_f32": [_F32, _SIZE, _U32, _SIZE, _OUT_HANDLE],
    "isym_mesh_from_polygons": [_F64, _SIZE, _U32, _SIZE, _U32, _SIZE, _OUT_HANDLE],
    "isym_mesh_from_polygons_f32": [_F32, _SIZE, _U32, _SIZE, _U32, _SIZE, _OUT_HANDLE],
    "isym_mesh_read": [_TEXT, _OUT_HANDLE],
    "isym_mesh_size": [_HANDLE, _OUT_SIZE, _OUT_SIZE, _OUT_SIZE],
    "isym_mesh_positions": [_HANDLE, _F64, _SIZE],
    "isym_mesh_polygons": [_HANDLE, _U32, _SIZE, _U32, _SIZE],
    "isym_mesh_connectivity_hash": [_HANDLE, ctypes.POINTER(ctypes.c_uint64)],
    "isym_mesh_detect": [_HANDLE, _HANDLE, _HANDLE, _OUT_HANDLE],
    "isym_mesh_detect_again": [_HANDLE, _HANDLE, _HANDLE, _HANDLE, _OUT_HANDLE],
    "isym_mesh_eigen": [_HANDLE, _SIZE, _HANDLE, _OUT_HANDLE],
    "isym_mesh_free": [_HANDLE],
    "isym_result_outcome": [_HANDLE, ctypes.POINTER(ctypes.c_int32)],
    "isym_result_symmetry_count": [_HANDLE, _OUT_SIZE],
    "isym_result_continuous_family": [_HANDLE, ctypes.POINTER(ctypes.c_uint8)],
    "isym_result_summary": [_HANDLE, _SIZE, ctypes.POINTER(Summary)],
    "isym_result_partners": [_HANDLE, _SIZE, _U32, _SIZE],
    "isym_result_confidences": [_HANDLE, _SIZE, _F32, _SIZE],
    "isym_result_sides": [_HANDLE, _SIZE, _I8, _SIZE],
    "isym_result_surface_points": [_HANDLE, _SIZE, _U32, _U32, _F32, _SIZE],
    "isym_result_pair_colours": [_HANDLE, _SIZE, _U8, _SIZE],
    "isym_result_curve_size": [_HANDLE, _SIZE, _OUT_SIZE, _OUT_SIZE],
    "isym_result_curve": [_HANDLE, _SIZE, _U32, _U8, _SIZE, _U32, _F32, _SIZE],
    "isym_result_report_size": [_HANDLE, _OUT_SIZE],
    "isym_result_report": [_HANDLE, ctypes.c_char_p, _SIZE],
    "isym_result_restore": [_HANDLE, ctypes.c_int32, _U32, _F32, _I8, _U32, _U32, _F32, _SIZE, _OUT_HANDLE],
    "isym_result_free": [_HANDLE],
    "isym_result_mirror_selection": [_HANDLE, _SIZE, _U8, ctypes.c_float, _U8, _SIZE],
    "isym_result_mirror_face_selection": [_HANDLE, _SIZE, _U8, ctypes.c_float, _U8, _SIZE],
    "isym_result_mirror_values": [_HANDLE, _SIZE, _MIRRORING, _F64, _SIZE, _F64, _SIZE],
    "isym_result_carry_displacement": [_HANDLE, _SIZE, _MIRRORING, _F64, _F64, _F64, _SIZE],
    "isym_result_symmetrize_positions": [_HANDLE, _SIZE, _MIRRORING, _F64, _HANDLE, _F64, _SIZE],
    "isym_result_curve_distances": [_HANDLE, _SIZE, _F64, _F64, _SIZE],
    "isym_eigen_size": [_HANDLE, _OUT_SIZE, _OUT_SIZE],
    "isym_eigen_read": [_HANDLE, _F64, _F64, _F64, _SIZE, _SIZE],
    "isym_eigen_free": [_HANDLE],
}

#: Functions that cannot fail, with their result and parameters.
UNCHECKED: dict[str, tuple[Any, list[Any]]] = {
    "isym_version": (_TEXT, []),
    "isym_error_message": (_TEXT, []),
    "isym_status_name": (_TEXT, [ctypes.c_int32]),
    "isym_option_count": (_SIZE, []),
    "isym_handle_count": (_SIZE, []),
}


def _file_name() -> str:
    if sys.platform == "win32":
        return "intrinsym.dll"
    return "libintrinsym.dylib" if sys.platform == "darwin" else "libintrinsym.so"


def library_path() -> Path:
    """The C library's file: the one that the environment names, the wheel's own, or a checkout's build.

    Raises ImportError, which names the places, if there is none.
    """
    package = Path(__file__).resolve().parent
    named = os.environ.get(ENVIRONMENT_VARIABLE)
    places = [
        package / "lib" / _file_name(),
        package.parents[2] / "target" / "release" / _file_name(),
    ]
    for place in [Path(named)] if named else places:
        if place.is_file():
            return place
    tried = named or ", ".join(map(str, places))
    raise ImportError(f"the library of intrinsym is missing: {tried}; install the wheel for this system")


def _load() -> ctypes.CDLL:
    library = ctypes.CDLL(str(library_path()))
    for name, (result, parameters) in UNCHECKED.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, parameters
    for name, arguments in CHECKED.items():
        function = getattr(library, name)
        function.restype, function.argtypes, function.errcheck = ctypes.c_int32, arguments, _check
    return library


def _check(status: int, _function: object, _arguments: tuple[Any, ...]) -> None:
    if status != 0:
        raise error_of(status, LIBRARY.isym_error_message().decode())


LIBRARY = _load()


def library_version() -> str:
    """The version of the C library that is running, such as "0.1.0"."""
    version: bytes = LIBRARY.isym_version()
    return version.decode()
