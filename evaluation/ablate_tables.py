"""Tables of an ablation: per set and over all sets, each variant against the first."""

from __future__ import annotations

import numpy as np

from .generated import WRONG
from .markdown import table

# Plausibility from which on the program accepts a map by default.
ACCEPTED = 0.5
DRAWS, INTERVAL = 2000, (5, 95)
# Mean errors below this, in sqrt(area), count as this where changes are divided by them: half an edge of 30,000 vertices.
FLOOR = 0.003


def change(before: np.ndarray, after: np.ndarray) -> tuple[float, float, float]:
    """Change of the mean error in %, and its 90 % bootstrap interval over the meshes; those that are wrong either way are left out."""
    right = (before <= WRONG) & (after <= WRONG)
    before, after = before[right], after[right]
    if not len(before):
        return np.nan, np.nan, np.nan
    drawn = np.random.default_rng(0).integers(len(before), size=(DRAWS, len(before)))
    changes = 100 * (after - before)[drawn].mean(1) / np.maximum(before[drawn].mean(1), FLOOR)
    low, high = np.percentile(changes, INTERVAL)
    return 100 * (after - before).mean() / max(before.mean(), FLOOR), low, high


def columns(rows: list[dict], variant: str, names: list[str]) -> dict[str, np.ndarray]:
    """Errors, plausibilities and CPU seconds of a variant, in the order of the meshes' names."""
    of = {row["name"]: row for row in rows if row["variant"] == variant}
    pick = lambda key: np.array([of[name][key] if of[name][key] is not None else np.nan for name in names], float)
    return {key: pick(key) for key in ("error", "plausibility", "cpu")}


def complete(rows: list[dict], variants: list[str]) -> list[str]:
    """Names of the meshes that all variants have, in the order of the rows."""
    seen: dict[str, set] = {}
    for row in rows:
        seen.setdefault(row["name"], set()).add(row["variant"])
    return [name for name, found in seen.items() if found >= set(variants)]


def summary(rows: list[dict], variants: list[str]) -> str:
    """A row a variant over meshes with a truth (error, wrong, accepted) and without one (accepted), and the CPU of both."""
    names = complete(rows, variants)
    first = columns(rows, variants[0], names)
    truth = np.isfinite(first["error"])
    shown = []
    for variant in variants:
        now = columns(rows, variant, names)
        middle, low, high = change(first["error"][truth], now["error"][truth])
        accepted = now["plausibility"] >= ACCEPTED
        cpu = lambda chosen: f"{now['cpu'][chosen].sum() / first['cpu'][chosen].sum():.2f}" if chosen.any() else "-"
        shown.append([
            variant, f"{middle:+.1f} [{low:.1f}, {high:.1f}]", (now["error"][truth] > WRONG).sum(),
            accepted[truth].sum(), accepted[~truth].sum(), cpu(truth), cpu(~truth),
        ])  # fmt: skip
    head = ["variant", "error, %", "wrong", f"accepted of {truth.sum()}", f"without a symmetry: accepted of {(~truth).sum()}",
            "CPU", "CPU without a symmetry"]  # fmt: skip
    return table(head, shown)


def by_set(rows: list[dict], variants: list[str]) -> str:
    """Change of the mean error in % by set, bold where the interval leaves out 0; wrong maps more or fewer in brackets."""
    names = complete(rows, variants)
    sets = {row["name"]: row["set"] for row in rows}
    with_truth = {row["set"] for row in rows if row["error"] is not None}
    shown = []
    for name in [name for name in dict.fromkeys(sets.values()) if name in with_truth]:
        chosen = [mesh for mesh in names if sets[mesh] == name]
        first = columns(rows, variants[0], chosen)["error"]
        cells = [cell(first, columns(rows, variant, chosen)["error"]) for variant in variants[1:]]
        shown.append([name, len(chosen), f"{first[first <= WRONG].mean():.4f}", (first > WRONG).sum(), *cells])
    return table(["set", "meshes", "error", "wrong", *variants[1:]], shown)


def cell(before: np.ndarray, after: np.ndarray) -> str:
    """One variant on one set."""
    middle, low, high = change(before, after)
    wrong = int((after > WRONG).sum() - (before > WRONG).sum())
    text = "-" if np.isnan(middle) else f"{middle:+.0f}"
    text = f"**{text}**" if low > 0 or high < 0 else text
    return f"{text} ({wrong:+d} wrong)" if wrong else text


def report(result: dict) -> str:
    """The tables of docs/ablation.md."""
    variants, rows = list(result["variants"]), result["rows"]
    made = f"`make ablate`, {result['date']} ([data](results/{result['date']}-ablation.json)):"
    return f"{made}\n\n{summary(rows, variants)}\n\n{by_set(rows, variants)}"
