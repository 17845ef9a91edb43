"""What axe finds in a report in a real browser, with everything open, light and dark."""

import os
from pathlib import Path
from typing import Any

import pytest
from tests.reports.browsing import HOSTILE, open_run, shown
from tests.reports.swept import GRID, searched, wide
from tests.reports.swept import folder as folder_of
from tests.tools.chromium import MISSING, Browser, chromium

from axisrig.reports.build import build_report

LEVELS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]


def axe_file() -> Path | None:
    """`axe.min.js` of the npm package axe-core, where it is installed."""
    folders = os.environ.get("NODE_PATH", "").split(os.pathsep)
    paths = [Path(folder) / "axe-core" / "axe.min.js" for folder in folders if folder]
    return next((path for path in paths if path.is_file()), None)


pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(chromium() is None, reason=MISSING),
    pytest.mark.skipif(
        axe_file() is None, reason="no axe-core here: npm install axe-core, NODE_PATH"
    ),
]


def violations(page: Browser, *, is_dark: bool) -> list[Any]:
    """What axe finds with everything open."""
    path = axe_file()
    assert path is not None
    page.dark(is_dark)
    try:
        for run in shown(page):
            open_run(page, run)
        page.run("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
        page.run(path.read_text(encoding="utf-8") + "\n;0")
        found = page.run(
            f"axe.run(document, {{ runOnly: {LEVELS} }})"
            ".then((r) => r.violations.map((v) => [v.id, v.nodes.map((n) => n.html)]))"
        )
    finally:
        page.dark(False)
    return list(found)


@pytest.mark.parametrize("is_dark", [False, True], ids=["light", "dark"])
def test_axe_finds_nothing_with_every_plot_drawn(page: Browser, *, is_dark: bool) -> None:
    assert violations(page, is_dark=is_dark) == []


def test_axe_finds_nothing_in_sweeps_searches_and_sensitivity(
    browser: Browser, tmp_path: Path
) -> None:
    grid = [
        ((a, b, HOSTILE.replace('"', "'").replace(",", ";") if c == "NEG" else "&"), float(a), word)
        for (a, b, c), word in zip(GRID, ["pass", "fail", "inconclusive"] * 4, strict=True)
    ]
    two = [("c", a, b, float(b), "pass") for a, b, _ in GRID]
    for name in ("two", "grid", "search"):
        (tmp_path / name).mkdir()
    for place in (
        folder_of(tmp_path / "two", two),
        wide(tmp_path / "grid", grid),
        searched(tmp_path / "search", ("300", "325")),
    ):
        build_report(place)
        browser.open(tmp_path)
        browser.errors.clear()
        browser.open(place / "report.html")
        assert browser.run("document.querySelectorAll('main img, main script').length") == 0
        assert [violations(browser, is_dark=is_dark) for is_dark in (False, True)] == [[], []]
        assert browser.errors == []
