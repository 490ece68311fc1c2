"""The pages say what the kept result files say."""

import pytest

from evaluation import markdown, pages


def test_only_named_parts_are_filled():
    page = "a\n<!-- made one -->\nold\n<!-- end -->\nb\n<!-- made two-x -->\n<!-- end -->\n"
    assert markdown.filled(page, {"one": "new"}) == page.replace("old", "new")
    assert "\nnew\n<!-- end -->\n" in markdown.filled(page, {"two-x": "new"})
    assert markdown.parts_of(page) == ["one", "two-x"]


@pytest.mark.parametrize("page", pages.PAGES)
def test_the_tables_of_the_pages_are_those_of_the_newest_results(page):
    text, parts = (pages.ROOT / page).read_text(), pages.made_parts()
    assert markdown.parts_of(text)
    assert markdown.filled(text, parts) == text, "run python -m evaluation.pages"
