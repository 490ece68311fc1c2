"""Makes the tables of the pages again from the newest result files: `python -m evaluation.pages`."""

from __future__ import annotations

import json
from pathlib import Path

from . import ablate_tables, assemblies, hard_meshes, many_meshes_tables, princeton_tables, remeshed, robustness_tables, stability, synthetic_tables, watertight
from .markdown import filled

ROOT = Path(__file__).parent.parent
PAGES = ("README.md", "docs/results.md", "docs/robustness.md", "docs/ablation.md", "docs/ray.md")
# The parts of pages, the result file they are made from (docs/results/DATE-KIND.json), and by what.
PARTS = {
    "princeton-short": ("princeton", princeton_tables.short_report),
    "princeton": ("princeton", princeton_tables.full_report),
    "remeshed-short": ("remeshed", remeshed.short_report),
    "remeshed": ("remeshed", remeshed.report),
    "synthetic": ("synthetic", synthetic_tables.report),
    "watertight": ("watertight", watertight.report),
    "assemblies": ("assemblies", assemblies.report),
    "robustness": ("robustness", robustness_tables.report),
    "stability": ("stability", stability.report),
    "hard": ("hard", hard_meshes.report),
    "ablation": ("ablation", ablate_tables.report),
    "ray": ("ray", many_meshes_tables.report),
    "ray-bill": ("ray", many_meshes_tables.bill),
}


def newest(kind: str) -> dict | None:
    """The newest results of a kind; None if none are kept."""
    files = sorted((ROOT / "docs" / "results").glob(f"*-{kind}.json"))
    return json.loads(files[-1].read_text()) if files else None


def made_parts() -> dict[str, str]:
    """The text of every part whose results are kept."""
    results = {kind: newest(kind) for kind, _ in PARTS.values()}
    return {name: make(results[kind]) for name, (kind, make) in PARTS.items() if results[kind]}


def main() -> None:
    """Writes the pages."""
    parts = made_parts()
    for page in PAGES:
        path = ROOT / page
        path.write_text(filled(path.read_text(), parts))


if __name__ == "__main__":
    main()
