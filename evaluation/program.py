"""Runs the command line over many meshes and reads back what it answered."""

from __future__ import annotations

import json
import resource
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

PLY_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}


# Exit statuses that are answers: found, doubtful, no symmetry.
ANSWERS = (0, 3, 1)


@dataclass
class Answer:
    """What the program said about one mesh."""

    name: str
    # Without doubts.
    found: bool
    # For each vertex its 0-based partner, -1 for none.
    partners: np.ndarray
    # The whole JSON report.
    report: dict
    # Probability that each partner is right; empty unless the PLY was asked for.
    confidence: np.ndarray

    @property
    def has_map(self) -> bool:
        """Whether a map is given, doubtful or not."""
        return self.report["outcome"] != "none"

    @property
    def plausibility(self) -> float | None:
        """Of the best map, accepted or not; None if there was none."""
        judged = self.report["report"]["judged"]
        return judged and judged["plausibility"]

    @property
    def seconds(self) -> dict[str, float]:
        """Wall seconds by stage, of one thread."""
        return {stage: seconds for stage, seconds in self.report["report"]["seconds"]}


def detect(
    program: str, meshes: list[Path], folder: Path, options: list[str], jobs: int = 1, write: str = "map,json"
) -> float:
    """Runs `program detect` over all meshes in one process into `folder`; gives back its CPU seconds.

    Raises RuntimeError if any mesh was an error; that no symmetry was found is none.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [
        program,
        "detect",
        *meshes,
        "--output-dir",
        folder,
        "--write",
        write,
        "--jobs",
        str(jobs),
        "--quiet",
        *options,
    ]
    status = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if status.returncode not in ANSWERS:
        raise RuntimeError(f"{program} ended with {status.returncode}: {status.stderr.strip()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def identity(program: str) -> str:
    """Version of the program, and the commit of the checkout that measures it, as far as there is one."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    where = Path(__file__).parent
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], capture_output=True, text=True, cwd=where
    ).stdout.strip()
    return f"{version}, commit {commit}" if commit else version


def write_results(path: Path, result: dict) -> None:
    """Writes JSON with one mesh a line, so that differences can be read."""
    parts = []
    for name, value in result.items():
        rows = isinstance(value, list) and value
        shown = "[\n" + ",\n".join("  " + json.dumps(row) for row in value) + "\n ]" if rows else json.dumps(value)
        parts.append(f" {json.dumps(name)}: {shown}")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("{\n" + ",\n".join(parts) + "\n}\n")


def read_answer(folder: Path, name: str) -> Answer:
    """The answer that `detect` left for the mesh NAME."""
    report = json.loads((folder / f"{name}.json").read_text())
    partners = np.loadtxt(folder / f"{name}.map", dtype=int, ndmin=1)
    ply = folder / f"{name}.ply"
    confidence = ply_vertices(ply)["sym_confidence"].astype(float) if ply.exists() else np.zeros(0)
    return Answer(name, report["outcome"] == "found", partners, report, confidence)


def ply_vertices(path: Path) -> np.ndarray:
    """The vertices of a binary little-endian PLY as a structured array; they must come first and hold no lists."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    elements = [index for index, words in enumerate(lines) if words[0] == "element"]
    first = lines[elements[0]]
    if ["format", "binary_little_endian", "1.0"] not in lines or first[1] != "vertex":
        raise ValueError(f"{path}: only binary little-endian PLY whose vertices come first is read")
    end = elements[1] if len(elements) > 1 else len(lines)
    properties = [words for words in lines[elements[0] + 1 : end] if words[0] == "property"]
    return np.frombuffer(body, [(words[2], "<" + PLY_TYPES[words[1]]) for words in properties], int(first[2]))
