"""What a detection did and measured, with the names of the JSON that ``intrinsym detect --json`` writes."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any, Literal, TypeVar, Union

Part = TypeVar("Part")

#: What may speak for an answer or against it.
ReasonName = Literal[
    "mirror_plane",
    "mirrored_connectivity",
    "best_map",
    "no_candidate",
    "not_onto_itself",
    "one_reflection",
    "mirrored_vertices",
    "of_rest",
    "continuous_family",
    "low_plausibility",
    "low_confidence",
    "few_partners",
    "nothing_said",
    "time_limit",
    "restored",
    "not_kept",
]


class Outcome(str, Enum):
    """What was found, in the word that the JSON has for it."""

    #: At least one symmetry.
    FOUND = "found"
    #: A map is given, and :attr:`Report.evidence` says what speaks against it: it is less plausible than was asked for, or
    #: its confidence is low over most of the surface.
    DOUBTFUL = "doubtful"
    #: No map came near to a symmetry.
    NONE = "none"


@dataclass(frozen=True)
class Repairs:
    """What was repaired inside, without touching the caller's numbering: counts of elements."""

    #: Vertices that no used face refers to; they have no partner.
    unreferenced_vertices: int
    #: Faces with fewer than three distinct corners, dropped.
    degenerate_faces: int
    #: Faces with the same corners as an earlier face, dropped.
    duplicate_faces: int
    #: Faces whose orientation was reversed to agree with their neighbours.
    flipped_faces: int
    #: Edges with more than two faces, kept.
    non_manifold_edges: int
    #: Vertices whose faces form more than one fan, kept.
    non_manifold_vertices: int
    #: Vertices on seams, or of a copy of a shell in its place, treated as one point with another vertex there.
    welded_vertices: int
    #: Faces without area, kept.
    zero_area_faces: int


@dataclass(frozen=True)
class SignPrediction:
    """What the sign network says of one eigenfunction: three probabilities, 0..1, that sum to 1."""

    #: That the function is its own mirror image.
    even: float
    #: That it is the negative of its mirror image.
    odd: float
    #: That it is neither: a repeated eigenvalue, or no symmetry.
    neither: float
    #: ln(even / odd): positive for even, its size is the confidence.
    logit: float


@dataclass(frozen=True)
class Judgement:
    """What the best map was judged by, accepted or not."""

    #: How far the map is from an isometry, on a logarithmic scale; lower is better.
    isometry_score: float
    #: Correlation of the orientation before and after the map: -1 for a reflection, 1 for a half turn; 0 where the shell, or twins, tell the kind.
    orientation: float
    #: Mean difference of the heat kernel signatures of partners; 0 for an isometry.
    signature_mismatch: float
    #: How far the map moves points in the mean; 0 for the identity, 1 where shells were joined.
    displacement: float
    #: How far apart rigid parts of the map put a point, in units of sqrt(area); None where no parts are fitted.
    disagreement: float | None
    #: Share of the surface, 0..1, that images leave empty beyond what is usual; None where no parts are fitted.
    scatter: float | None
    #: Probability, 0..1, that a map of these measures is a symmetry.
    plausibility: float


@dataclass(frozen=True)
class Reason:
    """One thing that speaks for an answer or against it; :attr:`Report.evidence` has all of them in words."""

    #: Which, such as "best_map" or "low_confidence".
    name: ReasonName
    #: Its figures by name, as in the JSON; empty where it has none.
    figures: dict[str, Any]


@dataclass(frozen=True)
class SymmetryReport:
    """What the report says of one symmetry beyond :class:`intrinsym.Symmetry`."""

    #: One sentence on how much of the surface, and how many of its shells, have a mirror image.
    coverage: str
    #: Vertices with a partner.
    paired_vertices: int
    #: Length of the fixed curve, in the mesh's unit.
    fixed_curve_length: float
    #: Number of the fixed curve's lines.
    fixed_curve_pieces: int


@dataclass(frozen=True)
class Report:
    """What a detection did and measured."""

    #: Found, doubtful or none.
    outcome: Outcome
    #: Why the outcome is what it is.
    reasons: tuple[Reason, ...]
    #: The reasons in one sentence.
    evidence: str
    #: The figures of that sentence; None if no candidate map was worth a judgement.
    judged: Judgement | None
    #: Whether the mesh has infinitely many symmetries, as a sphere, a torus or a vase has. Those given are arbitrary ones.
    continuous_family: bool
    #: What that is judged by: 0 for such a mesh, large for others; None if it cannot be oriented.
    least_signature_gradient: float | None
    #: Whether the symmetries are those of ``previous``, kept.
    kept: bool
    #: One entry for each symmetry, in their order.
    symmetries: tuple[SymmetryReport, ...]
    #: Number of vertices.
    vertices: int
    #: Number of faces.
    faces: int
    #: Number of shells (connected components).
    shells: int
    #: What was repaired.
    repairs: Repairs
    #: Small holes that were filled for the search.
    filled_holes: int
    #: Vertices on which the map was sought.
    solved_vertices: int
    #: Eigenvalues of the largest shell, rising, in units of 1 / area; the constant function's zero left out.
    eigenvalues: tuple[float, ...]
    #: Predictions for the first eigenfunctions; empty without the network and without known signs.
    signs: tuple[SignPrediction, ...]
    #: Each stage and its wall seconds, in order.
    seconds: tuple[tuple[str, float], ...]
    #: The options that the detection ran with.
    options: dict[str, Any]
    #: Version of the library.
    version: str
    #: All of it as ``intrinsym detect --json`` writes it.
    json: dict[str, Any]

    @classmethod
    def from_json(cls, text: str) -> Report:
        """The report in the library's text."""
        whole = json.loads(text)
        read = whole["report"]
        judged = read["judged"]
        typed = {
            "outcome": Outcome(whole["outcome"]),
            "reasons": tuple(map(_reason, read["reasons"])),
            "judged": judged and _named(Judgement, judged),
            "symmetries": tuple(_named(SymmetryReport, entry) for entry in whole["symmetries"]),
            "repairs": _named(Repairs, read["repairs"]),
            "eigenvalues": tuple(read["eigenvalues"]),
            "signs": tuple(_named(SignPrediction, sign) for sign in read["signs"]),
            "seconds": tuple((stage, seconds) for stage, seconds in read["seconds"]),
        }
        return _named(cls, {**whole, **read, **typed, "json": whole})


def _reason(entry: Union[ReasonName, dict[ReasonName, dict[str, Any]]]) -> Reason:
    """A reason without figures is its name alone."""
    ((name, figures),) = ({entry: {}} if isinstance(entry, str) else entry).items()
    return Reason(name, figures)


def _named(kind: Callable[..., Part], values: dict[str, Any]) -> Part:
    """A dataclass of the values that have its fields' names."""
    return kind(**{field.name: values[field.name] for field in fields(kind)})  # type: ignore[arg-type]
