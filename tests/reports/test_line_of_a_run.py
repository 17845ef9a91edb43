"""What the report of runs on EtherCAT shows of their line, in a real browser."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.reports.browsing import open_run
from tests.tools.chromium import MISSING, Browser, chromium
from typer.testing import CliRunner

from axisrig.bench.cli.main import app

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(chromium() is None, reason=MISSING),
]
ROOT = Path(__file__).parents[2] / "testplans"
HEAD = "case,program,rig,plc:V.E.FEED,inputs,check:alarms"
ROWS = {
    "quiet": ("", "none"),
    "counters": ("fault:line_unanswered=ec1 at=motion+20ms count=2", "none"),
    "fallen": ("fault:slave_falls=Z at=motion+20ms", "900732"),
}


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The report of three runs."""
    folder = tmp_path_factory.mktemp("line")
    place = f"{ROOT}/programs/probe-z.nc,{ROOT}/rigs/probe-z-ethercat.toml,3000"
    rows = [f"{case},{place},{fault},{alarms}" for case, (fault, alarms) in ROWS.items()]
    (folder / "plan.csv").write_text("\n".join([HEAD, *rows, ""]), encoding="utf-8")
    words = ["run", str(folder / "plan.csv"), "-o", str(folder / "out"), "-j", "1"]
    got = CliRunner().invoke(app, words)
    assert got.exit_code == 0, got.output
    with Browser() as browser:
        browser.open(folder / "out" / "report.html")
        yield browser
        assert browser.errors == []


@pytest.mark.parametrize(
    ("case", "counter", "state", "bad"),
    [
        ("quiet", "3, another one in 0 frames", "OP", 0),
        ("counters", "3, another one in 2 frames, 2 in a row", "OP", 1),
        ("fallen", "3, another one in 0 frames", "SAFEOP", 1),
    ],
)
def test_an_opened_run_has_cycle_working_counter_and_al_state(
    page: Browser, case: str, counter: str, state: str, bad: int
) -> None:
    run = f"plan-{case}"
    open_run(page, run)
    table = f"document.querySelector('[data-run=\"{run}\"] .line')"
    cells = page.run(f"[...{table}.rows].map((r) => [...r.cells].map((c) => c.innerText))")
    found = dict(cells)
    assert page.run(f"{table}.caption.innerText") == "EtherCAT ec1"
    assert page.run(f"{table}.offsetHeight > 0")
    assert found["cycle"].startswith("1000 µs, of it the frame ")
    assert found["cyclic frames"].endswith(", not back 0")
    assert found["working counter"] == counter
    assert found["Z: AL state"].startswith(state)
    assert page.run(f"{table}.querySelectorAll('.bad').length") == bad
