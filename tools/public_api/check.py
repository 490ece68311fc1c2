"""Compares the public names of the Rust library, as rustdoc's pages list them, with the kept listing beside this file.

    python3 tools/public_api/check.py FOLDER [--write]

FOLDER is that of the crate below `doc` of cargo's target folder. Exit status 1 if they differ.
"""

import argparse
import difflib
import re
import sys
from pathlib import Path

LISTING = Path(__file__).with_name("names.txt")
ITEM = re.compile(r"(struct|enum|trait|fn|constant|type|macro)\.(\w+)\.html")
PART = re.compile(r'id="(?:structfield|variant|method|tymethod|associatedconstant)\.(\w+(?:\.field\.\w+)?)"')
#: Here the traits begin that are implemented for a type; what stands before is the type's own.
TRAITS = 'id="trait-implementations"'

#: The page of a private path leads to the public one.
MOVED = 'http-equiv="refresh"'


def names(folder):
    """Sorted names: items by their path, fields, variants and methods below them."""
    for page in folder.rglob("*.html"):
        if item := ITEM.fullmatch(page.name):
            path = "::".join((*page.relative_to(folder.parent).parts[:-1], item[2]))
            text = page.read_text(encoding="utf-8")
            if MOVED in text:
                continue
            yield f"{item[1]} {path}"
            own = text.split(TRAITS)[0]
            yield from (f"{item[1]} {path}.{part}" for part in set(PART.findall(own)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", action="store_true", help="keep what is there now")
    arguments = parser.parse_args()
    found = sorted(names(arguments.folder))
    if not found:
        sys.exit(f"{arguments.folder} holds no pages of rustdoc")
    if arguments.write:
        LISTING.write_text("\n".join(found) + "\n", encoding="utf-8")
    kept = LISTING.read_text(encoding="utf-8").splitlines()
    changes = list(difflib.unified_diff(kept, found, "kept", "found", lineterm="", n=0))
    if changes:
        print("\n".join(changes))
        sys.exit("the public names have changed; if on purpose: make public-api")
    print(f"{len(found)} public names, as kept in {LISTING.name}")


if __name__ == "__main__":
    main()
