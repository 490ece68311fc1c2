"""The constants on docs/method.md are those of the source files that it names."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent.parent
PAGE = (ROOT / "docs" / "method.md").read_text()
FILE = re.compile(r"`([\w/]+\.rs)`")
CONSTANT = re.compile(r"`(\w+) = ([^`]+)`")
SPAN = re.compile(r"`[^`]+`")
MOST_LINES = 250


def cells_of(heading):
    """The cells of each row of the first table below a heading, the head of the table left out."""
    section = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = [line.strip("|").split("|") for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in rows[2:]]


def stated():
    """File, name and value of each constant in the last table; each stands behind its file."""
    found = []
    for _, constants, _ in cells_of("Constants"):
        path = None
        for span in SPAN.findall(constants):
            if is_file := FILE.fullmatch(span):
                path = is_file[1]
            elif is_constant := CONSTANT.fullmatch(span):
                found.append((path, *is_constant.groups()))
    return found


def stated_of_plans():
    """Field and value of each count in the table of the plans; a cell holds the values of its row's fields, in order."""
    found = []
    for _, fields, *values in cells_of("Plans and doubts"):
        names = re.findall(r"`(\w+)`", fields)
        for cell in values:
            numbers = re.findall(r"\[[^\]]*\]|\w+", cell)
            if cell != "as small":
                assert len(numbers) == len(names), (fields, cell)
                found += zip(names, numbers, strict=True)
    return [(name, {"no": "false", "yes": "true"}.get(value, value)) for name, value in found]


def holds(source, name, value):
    """Whether a constant or a field of this name has this value somewhere in a source."""
    plain = re.escape(value)
    return re.search(rf"\bconst {name}: [^=]+ = {plain};|\b{name}: {plain}[,\s}}]", source) is not None


@pytest.mark.parametrize(("path", "name", "value"), stated())
def test_a_constant_of_the_page_is_in_its_file(path, name, value):
    assert holds((ROOT / "src" / path).read_text(), name, value)


@pytest.mark.parametrize(("name", "value"), stated_of_plans())
def test_a_count_of_the_plans_is_in_its_file(name, value):
    assert holds((ROOT / "src" / "base" / "effort.rs").read_text(), name, value)


def test_the_tables_are_read():
    assert len(stated()) > 100 and len(stated_of_plans()) >= 11
    assert ("verify/acceptance.rs", "SURE", "0.8") in stated() and ("base/effort.rs", "passes", "[150, 300]") in stated() and ("proxy_vertices", "6000") in stated_of_plans()


def test_another_value_is_noticed():
    source = "const NEAR: f64 = 0.05;\nplan { samples: 500, passes: [150, 300] }"
    assert holds(source, "NEAR", "0.05") and holds(source, "samples", "500") and holds(source, "passes", "[150, 300]")
    assert not any(holds(source, name, value) for name, value in [("NEAR", "0.5"), ("NEAR", "0.0"), ("EAR", "0.05"), ("samples", "50")])


@pytest.mark.parametrize(("path", "name"), [("acceptance", "WEIGHTS"), ("acceptance", "WEIGHTS_WITH_PARTS"), ("confidence", "WEIGHTS")])
def test_the_formulas_have_the_fitted_weights(path, name):
    (weights,) = (value for file, own, value in stated() if (file, own) == (f"verify/{path}.rs", name))
    formulas = [re.findall(r"\d+\.\d{4}\b", line) for line in PAGE.splitlines() if "1 / (1 + exp(" in line]
    assert sorted(re.findall(r"\d+\.\d{4}\b", weights)) in [sorted(set(formula) - {"0.0005"}) for formula in formulas]


def test_files_and_links_of_the_page_exist():
    source = ROOT / "src"
    assert all((source / name).is_file() for name in FILE.findall(PAGE))
    assert all((ROOT / "docs" / name).is_file() for name in re.findall(r"\]\(([\w./-]+)", PAGE))
    headings = {re.sub(r"[^\w -]", "", line.lstrip("# ").lower()).replace(" ", "-") for line in PAGE.splitlines() if line.startswith("#")}
    assert set(re.findall(r"\]\(#([\w-]+)\)", PAGE)) <= headings


def test_the_page_stays_short():
    assert len(PAGE.splitlines()) <= MOST_LINES
