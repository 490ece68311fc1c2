"""Tables of Markdown, and pages with parts that are made from result files."""

from __future__ import annotations

import re


def table(header: list[str], rows: list[list]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def filled(page: str, parts: dict[str, str]) -> str:
    """`page` with what stands between `<!-- made NAME -->` and the next `<!-- end -->` replaced by `parts[NAME]`."""
    fill = lambda found: f"{found[1]}\n{parts[found[2]]}\n{found[3]}" if found[2] in parts else found[0]
    return re.sub(r"(<!-- made ([\w-]+) -->)\n.*?(<!-- end -->)", fill, page, flags=re.DOTALL)


def parts_of(page: str) -> list[str]:
    """Names of the made parts of a page."""
    return re.findall(r"<!-- made ([\w-]+) -->", page)
