"""Puts tables that `make bench` left into a page: python3 benches/page.py FOLDER docs/speed.md

Between the lines `<!-- NAME.md ... -->` and `<!-- end of NAME.md -->` of the page comes FOLDER/NAME.md, where there is one;
FOLDER/speed.png is copied beside the page.
"""

import re
import shutil
import sys
from pathlib import Path


def main() -> None:
    """Command line entry."""
    folder, page = map(Path, sys.argv[1:])

    def block(found: re.Match) -> str:
        table = folder / found["name"]
        return found["begin"] + table.read_text() + found["end"] if table.exists() else found[0]

    pattern = r"(?P<begin><!-- (?P<name>\w+\.md).*?-->\n).*?(?P<end><!-- end of (?P=name) -->)"
    page.write_text(re.sub(pattern, block, page.read_text(), flags=re.DOTALL))
    if (folder / "speed.png").exists():
        shutil.copy(folder / "speed.png", page.parent)


if __name__ == "__main__":
    main()
