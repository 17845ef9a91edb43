"""The side view of a tool in a real browser: drawn, moved by slider, plots and keys, readable."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.reports import tilted
from tests.reports.browsing import mouse
from tests.reports.formulas import write_runs
from tests.reports.test_axe import LEVELS, axe_file
from tests.tools.chromium import MISSING, Browser, chromium

from axisrig.reports.build import build_report

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(chromium() is None, reason=MISSING),
]

RUN = "tool-ecs"
SVGS = "[...document.querySelectorAll('.tv-svg')]"
OUTPUT = "document.querySelector('.tv output').textContent"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("side")
    traces = {"ecs": tilted.trace(), "chain": tilted.trace(has_sensor=False)}
    left = dict.fromkeys(traces, tilted.left())
    return build_report(write_runs(folder, "tool", traces, left), findings=tilted.found)


@pytest.fixture(scope="module")
def wide() -> Iterator[Browser]:
    with Browser() as browser:
        yield browser


@pytest.fixture
def page(wide: Browser, report: Path) -> Browser:
    """The page with the run open, nothing noted yet."""
    wide.open(report.parent)
    wide.errors.clear()
    wide.open(report, f"#open={RUN}")
    return wide


def box(page: Browser, selector: str) -> list[float]:
    found = page.run(
        f"(() => {{ const b = document.querySelector('{selector}').getBoundingClientRect();"
        " return [b.left, b.top, b.width, b.height]; })()"
    )
    return list(found)


def slide(page: Browser, row: int) -> None:
    page.run(
        f"(() => {{ const s = document.querySelector('.tv input'); s.value = {row};"
        " s.dispatchEvent(new Event('input', { bubbles: true })); })()"
    )


def test_tool_surface_and_contours_are_drawn_in_equal_scales(page: Browser) -> None:
    assert page.run(f"{SVGS}.length") == 2
    for kind in ("clamp", "tcp", "programmed", "surface", "deep", "cut", "beam", "head"):
        assert page.run(f"document.querySelector('.tv-side .tv-{kind}').getBBox().width") > 0
    # At 35 degrees the tool is 80 sin 35 wide and 80 cos 35 high, on the screen too
    width, height = box(page, ".tv-side .tv-beam")[2:]
    assert width / height == pytest.approx(0.7002, rel=0.02)
    assert page.errors == []


def test_the_slider_moves_the_tool_and_the_cursor_of_the_plots(page: Browser) -> None:
    assert "tilt 35.0000°" in page.run(OUTPUT)
    slide(page, 0)
    assert page.run(OUTPUT).startswith("t 50.0 ms · tilt 0.0000° · L2 80.0000 mm")
    assert page.run("document.querySelector('.tv input').getAttribute('aria-valuetext')") == (
        "50.0 ms"
    )
    last = page.run("Number(document.querySelector('.tv input').max)")
    slide(page, last // 2)
    page.run("new Promise((done) => setTimeout(done, 100))")
    answer = page.run(OUTPUT)
    legend = page.run("document.querySelector('.opened .u-legend').textContent")
    time = answer.split(" ms")[0].removeprefix("t ").removesuffix(".0")
    assert f"{time} ms" in legend
    assert page.errors == []


def test_the_cursor_of_a_plot_moves_the_tool(page: Browser) -> None:
    page.run("document.querySelector('.opened .u-over').scrollIntoView({ block: 'center' })")
    left, top, width, height = box(page, ".opened .u-over")
    for share, begins in ((0.2, "t 1"), (0.9, "t 6")):
        mouse(page, "mouseMoved", left + share * width, top + height / 2, 0)
        assert page.run(OUTPUT).startswith(begins), page.run(OUTPUT)
    assert page.errors == []


def test_projections_are_buttons_and_one_is_pressed(page: Browser) -> None:
    buttons = "[...document.querySelectorAll('.tv-views button')]"
    names = page.run(f"{buttons}.map((b) => b.textContent)")
    assert names == ["plane of the tilt", "along the path", "X-Z", "Y-Z", "X-Y"]
    for number in range(len(names)):
        page.run(f"{buttons}[{number}].click()")
        pressed = page.run(f"{buttons}.map((b) => b.getAttribute('aria-pressed'))")
        assert pressed == ["true" if n == number else "false" for n in range(len(names))]
    label = page.run(f"{SVGS}[0].getAttribute('aria-label')")
    assert label == "Tool from the side, Y in mm over X in mm"
    assert page.errors == []


def test_it_plays_and_stops(page: Browser) -> None:
    slide(page, 0)
    page.run("document.querySelector('.tv-play').click()")
    page.run("new Promise((done) => setTimeout(done, 400))")
    page.run("document.querySelector('.tv-play').click()")
    first = page.run(OUTPUT)
    assert not first.startswith("t 50.0 ms")
    page.run("new Promise((done) => setTimeout(done, 200))")
    assert page.run(OUTPUT) == first
    assert page.errors == []


def test_without_a_sensor_the_tool_has_no_surface(wide: Browser, report: Path) -> None:
    wide.open(report.parent)
    wide.errors.clear()
    wide.open(report, "#open=tool-chain")
    assert wide.run("document.querySelector('.tv-side .tv-tcp').getBBox().width") > 0
    assert wide.run("document.querySelectorAll('.tv-side .tv-surface[d]').length") <= 1
    assert "beam ends" not in wide.run(OUTPUT)
    assert wide.errors == []


def test_in_a_window_of_400_px_the_view_is_as_wide_as_the_window(report: Path) -> None:
    with Browser((400, 900)) as narrow:
        narrow.open(report, f"#open={RUN}")
        left, _, width, _ = box(narrow, ".tv")
        assert left >= 0
        assert left + width <= 400
        assert narrow.run("document.documentElement.scrollWidth") <= 400
        assert box(narrow, ".tv-side .tv-svg")[2] > 250
        assert narrow.errors == []


@pytest.mark.skipif(axe_file() is None, reason="no axe-core here: npm install axe-core, NODE_PATH")
@pytest.mark.parametrize("is_dark", [False, True], ids=["light", "dark"])
def test_axe_finds_nothing(page: Browser, *, is_dark: bool) -> None:
    path = axe_file()
    assert path is not None
    page.dark(is_dark)
    try:
        page.run("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
        page.run(path.read_text(encoding="utf-8") + "\n;0")
        found = page.run(
            f"axe.run(document, {{ runOnly: {LEVELS} }})"
            ".then((r) => r.violations.map((v) => [v.id, v.nodes.map((n) => n.html)]))"
        )
    finally:
        page.dark(False)
    assert found == []


def test_dark_colours_are_others(page: Browser) -> None:
    def colour() -> str:
        return str(
            page.run("getComputedStyle(document.querySelector('.tv-side .tv-clamp')).stroke")
        )

    light = colour()
    page.dark(True)
    try:
        assert colour() != light
    finally:
        page.dark(False)
