# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of vertices as files: CSV with one row a vertex, JSON with everything, and the command line's `.map`.

JSON is an object with `format` "intrinsym-pairs", `version` 1, `vertices`, `connectivity` (the library's hash), `kind`,
one array for each column of the CSV but the first, and `lines`, the line between left and right, which a CSV has not.
Of the columns only `partner` is needed.
"""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .mesh_data import MeshProblem

#: Column: its kind. -1 stands for none.
COLUMNS = {"partner": int, "confidence": float, "side": int, "face": int}
COLUMNS.update({f"corner_{place}": int for place in range(3)})
COLUMNS.update({f"weight_{place}": float for place in range(3)})
_TYPES = {int: np.int64, float: np.float64}
FORMAT, VERSION = "intrinsym-pairs", 1
KINDS = "reflection", "half_turn"
#: Programs may begin a file with a mark of its encoding.
_ENCODING = "utf-8-sig"


@dataclass(frozen=True)
class Line:
    """One piece of the line between left and right, as a file holds it."""

    edges: np.ndarray  # (points, 2) int64
    parameters: np.ndarray  # (points,) float64
    closed: bool


def write(path, columns, about):
    """Writes `columns`, arrays by the names of COLUMNS; `about` is what a JSON says besides."""
    path = Path(path)
    if path.suffix.lower() == ".json":
        lists = {name: _plain(values) for name, values in columns.items()}
        path.write_text(json.dumps({"format": FORMAT, "version": VERSION, **about, **lists}) + "\n")
        return
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("vertex", *columns))
        writer.writerows(zip(range(len(columns["partner"])), *map(_plain, columns.values())))


def _plain(values):
    """Numbers as short as they can be to read back the same."""
    return [float(str(value)) for value in values] if values.dtype.kind == "f" else values.tolist()


def read(path):
    """(columns, about) as `write` takes them. Raises MeshProblem, OSError."""
    path = Path(path)
    readers = {".json": _read_json, ".csv": _read_csv, ".map": _read_map}
    if path.suffix.lower() not in readers:
        raise MeshProblem(f"Pairs are read from .csv, .json and .map, not from {path.name}")
    try:
        return readers[path.suffix.lower()](path)
    except ValueError as problem:
        raise MeshProblem(f"The file {path.name} holds no pairs of vertices: {problem}") from None
    except (KeyError, TypeError, AttributeError, OverflowError, RecursionError, csv.Error):
        said = "it is damaged, or written in another form"
        raise MeshProblem(f"The file {path.name} holds no pairs of vertices: {said}") from None


def _read_json(path):
    stored = json.loads(path.read_text(_ENCODING))
    if (stored.get("format"), stored.get("version")) != (FORMAT, VERSION):
        raise ValueError(f'its format is not "{FORMAT}", version {VERSION}')
    about = {name: value for name, value in stored.items() if name not in COLUMNS}
    if about.setdefault("kind", KINDS[0]) not in KINDS:
        raise ValueError(f'the kind "{about["kind"]}" is none of {", ".join(KINDS)}')
    about["lines"] = list(map(_line, about.get("lines", ())))
    return _arrays({name: stored[name] for name in COLUMNS if name in stored}), about


def _line(stored):
    edges = np.array(stored["edges"], np.int64).reshape(-1, 2)
    return Line(edges, np.array(stored["parameters"], np.float64), bool(stored["closed"]))


def _read_csv(path):
    with path.open(newline="", encoding=_ENCODING) as file:
        delimiter = ";" if ";" in file.readline() else ","
        file.seek(0)
        reader = csv.reader(file, delimiter=delimiter)
        table = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if row]
    head = [name.lower() for name in table[0][1]] if table else []
    if unlike := [line for line, row in table if len(row) != len(head)]:
        raise ValueError(f"its lines have unlike numbers of cells: see line {unlike[0]}")
    rows = [dict(zip(head, row)) for _, row in table[1:]]
    given = [name for name in ("vertex", *COLUMNS) if rows and name in rows[0]]
    arrays = _arrays({name: [row[name] for row in rows] for name in given}, [line for line, _ in table[1:]])
    if "vertex" in arrays:
        order = np.argsort(arrays["vertex"], kind="stable")
        arrays = {name: values[order] for name, values in arrays.items()}
        _check_numbers(arrays.pop("vertex").tolist())
    return arrays, {}


def _check_numbers(vertices):
    """Raises ValueError unless the sorted numbers are those of all vertices."""
    if vertices == list(range(1, len(vertices) + 1)):
        raise ValueError("the column vertex does not count from 0")
    twice = next((one for one, other in zip(vertices, vertices[1:]) if one == other), None)
    if twice is not None:
        raise ValueError(f"vertex {twice} has two rows")
    missing = sorted(set(range(len(vertices))) - set(vertices))
    if missing:
        raise ValueError(f"vertex {missing[0]} has no row. Each vertex needs one: both of a pair, and those without a partner")


def _number(text, kind):
    """The number that a text or a number says; as a whole one `4.0` as well. Raises ValueError."""
    try:
        number = float(text)
        if kind is float or number.is_integer():
            return kind(number)
    except ValueError:
        pass
    raise ValueError(f"{text or 'an empty cell'} is no {'number' if kind is float else 'whole number'}")


def _read_map(path):
    return _arrays({"partner": path.read_text(_ENCODING).split()}), {}


def _arrays(columns, lines=None):
    """The columns as arrays. Raises ValueError, which says the line of a cell that is no number, or else its vertex."""
    if "partner" not in columns:
        raise ValueError("there is no column partner")
    arrays = {}
    for name, values in columns.items():
        kind, numbers = COLUMNS.get(name, int), []
        for row, value in enumerate(values):
            try:
                numbers.append(_number(value, kind))
            except ValueError as problem:
                where = f"line {lines[row]}" if lines else f"vertex {row}"
                raise ValueError(f"{where}, column {name}: {problem}") from None
        arrays[name] = np.array(numbers, _TYPES[kind])
    if len({len(values) for values in arrays.values()}) > 1:
        raise ValueError("its columns are not equally long")
    return arrays
