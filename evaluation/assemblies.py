"""Characters, furniture and vehicles made of many shells: generated with exact truth, and judged.

    python -m evaluation.assemblies --write FOLDER [--only KIND ...]
    python -m evaluation.assemblies --judge FOLDER --program target/release/intrinsym --out results.json

The first writes NAME.ply and NAME.truth.npz for each assembly, the second judges the answers for every .ply and .obj with truth. The truth
holds, by vertex: `rest` (n, 3), the position at rest; `truth` (n, 3), the mirror point at rest, NaN where there is none or it is unknown;
`partner`, the vertex there, -1 it has none, -2 no vertex is there; `shell`; and by shell: `shell_mirror`, its twin or itself, -1 none.
Files from elsewhere may hold more; `posed` false says that the input is at rest.
"""

from __future__ import annotations

import argparse
import tempfile
from datetime import date
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from training.meshfile import read_ply, write_ply
from training.skeleton import MIRROR

from .assembly import Assembly
from .assembly_kinds import KINDS
from .markdown import table
from .program import detect, identity, read_answer, write_results
from .shells import Cut, Lathe, ball, block, disc

SEED = 9900
# The variant of assembly number i: how it is triangulated, and what is done to it.
VARIANTS = [("same", ""), ("recut", ""), ("remeshed", ""), ("recut", "missing"), ("recut", "props"), ("remeshed", "fused")]
DETAIL = {"half-hair": 1.1, "furniture": 1.4, "vehicle": 1.2}
COINCIDENT = 1e-5  # a vertex this near to a mirror point is the partner
NEAR = 0.05  # in sqrt(area)
GOOD = 0.9  # share of vertices within NEAR from which on a mesh is right
STATES = ("right", "wrong", "torn", "unpaired")


def draw(kind: str, number: int) -> tuple[Assembly, str]:
    """Assembly number `number` of a kind, and the name of its variant."""
    style, change = VARIANTS[number % len(VARIANTS)]
    rng = np.random.default_rng([SEED, list(KINDS).index(kind), number])
    assembly = Assembly(Cut(style, rng, DETAIL.get(kind, 1.0)), rng)
    KINDS[kind](assembly, number)
    if change == "missing":
        pairs = [name for name, part in assembly.parts.items() if part.mirror not in (None, name)]
        assembly.drop(str(rng.choice(pairs)))
    elif change:
        (attach if change == "props" else fuse)(assembly)
    return assembly, f"{style}-{change}" if change else style


def attach(assembly: Assembly) -> None:
    """Sword, shield and bag, or a box beside the middle."""
    if "right hand" not in assembly.bones or "pelvis" not in assembly.bones:
        assembly.add("box", beside(assembly)[1], next(iter(assembly.bones)), None)
        return
    hand, arm = assembly.middle("right hand", 0.8), assembly.middle("left forearm")
    ahead = lambda near, far: hand + np.array([[0, near, 0.0], [0, far, 0.02]])
    assembly.add("blade", Lathe(ahead(0.05, 0.45), [[0.018, 0.005], [0.016, 0.004]], 14, 10, 5.0, 2.0, 0.0, [1.0, 0, 0]), "right hand", None)
    assembly.add("hilt", Lathe(ahead(-0.06, 0.05), [0.01, 0.011], 8, 10, 5.0, 2.0, 0.0, [1.0, 0, 0]), "right hand", None)
    assembly.add("guard", block(hand + [0, 0.05, 0], [0.045, 0.008, 0.01], 6, 10), "right hand", None)
    assembly.add("shield", disc(arm + [0.05, 0.01, 0], [1.0, 0.2, 0.3], 0.13, 0.012, 26), "left forearm", None)
    assembly.add("bag", ball(assembly.middle("pelvis") + [0.15, -0.03, -0.05], [0.035, 0.06, 0.06], 10, 16, bulge=0.3), "pelvis", None)


def beside(assembly: Assembly) -> tuple[str, Lathe]:
    """The part with the most vertices, and a box that hangs on its left side."""
    name = max(assembly.parts, key=lambda part: len(assembly.parts[part].vertices))
    vertices = assembly.parts[name].vertices
    centre, size = vertices.mean(0), np.ptp(vertices, axis=0).max()
    at = vertices[np.argmax(vertices @ [1.0, -0.3, 0.6])]
    return name, ball(at + 0.12 * size * (at - centre) / np.linalg.norm(at - centre), [0.09 * size, 0.12 * size, 0.08 * size], 10, 16, bulge=0.3)


def fuse(assembly: Assembly) -> None:
    """A bag that is one surface with the hip, or a box with the largest part."""
    if "pelvis" in assembly.bones:
        hip = "pelvis" if "pelvis" in assembly.parts else "body"
        bag = ball(assembly.middle("pelvis") + [0.13, -0.02, -0.02], [0.035, 0.06, 0.065], 10, 16, bulge=0.3)
        assembly.fuse(hip, bag)
    else:
        assembly.fuse(*beside(assembly))


def laid_out(assembly: Assembly) -> tuple[np.ndarray, np.ndarray, dict]:
    """Posed vertices in any attitude, triangles and truth; shells in any order, vertices too where twins are cut apart."""
    rng, transforms = assembly.rng, assembly.transforms()
    names = [str(name) for name in rng.permutation(list(assembly.parts))]
    posed, rest, faces, shell, real, offset = [], [], [], [], [], 0
    for number, name in enumerate(names):
        part = assembly.parts[name]
        count = len(part.vertices)
        order = np.arange(count) if assembly.cut.style == "same" else rng.permutation(count)
        place = np.argsort(order)
        posed.append(assembly.posed(part, transforms)[order])
        rest.append(part.vertices[order])
        real.append(part.real[order])
        faces.append(place[part.faces] + offset)
        shell.append(np.full(count, number))
        offset += count
    twin = np.array([names.index(part.mirror) if (part := assembly.parts[name]).mirror else -1 for name in names])
    rest, shell, real = np.concatenate(rest), np.concatenate(shell), np.concatenate(real)
    truth = dict(rest=rest, truth=np.where(real[:, None], rest * MIRROR, np.nan), shell=shell, shell_mirror=twin)
    truth["partner"] = partners_at(rest, truth["truth"], shell, twin)
    return np.concatenate(posed) @ Rotation.random(rng=rng).as_matrix().T, np.concatenate(faces), truth


def partners_at(rest, truth, shell, twin) -> np.ndarray:
    """For each vertex the one of its shell's twin that lies at its mirror point; -1 and -2 as in the files."""
    partner = np.where(np.isnan(truth[:, 0]), -1, -2)
    for number, other in enumerate(twin):
        rows = np.flatnonzero((shell == number) & ~np.isnan(truth[:, 0]))
        there = np.flatnonzero(shell == other)
        if len(rows) and len(there):
            distance, nearest = cKDTree(rest[there]).query(truth[rows])
            partner[rows] = np.where(distance < COINCIDENT, there[nearest], -2)
    # Only one of two coincident vertices has the other for its partner.
    known = np.flatnonzero(partner >= 0)
    alone = partner[partner[known]] != known
    partner[known[alone]] = -2
    return partner


def write(folder: Path, kinds=tuple(KINDS)) -> None:
    """Writes each kind in each variant."""
    folder.mkdir(parents=True, exist_ok=True)
    for kind in kinds:
        for number in range(len(VARIANTS)):
            assembly, variant = draw(kind, number)
            at_rest = not assembly.turns and not assembly.shifts
            vertices, faces, truth = laid_out(assembly)
            name = f"{kind}-{number}-{variant}"
            write_ply(folder / f"{name}.ply", vertices, faces)
            np.savez_compressed(folder / f"{name}.truth.npz", kind=kind, posed=not at_rest, **narrow(truth))


def narrow(truth: dict) -> dict:
    """The same in single precision."""
    return {name: value.astype(np.float32 if value.dtype.kind == "f" else np.int32) for name, value in truth.items()}


def read_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a PLY file of ours, or of an OBJ file."""
    if path.suffix == ".ply":
        return read_ply(path)
    vertices, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
            faces += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return np.array(vertices), np.array(faces)


def triangle_areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area of each triangle."""
    corners = vertices[faces]
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2


def judge(partners: np.ndarray, faces: np.ndarray, truth: dict) -> dict:
    """What an answer is worth: shares of vertices, and the number of shells in each state."""
    rest, true, partner, shell, twin = (truth[name] for name in ("rest", "truth", "partner", "shell", "shell_mirror"))
    areas = triangle_areas(rest, faces)
    by_shell = np.bincount(shell[faces[:, 0]], areas, len(twin))
    judged, known, none = ~np.isnan(true[:, 0]), partner >= 0, partner == -1
    states = [state_of(partners[shell == number], shell, twin[number]) for number in range(len(twin)) if twin[number] >= 0]
    own = [number for number in range(len(twin)) if twin[number] >= 0 and twin[number] != number and most(partners[shell == number], shell) == number]
    return {
        "vertices": len(rest), "shells": len(twin), "largest": round(float(by_shell.max() / areas.sum()), 3),
        "paired": share(partners[judged] >= 0), "near": near_share(partners, rest, true, areas.sum()),
        "exact": share(partners[known] == partner[known]), "none paired": share(partners[none] >= 0),
        **{state: states.count(state) for state in STATES}, "own": len(own),
    }  # fmt: skip


def near_share(partners, rest, true, area: float) -> float | None:
    """Share of the vertices with a known mirror point whose image lies near it."""
    return share(rest_distances(partners, rest, true) < NEAR * np.sqrt(area))


def rest_distances(partners, rest, true) -> np.ndarray:
    """How far, at rest, the image of each vertex with a known mirror point is from it; infinite where there is none."""
    judged = np.flatnonzero(~np.isnan(true[:, 0]))
    images = partners[judged]
    return np.where(images >= 0, np.linalg.norm(rest[images] - true[judged], axis=1), np.inf)


def share(marks: np.ndarray) -> float | None:
    """Share of marked ones; None of nothing."""
    return round(float(marks.mean()), 4) if len(marks) else None


def most(images: np.ndarray, shell: np.ndarray) -> int:
    """The shell that more than half of these images lie on, -1 if there is none, -2 if half of them or more are missing."""
    given = shell[images[images >= 0]]
    if 2 * len(given) <= len(images):
        return -2
    counts = np.bincount(given)
    return int(counts.argmax()) if 2 * counts.max() > len(images) else -1


def state_of(images: np.ndarray, shell: np.ndarray, twin: int) -> str:
    """Whether a shell's images lie on its twin, on another shell, on several, or are missing."""
    return {twin: "right", -1: "torn", -2: "unpaired"}.get(most(images, shell), "wrong")


def plane_partners(vertices: np.ndarray) -> np.ndarray:
    """The nearest vertex to each one's image in the best mirror plane of the input: what a single plane achieves."""
    rng = np.random.default_rng(0)
    sample = vertices[rng.permutation(len(vertices))[:1000]]
    tree, centre, far = cKDTree(vertices), vertices.mean(0), 0.02 * np.linalg.norm(np.ptp(vertices, axis=0))
    best, plane = np.inf, None
    for normal in [*np.linalg.svd(vertices - centre, full_matrices=False)[2], *rng.normal(size=(40, 3))]:
        normal, offset = normal / np.linalg.norm(normal), None
        for _ in range(20):
            offset = normal @ centre if offset is None else offset
            images = sample - 2 * (sample @ normal - offset)[:, None] * normal
            distance, nearest = tree.query(images)
            kept = distance <= np.quantile(distance, 0.8)
            normal, offset = fitted_plane(sample[kept], vertices[nearest[kept]])
        if (cost := np.minimum(distance, far).mean()) < best:
            best, plane = cost, (normal, offset)
    normal, offset = plane
    return tree.query(vertices - 2 * (vertices @ normal - offset)[:, None] * normal)[1]


def fitted_plane(points: np.ndarray, images: np.ndarray) -> tuple[np.ndarray, float]:
    """The mirror plane (normal, offset) that takes points nearest to images."""
    a, b = points - points.mean(0), images - images.mean(0)
    moment = a.T @ b
    normal = np.linalg.eigh(moment + moment.T)[1][:, 0]
    return normal, float(normal @ (points.mean(0) + images.mean(0)) / 2)


def judged_folder(folder: Path, program: str, options: list[str]) -> list[dict]:
    """A row for each mesh of a folder that has a truth."""
    rows = []
    meshes = [path for path in sorted([*folder.glob("*.ply"), *folder.glob("*.obj")]) if path.with_suffix(".truth.npz").exists()]
    for mesh in meshes:
        truth = dict(np.load(mesh.with_suffix(".truth.npz")))
        vertices, faces = read_mesh(mesh)
        with tempfile.TemporaryDirectory() as work:
            seconds = detect(program, [mesh], Path(work), ["--threads", "1", *options])
            answer = read_answer(Path(work), mesh.stem)
        row = {"name": mesh.stem, "kind": str(truth.get("kind", mesh.stem)), "posed": bool(truth.get("posed", True))}
        row |= judge(answer.partners, faces, truth) | {"outcome": answer.report["outcome"], "seconds": round(seconds, 2)}
        if not row["posed"]:
            area = triangle_areas(truth["rest"], faces).sum()
            row["plane near"] = near_share(plane_partners(vertices), truth["rest"], truth["truth"], area)
        rows.append(row)
        print(row, flush=True)
    return rows


def row_of(name: str, rows: list[dict]) -> list[str]:
    """A kind in the table."""
    mean = lambda key: (lambda values: f"{100 * np.mean(values):.0f}" if values else "")([row[key] for row in rows if row.get(key) is not None])
    total = lambda key: str(sum(row[key] for row in rows))
    outcomes = [row["outcome"] for row in rows]
    good = sum(row["near"] >= GOOD for row in rows)
    rest = [row for row in rows if "plane near" in row]
    lost = f"{sum(row['near'] < row['plane near'] for row in rest)} of {len(rest)}" if rest else ""
    return [
        name, f"{good} of {len(rows)}", *(mean(key) for key in ("near", "paired", "exact", "none paired")), *(total(state) for state in STATES), total("own"),
        " / ".join(str(outcomes.count(outcome)) for outcome in ("found", "doubtful")) + f" / {sum(outcome not in ('found', 'doubtful') for outcome in outcomes)}", lost,
    ]  # fmt: skip


def report(result: dict) -> str:
    """The table of the pages."""
    rows = result["meshes"]
    shown = [row_of(kind, [row for row in rows if row["kind"] == kind]) for kind in dict.fromkeys(row["kind"] for row in rows)]
    several = [row for row in rows if row["largest"] < 0.5]
    shown += [row_of("**largest shell under half**", several), row_of("**half or more**", [row for row in rows if row["largest"] >= 0.5]), row_of("**all**", rows)]
    head = ["kind", "right", "near %", "paired %", "exact %", "without counterpart, paired %", *(f"shells {state}" for state in STATES), "own mirror, though a twin", "found / doubtful / none", "at rest, worse than a plane"]
    made = f"`make evaluate-assemblies`, {result['date']} ([data](results/{result['date']}-assemblies.json)):"
    return f"{made}\n\n{table(head, shown)}"


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--only", nargs="+", choices=KINDS, default=tuple(KINDS))
    parser.add_argument("--judge", type=Path)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--options", default="", help="further options of `detect`, in one word list")
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    if arguments.write:
        write(arguments.write, arguments.only)
    if arguments.judge:
        rows = judged_folder(arguments.judge, arguments.program, arguments.options.split())
        result = {"date": str(date.today()), "program": identity(arguments.program), "meshes": rows}
        if arguments.out:
            write_results(arguments.out, result)
        print(report(result))


if __name__ == "__main__":
    main()
