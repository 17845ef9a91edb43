"""The page of `run --live` in a real browser: headless Chromium, states written by the test."""

import json
import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.live_states import AXIS, DISTANCE, LINE, REAL_TIME, SEGMENT, state
from tests.tools.chromium import MISSING, Browser, chromium

from axisrig.bench.cli.beside.feed import Look
from axisrig.bench.cli.beside.server import serving

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(chromium() is None, reason=MISSING),
]

HOSTILE = """</script><script>document.title = "taken"</script><img src=x onerror="alert(1)">"' ä"""
_LEVELS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
PROGRESS: dict[str, Any] = {
    "state": "2/9 runs, 1 pass, 1 fail, 0.2 runs/s, 35 s left; running: plan-a for 3 s",
    "count": 9,
    "done": 2,
    "spent_s": 10.0,
    "verdicts": [
        {"verdict": "pass", "glyph": "✔", "runs": 1},
        {"verdict": "fail", "glyph": "✘", "runs": 1},
    ],
    "ended": [
        {"run": "plan-x", "verdict": "pass", "glyph": "✔"},
        {"run": "plan-y", "verdict": "fail", "glyph": "✘"},
    ],
}


class Shown:
    """A feed that shows what the test says."""

    def __init__(self) -> None:
        self.has_ended = False
        self._number, self._look = 0, Look(0, None, "", 0.0, None, PROGRESS)
        self._new = threading.Condition()

    def say(self, age_s: float = 0.0, factor: float | None = 9.5, **changes: Any) -> None:
        said = state(**changes)
        with self._new:
            self._number += 1
            self._look = Look(self._number, said, json.dumps(said), age_s, factor, PROGRESS)

    def look(self) -> Look:
        with self._new:
            return self._look

    def pause(self) -> bool:
        time.sleep(0.01)
        return self.has_ended

    def end(self) -> None:
        self.has_ended = True


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as browser:
        yield browser


@pytest.fixture
def shown() -> Shown:
    return Shown()


@pytest.fixture
def page(browser: Browser, shown: Shown) -> Iterator[Browser]:
    with serving(shown) as address:  # type: ignore[arg-type]
        browser.errors.clear()
        browser.requested.clear()
        browser.go(address)
        yield browser


def text(page: Browser, selector: str) -> str:
    return str(page.run(f"document.querySelector({json.dumps(selector)}).innerText"))


def wait(page: Browser, expression: str, value: object = True) -> None:
    """Wait until an expression of the page has a value."""
    found: object = None
    for _ in range(200):
        found = page.run(expression)
        if found == value:
            return
        time.sleep(0.02)
    pytest.fail(f"{expression} is {found!r}, not {value!r}")


SEEN = "document.getElementById('run').textContent"


def test_it_waits_for_a_run_and_asks_for_nothing_but_states(page: Browser, shown: Shown) -> None:
    wait(page, "document.getElementById('campaign').textContent !== ''")
    assert text(page, "h1") == "waiting for a run"
    assert page.run("document.getElementById('main').hidden")
    assert text(page, "#campaign") == "2/9 runs, 1 pass, 1 fail, 0.2 runs/s, 35 s left"
    shown.say()
    wait(page, SEEN, "plan-a")
    begin = page.requested[0]
    assert page.requested == [begin, f"{begin}states"]
    assert page.errors == []


def test_what_a_commissioning_engineer_looks_for_is_there(page: Browser, shown: Shown) -> None:
    turning = {**AXIS, "axis": "C", "unit": "°", "drive": "fault", "is_outside": True}
    shown.say(
        axes=[AXIS, turning],
        distance=[DISTANCE],
        real_time=REAL_TIME,
        alarms=["alarm 50052: ..."],
        messages=["V.A.MESS.Z=100.0"],
        bus=[
            SEGMENT,
            {**SEGMENT, "segment": "can2", "is_outside": True, "lost": "cable out"},
            {**SEGMENT, "segment": "ec1", "counters": [], "line": LINE},
        ],
    )
    wait(page, SEEN, "plan-a")
    seen = text(page, "body")
    for part in (
        *("one touch", "row plan.csv:2, rig rigs/r.toml, program programs/p.nc"),
        *("running", "2.000 s", "9.50", "N20 G100 Z80 F600"),
        "waits for the end of its move to Z 80 mm with 600 mm/min",
        *("99.7503 mm", "99.5000 mm", "−250.3 µm", "operation enabled", "armed", "moving"),
        "100.0001 mm, line 4, block N20, 1.250000 s",
        *("99.7503 °", "−250.3 m°", "fault, real drive"),
        *("active const dist, dry run", "0.1250 mm offset", "SET_DIST 1.2500 mm", "−1.5000 mm"),
        *("41.3 %", "12 345", "cnc: error passive, TEC 136, REC 0", "can2, real bus"),
        "cycle 1000 µs, frame 10.08 µs; working counter 6, wrong in 2 of 1 998; X OP; Z SAFEOP",
        *("lost: cable out", "1.769448", "alarm 50052: ...", "V.A.MESS.Z=100.0"),
        "real time: 7 of the last 500 SYNCs more than 100 us late, 812 us at most",
        *("✔ pass plan-x", "✘ fail plan-y"),
    ):
        assert part in seen, part
    assert page.run("document.title") == "plan-a · axisrig live"
    assert page.errors == []


def test_plots_grow_with_the_states_and_begin_anew_with_a_run(page: Browser, shown: Shown) -> None:
    points = "document.querySelector('.line-actual').getAttribute('points').split(' ').length"
    for number in range(1, 6):
        actual = 100.0 - number
        shown.say(time_ns=number * 100_000_000, axes=[{**AXIS, "actual": actual}])
        wait(page, "document.querySelector('.big')?.innerText", f"{actual:.4f} mm")
    wait(page, points, 5)
    shown.say(run="plan-b", time_ns=0)
    wait(page, SEEN, "plan-b")
    wait(page, points, 1)
    assert page.errors == []


def test_an_old_state_a_lost_connection_and_the_end_are_said(page: Browser, shown: Shown) -> None:
    shown.say()
    wait(page, SEEN, "plan-a")
    assert page.run("document.getElementById('notice').hidden")
    shown.say(age_s=4.0)
    wait(page, "document.getElementById('notice').textContent.startsWith('No new state')")
    shown.end()
    wait(page, "document.body.classList.contains('has-ended')")
    assert text(page, "#notice").startswith("The campaign has ended.")
    assert page.errors == []


def test_hostile_text_stays_text(page: Browser, shown: Shown) -> None:
    shown.say(
        title=HOSTILE, block_text=HOSTILE, messages=[HOSTILE], alarms=[HOSTILE], run=HOSTILE,
        waits_for=HOSTILE, axes=[{**AXIS, "axis": HOSTILE}], distance=[{**DISTANCE, "axis": "<b>"}],
        probes=[{"probe": HOSTILE, "level": True, "edges": 1, "edge_ns": None}],
        bus=[{**SEGMENT, "segment": HOSTILE, "lost": HOSTILE}],
    )  # fmt: skip
    wait(page, SEEN, HOSTILE)
    assert page.run("document.querySelectorAll('body img, body b:not(.tile b)').length") == 0
    assert page.run("document.title") == f"{HOSTILE} · axisrig live"
    assert page.errors == []
    assert len(page.requested) == 2


def _axe() -> Path | None:
    """`axe.min.js` of the npm package axe-core, where it is installed."""
    folders = os.environ.get("NODE_PATH", "").split(os.pathsep)
    paths = [Path(folder) / "axe-core" / "axe.min.js" for folder in folders if folder]
    return next((path for path in paths if path.is_file()), None)


@pytest.mark.skipif(_axe() is None, reason="no axe-core here: npm install axe-core, NODE_PATH")
@pytest.mark.parametrize("is_dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("age_s", [0.0, 9.0], ids=["new", "old"])
def test_axe_finds_nothing(page: Browser, shown: Shown, *, is_dark: bool, age_s: float) -> None:
    path = _axe()
    assert path is not None
    page.dark(is_dark)
    bad = {**AXIS, "axis": "C", "drive": "fault"}
    try:
        shown.say(
            age_s=age_s, axes=[AXIS, bad], distance=[DISTANCE], real_time=REAL_TIME, alarms=["x"],
            messages=["y"],
        )  # fmt: skip
        wait(page, SEEN, "plan-a")
        page.run(path.read_text(encoding="utf-8") + "\n;0")
        found = page.run(
            f"axe.run(document, {{ runOnly: {_LEVELS} }})"
            ".then((r) => r.violations.map((v) => [v.id, v.nodes.map((n) => n.html)]))"
        )
    finally:
        page.dark(False)
    assert found == []
