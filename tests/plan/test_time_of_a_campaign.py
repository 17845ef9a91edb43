"""What a campaign says of its time and its runs: in its manifest, on the way, and to a cluster."""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign import campaign
from axisrig.bench.campaign.progress import CampaignProgress, Watch
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.talk import Manner
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.verdict import Verdict

PLAN = """\
case,program,rig,repeats,check:mean(latch_error_um)
one,a.nc,r.toml,,
several,a.nc,r.toml,2,<= 1
last,a.nc,r.toml,,
"""
PLAIN = "case,program,rig\n" + "".join(f"r{n},a.nc,r.toml\n" for n in range(4))


class Clock:
    """A stopwatch that goes on only where a test lets it."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s

    def passes(self, seconds: float) -> Callable[..., tuple[()]]:
        def spend(*_: Any) -> tuple[()]:
            self.now_s += seconds
            return ()

        return spend


@pytest.fixture
def clock() -> Clock:
    return Clock()


Call = Callable[..., campaign.Campaign]


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, clock: Clock) -> Call:
    """A campaign whose runs pass without being run, each in 0.5 s."""
    (tmp_path / "a.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "r.toml").write_text("[machine]\n", encoding="utf-8")
    plan = tmp_path / "p.csv"

    def running(cases: Sequence[Case], *_: object, **__: object) -> Iterator[CaseResult]:
        for case in cases:
            clock.passes(0.5)()
            checks = [judge(check, ()) for check in case.checks]
            yield CaseResult(case, Verdict.PASS, checks, wall_s=float(case.case[-1] == "2"))

    monkeypatch.setattr(campaign, "_prepared", lambda *_: ((), []))
    monkeypatch.setattr(campaign, "run_cases", running)
    monkeypatch.setattr(campaign, "depends_sha256", lambda case: case.run)
    monkeypatch.setattr(campaign, "real_cases", lambda _: [])

    def made(text: str = PLAN, jobs: int = 1, **more: Any) -> campaign.Campaign:
        plan.write_text(text, encoding="utf-8")
        known: dict[str, Any] = {"select": campaign.Choice(), "stopwatch": clock}
        return campaign.run_campaign(
            [plan], out=tmp_path / "out", jobs=jobs, timeout_s=None, assignments=[], command=[],
            started="", **{**known, **more},
        )  # fmt: skip

    return made


def manifest_of(made: campaign.Campaign) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((made.folder / "manifest.json").read_text(encoding="utf-8"))
    return found


def test_the_time_of_a_call_has_all_from_reading_the_plans_to_the_last_run(
    call: Call, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reading, hashing and preparing are a part of it; the report comes after the manifest."""
    read = campaign._read

    def slowly(*given: Any) -> Any:
        clock.passes(1.0)()
        return read(*given)

    def prepared(*_: Any) -> Any:
        clock.passes(4.0625)()
        return (), []

    def report(folder: Path) -> Path:
        clock.passes(8.0)()
        return folder / "report.html"

    monkeypatch.setattr(campaign, "_read", slowly)
    monkeypatch.setattr(campaign, "_prepared", prepared)
    made = call(build_report=report)
    # 1 s + 4.0625 s + 4 runs of 0.5 s, in ms as every time of the manifest
    assert manifest_of(made)["spent_s"] in (7.062, 7.063)
    assert made.spent_s == 15.0625


@pytest.mark.parametrize("jobs", [1, 3])
def test_the_time_of_a_call_is_given_with_its_processes(call: Call, jobs: int) -> None:
    found = manifest_of(call(jobs=jobs))
    assert (found["spent_s"], found["jobs"]) == (2.0, jobs)


def test_a_short_call_has_its_milliseconds(
    call: Call, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    def prepared(*_: Any) -> Any:
        clock.passes(0.0123)()
        return (), []

    monkeypatch.setattr(campaign, "_prepared", prepared)
    monkeypatch.setattr(campaign, "run_cases", lambda *_, **__: (one for one in ()))
    assert manifest_of(call())["spent_s"] == 0.012


def test_a_stopwatch_that_stands_still_gives_no_time(call: Call) -> None:
    """As under a test: nobody has measured 0 s."""
    made = call(stopwatch=lambda: 7.0)
    assert {"spent_s", "jobs"}.isdisjoint(manifest_of(made))
    assert made.spent_s == 0.0


@pytest.mark.parametrize(
    ("text", "begin", "end"),
    [
        (PLAN, "0/5 rows", "5/5 rows, 4 pass, 1 inconclusive"),
        (PLAIN, "0/4 runs", "4/4 runs, 4 pass"),
    ],
)
def test_the_progress_counts_runs_and_rows_of_statistics(
    call: Call, clock: Clock, text: str, begin: str, end: str
) -> None:
    """Four runs and the mean over two of them are five rows; a plan without one has runs."""
    states: list[str] = []
    shown: list[CampaignProgress] = []

    def beside(progress: CampaignProgress) -> AbstractContextManager[object]:
        states.append(progress.state)
        shown.append(progress)
        return nullcontext()

    call(text, watch=Watch(beside), manner=Manner())
    assert states == [begin]
    assert shown[0].state.startswith(f"{end}, ")


@pytest.mark.parametrize(
    ("jobs", "scheduler", "order"),
    [
        (1, None, "0123"),
        (2, None, "2013"),
        (1, "tcp://127.0.0.1:8786", "2013"),
        (3, "tcp://127.0.0.1:8786", "2013"),
    ],
)
def test_runs_that_take_longest_go_first_to_several_processes_and_to_a_cluster(
    call: Call, monkeypatch: pytest.MonkeyPatch, jobs: int, scheduler: str | None, order: str
) -> None:
    """By what the folder has of an earlier call; one process takes them as the plan has them."""
    call(PLAIN)
    asked: list[str] = []

    def handed_out(cases: Sequence[Case], *_: object, **__: object) -> Iterator[CaseResult]:
        asked.extend(case.case for case in cases)
        yield from (CaseResult(case, Verdict.PASS, []) for case in cases)

    monkeypatch.setattr(campaign, "run_cases", handed_out)
    monkeypatch.setattr(campaign, "run_on_cluster", handed_out)
    made = call(PLAIN, jobs, select=campaign.Choice(scheduler=scheduler))
    assert asked == [f"r{n}" for n in order]
    assert [one.case.case for one in made.results] == ["r0", "r1", "r2", "r3"]
