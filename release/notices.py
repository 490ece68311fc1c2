"""Licence texts of all that is linked, the bill of materials, and the release notes."""

from __future__ import annotations

import json
import re
import shutil
import uuid
from collections import defaultdict
from datetime import datetime, timezone
from pathlib import Path

from cargo import ROOT, commit_time
from crates import Component, components
from link import version
from targets import Target

OWN_LICENCES = ["LICENSE", "LICENSE-APACHE", "LICENSE-MIT"]
HEAD = "What the files beside this one are linked of, and its licences.\n\n"


def write_licences(target: Target, folder: Path) -> None:
    """Our licences, the model's card, and those of what is linked."""
    for name in [*OWN_LICENCES, "models/MODEL_CARD.md"]:
        shutil.copy(ROOT / name, folder)
    write_third_party(target, folder)


def write_third_party(target: Target, folder: Path) -> None:
    """THIRD_PARTY.txt; the terms of Rust's library, which are a page, beside it."""
    linked = components(target)
    pages = [text for component in linked for text in component.texts if text.suffix == ".html"]
    for page in pages:
        shutil.copy(page, folder / f"THIRD_PARTY_RUST{page.suffix}")
    listed = "".join(f"{part.name} {part.version}: {part.licence}\n" for part in linked)
    (folder / "THIRD_PARTY.txt").write_text(HEAD + listed + _texts(linked))


def _texts(linked: list[Component]) -> str:
    """Each text once, under the names of those that it belongs to."""
    owners: dict[str, list[str]] = defaultdict(list)
    for component in linked:
        for text in component.texts:
            if text.suffix != ".html":
                owners[text.read_text(errors="replace").strip()].append(component.name)
    without = [component.name for component in linked if not component.texts]
    note = f"\nWithout a text of their own, under the licence that stands above: {', '.join(without)}.\n" if without else ""
    rule = "\n" + "-" * 100 + "\n"
    return note + "".join(f"{rule}{', '.join(dict.fromkeys(names))}:\n\n{text}\n" for text, names in owners.items())


def _bom_entry(component: Component, targets: list[str]) -> dict:
    return {
        "type": "library",
        "bom-ref": component.purl,
        "name": component.name,
        "version": component.version,
        "licenses": [{"expression": component.licence}],
        "purl": component.purl,
        "properties": [{"name": "intrinsym:target", "value": target} for target in targets],
    }


def write_bom(targets: list[Target], output: Path) -> None:
    """A CycloneDX bill of materials: which component is linked into which target's files."""
    used: dict[Component, list[str]] = defaultdict(list)
    for target in targets:
        for component in components(target):
            used[component].append(target.name)
    entries = [_bom_entry(component, names) for component, names in sorted(used.items(), key=lambda item: item[0].purl)]
    own = f"pkg:cargo/intrinsym@{version()}"
    bom = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, f'{own}#{commit_time()}')}",
        "version": 1,
        "metadata": {
            "timestamp": datetime.fromtimestamp(commit_time(), timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "component": {
                "type": "application", "bom-ref": own, "name": "intrinsym", "version": version(), "purl": own,
                "licenses": [{"expression": "MIT OR Apache-2.0"}],
            },
        },
        "components": entries,
        "dependencies": [{"ref": own, "dependsOn": [entry["bom-ref"] for entry in entries]}],
    }
    output.write_text(json.dumps(bom, indent=1) + "\n")


def write_notes(output: Path, missing: list[str]) -> None:
    """The changelog's section of this version, or of what is not released yet, and what this release lacks."""
    sections = re.split(r"^## ", (ROOT / "CHANGELOG.md").read_text(), flags=re.MULTILINE)[1:]
    titles = {section.splitlines()[0].strip("[] ").split("]")[0].split(" ")[0]: section for section in sections}
    section = titles.get(version()) or titles["Unreleased"]
    body = section.split("\n", 1)[1].strip()
    lacking = "".join(f"- {line}\n" for line in missing)
    output.write_text(f"# Intrinsym {version()}\n\n{body}\n" + (f"\n## Not in this release\n\n{lacking}" if lacking else ""))
