"""Results of a runner where a process has died, and the files of the probes of a search."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.campaign import runner
from axisrig.bench.campaign.processes import Died
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import Limits, run_case, run_cases
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.expectation import EXPECTED, NOT_MET
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.bus import BusFigures
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS


def case_of(run: str, rig: str = "r.toml", line: int = 2, **more: Any) -> Case:
    return Case("p", run, f"p-{run}", 0, Path("a.nc"), Path(rig), {}, (), "", (), "", 1, 0,
                Path("p.csv"), line, {}, **more)  # fmt: skip


def test_what_dies_is_an_error_of_its_row_with_the_time_of_a_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def run_as_they_end(_function: object, _tasks: object, **_: object) -> Any:
        yield 1, Died("it hung", is_timeout=True, log=["a line"])
        yield 0, Died("it crashed")
        yield 2, "a result"

    monkeypatch.setattr(runner, "run_as_they_end", run_as_they_end)
    cases = [case_of(run) for run in "abc"]
    hung, crashed, good = run_cases(cases, lambda _: RunFiles(), 2, Limits(timeout_s=7.0))
    assert (hung.case.run, hung.verdict, hung.error, hung.wall_s, hung.log) == (
        "p-b", Verdict.ERROR, "it hung", 7.0, ["a line"],
    )  # fmt: skip
    assert (crashed.case.run, crashed.error, crashed.wall_s) == ("p-a", "it crashed", 0.0)
    assert good == "a result"


def test_probes_of_a_search_get_their_own_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """One more than there are places runs without."""
    ran: list[Any] = []
    times = iter([1.0, 2.0, 3.0, 4.0, 9.0])

    def run_search(case: Case, run: Any) -> Any:
        for number in (1, 2, 3):
            run(case_of(f"{case.case}-s0{number}"))
        return SimpleNamespace(wall_s=0.0)

    monkeypatch.setattr(runner, "run_search", run_search)
    monkeypatch.setattr(
        runner, "_run_case", lambda case, files, *_: ran.append((case.run, files.trace))
    )
    places = [RunFiles(trace=Path(f"{n}.parquet")) for n in (1, 2)]
    search: Any = SimpleNamespace()
    result = run_case(case_of("s", search=search), RunFiles(probes=places), lambda: next(times))
    assert ran == [("p-s-s01", Path("1.parquet")), ("p-s-s02", Path("2.parquet")),
                   ("p-s-s03", None)]  # fmt: skip
    assert result.wall_s == 8.0


@pytest.mark.parametrize(
    ("limits", "expected", "is_stopped", "verdict"),
    [
        (("<= 1", "<= 90"), (), False, Verdict.PASS),
        (("<= 0.001", "<= 90"), (), False, Verdict.FAIL),
        (("<= 0.001", "<= 90"), ("duration_s",), False, Verdict.PASS),
        (("<= 1", "<= 90"), ("duration_s",), False, Verdict.FAIL),
        (("<= 0.001", "<= 90"), ("duration_s", "bus_load_pct"), False, Verdict.FAIL),
        (("<= 1", "<= 90"), (), True, Verdict.ABORTED),
    ],
)
def test_a_run_is_judged_by_its_checks_and_by_what_was_expected_of_it(
    limits: tuple[str, str], expected: tuple[str, ...], is_stopped: bool, verdict: Verdict,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Of 5 ms, on a bus with a load of 30 %."""
    bus = BusFigures("can1", 1_000_000, 30.0, 30.0, 30.0, 10, 0, "", (), ())
    left = facts(buses=(bus,), is_stopped=is_stopped)
    series = kept(pa.table({"time_ns": np.arange(5) * MS}))
    monkeypatch.setattr(runner, "_left_by", lambda *_: (left, series, 0.25))
    names = ("duration_s", "bus_load_pct")
    checks = tuple(parse_check(*one, "p.csv:2") for one in zip(names, limits, strict=True))
    times = iter([10.0, 12.5])
    case = replace(case_of("a"), checks=checks, expected=expected)
    result = run_case(case, RunFiles(), lambda: next(times))
    assert (result.verdict, result.wall_s, result.loop_s) == (verdict, 2.5, 0.25)
    assert [check.value for check in result.checks] == [0.005, 30.0]
    notes = [check.note.partition(";")[0] for check in result.checks]
    for name, note, check in zip(names, notes, result.checks, strict=True):
        words = EXPECTED if check.verdict is Verdict.FAIL else NOT_MET
        assert (note == words) is (name in expected)
    assert result.error == (STOPPED if is_stopped else None)
    assert result.facts is left


def test_a_run_gives_the_values_of_a_metric_of_the_user_to_the_statistics_of_its_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a.nc", "r.toml"):
        (tmp_path / name).touch()
    own = "def metric_width(recording):\n    return 2.5, 'mm', 0.125\n"
    (tmp_path / "own.py").write_text(own, encoding="utf-8")
    text = "case,program,rig,module,repeats,check:mean(width)\na,a.nc,r.toml,own.py,2,<= 3\n"
    (tmp_path / "p.csv").write_text(text, encoding="utf-8")
    series = kept(pa.table({"time_ns": np.arange(5) * MS}))
    monkeypatch.setattr(runner, "_left_by", lambda *_: (facts(), series, 0.25))
    cases = read_plan(tmp_path / "p.csv").cases
    assert len(cases) == 2
    for case in cases:
        result = run_case(case, RunFiles())
        (reading,) = result.samples["mean(width)"]
        assert (reading.metric.value, reading.metric.uncertainty) == (2.5, 0.125)


@pytest.mark.parametrize(("named", "written"), [("", "rigs/r.toml"), ("other.toml", "other.toml")])
def test_a_recording_names_its_run_and_its_rig(
    monkeypatch: pytest.MonkeyPatch, named: str, written: str
) -> None:
    """The rig from the folder of the plan on, or as the results folder calls it."""
    asked: list[Any] = []

    def writer(file: Path, about: Any, *, holds: bool) -> Any:
        asked.append((file, about, holds))
        raise UserError("that is enough")

    monkeypatch.setattr(runner, "recall", lambda _: ("settings", "program"))
    monkeypatch.setattr(runner, "SeriesWriter", writer)
    case = replace(case_of("a"), rig=Path("plans/rigs/r.toml"), folder=Path("plans"))
    files = RunFiles([], Path("t.parquet"), rig=named)
    assert run_case(case, files).error == "that is enough"
    assert asked == [(Path("t.parquet"), {"run": "p-a", "rig": written}, True)]
