"""Which process runs a case: this one, one of several, one of its own; a defect of the bench.

Also the garbage collector, which is off in a run.
"""

import gc
import json
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import OTHER, RIG, case_of

from axisrig.bench.campaign import runner
from axisrig.bench.campaign.collector import without_collector
from axisrig.bench.campaign.runner import Limits, run_case, run_cases
from axisrig.bench.machine.live import states
from axisrig.bench.machine.live.pipe import Inlet
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.verdict import Verdict


class Seen:
    """Follows runs."""

    def __init__(self) -> None:
        self.news: list[str] = []

    def began(self, run: str) -> None:
        self.news.append(f"+{run}")

    def ended(self, run: str) -> None:
        self.news.append(f"-{run}")


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Where runs were made; those elsewhere end in the other order."""
    places: list[str] = []

    def here(case: Case, files: Any, _watch: object, hardware: object = None) -> Any:
        places.append(f"here {case.run} {files}{' on hardware' if hardware else ''}")
        return case.run

    def elsewhere(function: object, tasks: Any, **options: Any) -> Any:
        assert function is here
        places.append(f"apart {options['jobs']} {options['is_fresh']} {options['timeout_s']}")
        for number, _ in enumerate(tasks):
            options["news"](number, True)
        for number in reversed(range(len(tasks))):
            options["news"](number, False)
            yield number, tasks[number][0].run

    monkeypatch.setattr(runner, "run_case", here)
    monkeypatch.setattr(runner, "run_as_they_end", elsewhere)
    monkeypatch.setattr(runner, "settings_of", lambda case: case.rig)
    monkeypatch.setattr(runner, "is_paced", lambda rig: rig == RIG)
    return places


CASES = [case_of("a"), case_of("b", OTHER), case_of("c")]
APART = Limits(apart=[OTHER])


NO_LIMITS = Limits()


def run_all(limits: Limits = NO_LIMITS, **options: Any) -> tuple[list[Any], list[str]]:
    seen = Seen()
    found = run_cases(CASES, lambda run: f"<{run}>", limits=limits, follower=seen, **options)  # type: ignore[arg-type, return-value]
    return list(found), seen.news


def test_one_process_runs_cases_here_and_foreign_rigs_apart(ran: list[str]) -> None:
    found, news = run_all(APART)
    assert found == ["p-a", "p-b", "p-c"]
    assert ran == ["here p-a <p-a>", "apart 1 [True] None", "here p-c <p-c>"]
    assert news == ["+p-a", "+p-b", "-p-b", "+p-c"]


@pytest.mark.parametrize(
    ("limits", "jobs"), [(APART, 2), (Limits(timeout_s=5.0), 1), (Limits(timeout_s=5.0), 2)]
)
def test_several_processes_or_a_time_out_run_all_elsewhere(
    limits: Limits, jobs: int, ran: list[str]
) -> None:
    found, news = run_all(limits, jobs=jobs)
    fresh = [False, bool(limits.apart), False]
    assert ran == [f"apart {jobs} {fresh} {limits.timeout_s}"]
    assert sorted(found) == ["p-a", "p-b", "p-c"]
    assert news == ["+p-a", "+p-b", "+p-c", "-p-c", "-p-b", "-p-a"]


def test_on_hardware_all_with_a_real_bus_run_here_until_the_operator_stops(ran: list[str]) -> None:
    """A foreign rig without one is apart all the same."""
    stops = iter([False, True])
    hardware: Any = SimpleNamespace(stop=lambda: next(stops))
    limits = Limits(apart=[RIG, OTHER])
    found, _ = run_all(limits, hardware=hardware, jobs=1)
    assert ran == ["here p-a <p-a> on hardware", "apart 1 [True] None",
                   "here p-c <p-c> on hardware"]  # fmt: skip
    assert found == ["p-a", "p-b", "p-c"]
    ran.clear()
    stops = iter([True])
    assert run_all(Limits(), hardware=hardware)[0] == ["p-a"]


def test_a_case_needs_a_process_of_its_own_by_its_rig_or_a_time_out() -> None:
    assert [APART.is_apart(case) for case in CASES] == [False, True, False]
    assert all(Limits(timeout_s=1.0).is_apart(case) for case in CASES)


@pytest.mark.parametrize(
    ("error", "is_raised"),
    [(ValueError("odd"), False), (OSError(28, "full"), True), (OSError(2, "none"), False)],
)
def test_a_defect_costs_its_own_row_and_a_full_disk_the_campaign(
    error: Exception, is_raised: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(*_: object) -> None:
        raise error

    times = iter([10.0, 12.5])
    monkeypatch.setattr(runner, "_run_case", breaks)
    if is_raised:
        with pytest.raises(OSError, match="full"):
            run_case(case_of("a"), runner.RunFiles(), lambda: next(times))
        return
    result = run_case(case_of("a"), runner.RunFiles(), lambda: next(times))
    assert result.verdict is Verdict.ERROR
    assert result.error is not None
    assert result.error.startswith(f"defect of the bench: {type(error).__name__}: ")
    assert result.wall_s == 2.5
    assert any("breaks" in line for line in result.log)


@pytest.mark.parametrize("was_enabled", [True, False])
@pytest.mark.parametrize("breaks_off", [True, False])
def test_the_garbage_collector_is_after_a_run_as_it_was_before(
    was_enabled: bool, breaks_off: bool
) -> None:
    before = gc.isenabled()
    (gc.enable if was_enabled else gc.disable)()
    try:
        with without_collector():
            assert not gc.isenabled()
            with without_collector():
                assert not gc.isenabled()
            assert not gc.isenabled()  # the inner one has found it switched off
            if breaks_off:
                raise KeyError
    except KeyError:
        assert breaks_off
    finally:
        now = gc.isenabled()
        (gc.enable if before else gc.disable)()
    assert now is was_enabled


@pytest.mark.skipif(os.name != "posix", reason="pipes")
@pytest.mark.interpreted
def test_a_live_state_says_which_row_of_which_plan_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Files are named as in the plan, from its folder."""
    monkeypatch.setattr(states, "state_of", lambda _: {"time_ns": 5})
    plans = tmp_path / "plans"
    case = case_of(
        "a", line=7, title="short way", folder=plans, file=plans / "below.csv",
        program=plans / "nc" / "part.nc",
    )  # fmt: skip
    inlet = Inlet(tmp_path / "pipe")
    try:
        about = {"run": "p-a", "rig": "rigs/z.toml"}
        onlooker = runner._live(case, tmp_path / "pipe", about)
        machine: Any = None
        onlooker(machine)
        assert inlet.take() is None  # nobody has asked
        inlet.ask()
        onlooker(machine)
        sent = inlet.take()
    finally:
        inlet.close()
    assert sent is not None
    assert json.loads(sent) == {
        **about, "plan": "p", "row": "below.csv:7", "title": "short way", "program": "nc/part.nc",
        "time_ns": 5,
    }  # fmt: skip
