"""Style sheet, scripts and licences of a page: what it has of others, and which rule wins."""

import re

import pytest

from axisrig.reports.parts.shipped import licences, page_style, plot_scripts, shipped_text

RULE = re.compile(r"([^{}]+){([^{}]*)}")


def last_rule(style: str, selector: str, name: str) -> str:
    """The value that counts: of rules with one selector the last one (CSS Cascade 4, 6.1)."""
    values = [
        value.removesuffix("!important").strip()
        for names, inside in RULE.findall(re.sub(r"/\*.*?\*/", "", style, flags=re.DOTALL))
        if selector in [each.strip() for each in names.split(",")]
        for key, _, value in (entry.partition(":") for entry in inside.split(";"))
        if key.strip() == name
    ]
    return values[-1]


@pytest.mark.parametrize(
    ("selector", "name"),
    [(".uplot", "font-family"), (".u-legend", "margin"), (".u-legend", "text-align")],
)
def test_a_rule_of_the_page_wins_over_that_of_what_draws_its_plots(
    selector: str, name: str
) -> None:
    own = last_rule(shipped_text("style.css"), selector, name)
    assert own != last_rule(shipped_text("vendor/uplot/uPlot.min.css"), selector, name)
    assert last_rule(page_style(), selector, name) == own


def test_a_script_comes_after_those_that_it_uses() -> None:
    scripts = plot_scripts()
    names = ("var uPlot=", "pako", "const axisrigBlocks = ", "const axisrigPlots = ")
    places = [scripts.index(name) for name in names]
    assert places == sorted(places)


def test_whose_scripts_are_in_a_page_has_a_licence_there() -> None:
    found = dict(licences())
    assert [words.split()[0] for words in found] == ["uPlot", "pako"]
    for words, holder in (("uPlot draws the plots", "Leon Sorokin"),
                          ("pako unpacks the runs", "Vitaly Puzrin")):  # fmt: skip
        assert holder in found[words]
