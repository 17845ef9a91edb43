"""Who runs a case, what is kept of it, how a process ended: with stand-ins for runs and clocks."""

import hashlib
import os
import signal
import sys
from contextlib import nullcontext
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import (
    hardware_runs,
    preparing,
    processes,
    replay,
    runner,
    single,
    worker,
)
from axisrig.bench.campaign.channel import ChannelError
from axisrig.bench.campaign.hardware_runs import Outside, allow, real_cases, refuse_processes
from axisrig.bench.campaign.preparing import Prepared, forget, recall
from axisrig.bench.campaign.processes import Died, do_apart
from axisrig.bench.campaign.results import manifest
from axisrig.bench.campaign.results.build_info import hash_of_sources
from axisrig.bench.campaign.results.manifest import other_files
from axisrig.bench.campaign.runner import Limits, run_case, run_cases
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.reading.families import read_segment
from axisrig.kernel.cosim.fmi.journal import LastCall
from axisrig.kernel.errors import UserError

RIG, OTHER = Path("rig.toml"), Path("foreign.toml")


def case_of(run: str, rig: Path = RIG, line: int = 2, **changes: Any) -> Case:
    made = Case("p", run, f"p-{run}", 0, Path("part.nc"), rig, {}, (), "", (), "", 1, 0,
                Path("p.csv"), line, {})  # fmt: skip
    return replace(made, **changes)


# Who runs a case


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


# What is prepared


def test_a_prepared_case_is_known_as_long_as_its_files_are_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    forget()
    program, rig, fmu = (tmp_path / name for name in ("part.nc", "rig.toml", "a.fmu"))
    for path in (program, rig, fmu):
        path.write_text("first", encoding="utf-8")
    case = case_of("a", rig, program=program, inputs={"plc:V.E.A": "1"})
    settings = SimpleNamespace(is_checked=False)
    prepared: Any = Prepared(settings, SimpleNamespace(blocks=[], subprograms={}))  # type: ignore[arg-type]
    monkeypatch.setattr(preparing, "started_files", lambda _: [])
    files = [program, rig, fmu]

    def keep() -> None:
        preparing._keep(case, prepared, files, preparing._content(files))

    assert recall(case) is None
    keep()
    assert recall(case) is prepared
    assert settings.is_checked is True
    for other in (
        {"inputs": {"plc:V.E.A": "2"}}, {"rig": fmu}, {"program": rig}, {"line": 3},
        {"overridden": frozenset({"plc:V.E.A"})},
    ):  # fmt: skip
        assert recall(replace(case, **other)) is None, other
    assert recall(replace(case, title="another")) is prepared
    for path in files:
        text = path.read_text(encoding="utf-8")
        path.write_text("second", encoding="utf-8")
        os.utime(path, ns=(1, 1))
        assert recall(case) is None, path
        path.write_text(text, encoding="utf-8")
        keep()
        assert recall(case) is prepared
    program.unlink()
    assert recall(case) is None
    # One that was written while the case was read is not kept
    preparing._keep(case, prepared, [rig], [b"before"])
    assert recall(case) is None
    forget()


def test_only_so_many_cases_are_kept_the_oldest_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    forget()
    monkeypatch.setattr(preparing, "KEPT_MAX", 2)
    monkeypatch.setattr(preparing, "started_files", lambda _: [])
    cases = [case_of(run, line=line) for line, run in enumerate("abc", start=2)]
    prepared: Any = Prepared(
        SimpleNamespace(is_checked=False),  # type: ignore[arg-type]
        SimpleNamespace(blocks=[], subprograms={}),  # type: ignore[arg-type]
    )
    for case in cases[:2]:
        preparing._keep(case, prepared, [], [])
    recall(cases[0])  # asked last
    preparing._keep(cases[2], prepared, [], [])
    assert [recall(case) is prepared for case in cases] == [True, False, True]
    forget()
    assert recall(cases[0]) is None


# How a process ended


INSIDE = LastCall(3, True, "/x/a.fmu", "z", "fmi3DoStep", 1_500_000)
OUTSIDE = replace(INSIDE, is_inside=False)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize(
    ("code", "call", "words"),
    [
        (None, None, "the process ended before any call into an FMU: it broke off its connection"),
        (3, None, "the process ended before any call into an FMU: exit code 3"),
        (0, OUTSIDE, "the process ended: exit code 0; the last call was fmi3DoStep at t = 1.5000"),
        (
            0,
            INSIDE,
            "FMU /x/a.fmu (plant z) ended the process in fmi3DoStep at t = 1.500000 ms: exit",
        ),
        (
            None,
            INSIDE,
            "FMU /x/a.fmu (plant z) ended the process in fmi3DoStep at t = 1.500000 ms: it",
        ),
        (-11, INSIDE, "crashed in fmi3DoStep at t = 1.500000 ms: SIGSEGV, it reached for memory"),
        (-15, INSIDE, "crashed in fmi3DoStep at t = 1.500000 ms: SIGTERM"),
        (-9, OUTSIDE, "SIGKILL, killed from outside; is the memory of this machine exhausted?; "),
        (-126, None, "signal 126"),
    ],
)
def test_the_end_of_a_process_is_told_with_its_last_call(
    code: int | None, call: LastCall | None, words: str
) -> None:
    assert words in processes._in_words(code, call)
    assert all(hasattr(signal, name) for name in processes._HINTS)


def test_a_call_that_lasts_is_ended_and_a_run_that_lasts_too(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A call counts from when it was first seen; one that came back begins anew."""
    now, call = [100.0], [None]
    monkeypatch.setattr(processes, "time", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(processes, "cut", lambda _: None)
    monkeypatch.setattr(processes, "_printed", lambda _: ["said"])
    monkeypatch.setattr(processes.journal, "last_call", lambda _: call[0])
    crew: Any = SimpleNamespace(timeout_s=50.0, call_limit_s=10.0)
    one: Any = SimpleNamespace(note=tmp_path / "n", began_s=100.0, call_s=100.0, call=0)

    def excess(second: float, last: Any) -> Died | None:
        now[0], call[0] = second, last
        return processes._Crew._excess(crew, one)

    assert excess(109.0, None) is None
    assert excess(115.0, INSIDE) is None  # seen for the first time
    assert excess(124.9, INSIDE) is None
    assert excess(124.9, replace(INSIDE, number=4)) is None  # another call
    assert excess(134.8, replace(INSIDE, number=4)) is None
    assert excess(134.85, replace(OUTSIDE, number=4)) is None  # it has come back
    assert excess(144.8, replace(INSIDE, number=5)) is None
    died = excess(149.5, replace(INSIDE, number=5))
    assert died is None
    died = excess(154.8, replace(INSIDE, number=5))
    assert died is not None
    assert died.is_timeout  # the whole counts first
    crew.timeout_s = None
    died = excess(154.8, replace(INSIDE, number=5))
    assert died is not None
    assert (died.is_timeout, died.log) == (False, ["said"])
    assert died.reason.startswith("a call did not come back within 10 s: it was in fmi3DoStep")
    crew.timeout_s = 50.0
    died = excess(150.0, replace(OUTSIDE, number=5))
    assert died == Died("no end within 50 s of wall time", True, ["said"])


@pytest.mark.parametrize(
    ("limits", "is_foreign", "is_apart", "limit_s"),
    [
        ((False, None), False, False, None),
        ((True, None), False, True, processes.CALL_LIMIT_S),
        ((False, 5.0), False, True, 5.0),
        ((False, None), True, True, processes.CALL_LIMIT_S),
    ],
)
def test_what_loads_foreign_plants_is_done_apart(
    limits: tuple[bool, float | None], is_foreign: bool, is_apart: bool, limit_s: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    asked: list[Any] = []

    def run_apart(function: Any, tasks: Any, *, call_limit_s: float) -> Any:
        asked.append(call_limit_s)
        return [function(*task) for task in tasks]

    monkeypatch.setattr(processes, "run_apart", run_apart)
    monkeypatch.setattr(processes, "foreign_rigs", lambda rigs: set(rigs) if is_foreign else set())
    assert do_apart(pow, 2, 5, rigs=[RIG], file=RIG, limits=limits) == 32
    assert asked == ([limit_s] if is_apart else [])
    monkeypatch.setattr(processes, "run_apart", lambda *_, **__: [Died("it crashed")])
    if is_apart:
        with pytest.raises(UserError, match=r"rig\.toml: it crashed"):
            do_apart(pow, 2, 5, rigs=[RIG], file=RIG, limits=limits)


class OddError(Exception):
    def __init__(self, one: int, two: int) -> None:
        super().__init__(f"{one} and {two}")


def test_an_exception_comes_out_of_a_process_with_its_stack() -> None:
    plain = worker._portable(UserError("no such file", value="x"))
    assert isinstance(plain, UserError)
    assert plain.message == "no such file"
    assert "UserError" in plain.__notes__[0]
    odd = worker._portable(OddError(1, 2))  # it cannot be made again from its text
    assert (type(odd), "OddError: 1 and 2" in str(odd)) == (RuntimeError, True)
    large = worker._portable(ChannelError("the answer has 3 bytes"))
    assert (type(large), str(large)) == (RuntimeError, "the answer has 3 bytes")


def test_limits_that_were_lowered_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "_limits", lambda: {"A": 5, "B": 7, "C": 9})
    assert worker._lowered({"A": 5, "B": 8, "C": 8}) == "B to 7"
    assert worker._lowered({"A": 6, "B": 8, "C": 9}) == "A to 5, B to 7"
    assert worker._lowered({"A": 5}) == ""


@pytest.mark.skipif(sys.platform == "win32", reason="no such limits")
def test_no_limit_is_more_than_any(monkeypatch: pytest.MonkeyPatch) -> None:
    resource: Any = import_module("resource")
    before = worker._limits()
    assert {"RLIMIT_FSIZE", "RLIMIT_NOFILE"} <= set(before)
    unlimited = resource.RLIM_INFINITY
    monkeypatch.setattr(resource, "getrlimit", lambda _: (unlimited, unlimited))
    assert set(worker._limits().values()) == {sys.maxsize}


# Real axes


def outside(said: list[str], **options: Any) -> Outside:
    return Outside(lambda: None, options.pop("may_move", False), said.append, **options)  # type: ignore[arg-type, return-value]


def test_an_interface_goes_onto_the_segment_that_is_meant() -> None:
    buses = {name: read_segment({}) for name in "ab"}
    assert outside([]).changes(buses, RIG) == []
    assert not outside([], segment="a").says_anything
    one = {"a": buses["a"]}
    words = {"interface": "slcan", "channel": "/dev/x", "bitrate": 500_000,
             "options": ["a=1", "b=2"]}  # fmt: skip
    found = [f"{item.column}={item.value}" for item in outside([], **words).changes(one, RIG)]
    assert found == ["bus:a.interface=slcan", "bus:a.channel=/dev/x", "bus:a.bitrate=500000",
                     "bus:a.options=a=1 b=2"]  # fmt: skip
    named = outside([], interface="slcan", segment="b").changes(buses, RIG)
    assert [item.column for item in named] == ["bus:b.interface"]
    for options, segments, message in (
        ({"interface": "slcan"}, buses, "the rig has several segments"),
        ({"interface": "slcan"}, {}, "the rig has several segments"),
        ({"interface": "slcan", "segment": "c"}, buses, "the rig has no such segment"),
    ):
        with pytest.raises(UserError, match=message):
            outside([], **options).changes(segments, RIG)
    for name, value in words.items():
        assert outside([], **{name: value}).says_anything


def test_rigs_of_a_plan_name_their_segment_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    segments = {RIG: ["a"], OTHER: ["b"], Path("third.toml"): ["a"]}
    buses = {rig: {name: read_segment({}) for name in names} for rig, names in segments.items()}
    monkeypatch.setattr(
        hardware_runs, "read_rig", lambda rig: (SimpleNamespace(segment=buses[rig]), [])
    )
    on = outside([], interface="slcan")
    alike: Any = SimpleNamespace(cases=[case_of("a"), case_of("b", Path("third.toml"))])
    assert [item.column for item in on.changes_of(alike)] == ["bus:a.interface"]
    mixed: Any = SimpleNamespace(cases=[case_of("a"), case_of("b", OTHER)], path=Path("p.csv"))
    with pytest.raises(UserError, match="name their segments differently"):
        on.changes_of(mixed)
    assert outside([]).changes_of(mixed) == []


def rig_with(axes: str, *, is_allowed: bool, foreign: str = "") -> Any:
    return SimpleNamespace(rig=SimpleNamespace(hardware=is_allowed), axes=axes, foreign=foreign)


@pytest.mark.parametrize(
    ("rigs", "may_move", "is_allowed"),
    [
        ([rig_with("Z", is_allowed=False)], False, False),
        ([rig_with("Z", is_allowed=False)], True, True),
        ([rig_with("Z", is_allowed=True)], False, True),
        ([rig_with("Z", is_allowed=True), rig_with("X", is_allowed=False)], False, False),
        ([rig_with("Z", is_allowed=True), rig_with("", is_allowed=False)], False, True),
        ([rig_with("", is_allowed=False)], False, True),
        ([], False, True),
    ],
)
def test_nothing_real_moves_unless_operator_or_every_rig_allows_it(
    rigs: list[Any], may_move: bool, is_allowed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hardware_runs, "outside_axes", lambda rig: frozenset(rig.axes))
    monkeypatch.setattr(hardware_runs, "simulated_plants", lambda rig: [*rig.foreign])
    monkeypatch.setattr(hardware_runs, "foreign_plants", lambda plants: plants)
    family = SimpleNamespace(outside=lambda _rig, name: f"drive of {name}")
    monkeypatch.setattr(hardware_runs, "family_of", lambda _rig, _name: family)
    said: list[str] = []
    if is_allowed:
        allow(rigs, outside(said, may_move=may_move))
    else:
        with pytest.raises(UserError, match="only when the operator allows it"):
            allow(rigs, outside(said, may_move=may_move))
    names = [name for rig in rigs for name in rig.axes]
    assert [line for line in said if line.startswith("  ")] == [
        f"  axis {name}: drive of {name}" for name in names
    ]
    assert ("Ctrl-C brakes them and powers the drives down" in said) is bool(is_allowed and names)


def test_a_foreign_model_beside_real_axes_is_warned_of_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(hardware_runs, "outside_axes", lambda rig: frozenset(rig.axes))
    monkeypatch.setattr(hardware_runs, "simulated_plants", lambda rig: [*rig.foreign])
    monkeypatch.setattr(hardware_runs, "foreign_plants", lambda plants: plants)
    family = SimpleNamespace(outside=lambda _rig, _name: "a drive")
    monkeypatch.setattr(hardware_runs, "family_of", lambda _rig, _name: family)
    said: list[str] = []
    rig = rig_with("ZZ", is_allowed=True, foreign="m")
    allow([rig, rig], outside(said))
    assert sum(line.startswith("plant m is a foreign FMU") for line in said) == 1
    assert sum(line.startswith("  axis Z") for line in said) == 1


def test_cases_with_a_real_bus_count_once_for_each_rig_and_its_words(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What a case says of its drives belongs to what is real, and does not make it real."""
    asked: list[Any] = []

    def settings(rig: Path, words: Any) -> Any:
        asked.append((rig.name, words))
        if rig.name == "broken.toml":
            raise UserError("no rig")
        return SimpleNamespace(rig=rig.name, words=words)

    monkeypatch.setattr(hardware_runs, "_settings", settings)
    monkeypatch.setattr(
        hardware_runs, "is_paced", lambda s: any("interface" in column for column, _ in s.words)
    )
    real = {"bus:can1.interface": "slcan"}
    cases = [
        case_of("a", inputs={**real, "plc:V.E.A": "1"}),
        case_of("b", inputs={**real, "plc:V.E.A": "2"}),
        case_of("c", inputs={**real, "drive:servo.heartbeat_ms": "20"}),
        case_of("d", inputs={"drive:servo.interface": "slcan"}),
        case_of("e", Path("broken.toml"), inputs=real),
    ]
    found = real_cases(cases)
    assert [(one.rig, dict(one.words)) for one in found] == [  # type: ignore[attr-defined]
        ("rig.toml", real), ("rig.toml", {**real, "drive:servo.heartbeat_ms": "20"}),
    ]  # fmt: skip


def test_a_real_bus_has_one_process() -> None:
    refuse_processes(1, False)
    for jobs, is_apart in ((2, False), (1, True)):
        with pytest.raises(UserError, match="driven from this process"):
            refuse_processes(jobs, is_apart)


def test_the_first_signal_stops_and_the_second_breaks_off() -> None:
    said: list[str] = []
    before = signal.getsignal(signal.SIGINT)
    real_time: Any = object()
    with hardware_runs.stoppable(real_time, said.append) as on:
        assert not on.stop()
        signal.raise_signal(signal.SIGTERM)
        assert on.stop()
        assert said == ["stopping; once more to break off"]
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before


# Once more


def stored_run(run: str, **case: str) -> Any:
    row = {"run": run, "plan": "p", "frame_log_sha256": "ab", **case}
    return SimpleNamespace(run=run, case=row, altered_words=f"of {run}")


def test_a_recorded_case_comes_with_the_inputs_of_its_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "p.csv"
    path.touch()
    runs = [
        stored_run("p-a", **{"plc:V.E.A": "7", "plc:V.E.B": "", "check:m": "< 1", "title": "t"}),
        stored_run("p-s-s02", probe="p-s"),
        stored_run("p-x", runs="p-x-1 p-x-2"),
        stored_run("p-x-1"),
        stored_run("q-b", plan="q"),
        stored_run("p-gone"),
    ]
    listed = {"plans": [{"name": "p", "path": str(path)}, {"name": "q", "path": "/none/q.csv"}]}
    stored = SimpleNamespace(runs=runs, manifest=listed)
    search = SimpleNamespace(checks=("asked",))
    cases = (case_of("a", inputs={"plc:V.E.A": "1"}), case_of("s", search=search))
    monkeypatch.setattr(replay, "read_results", lambda _: stored)
    monkeypatch.setattr(replay, "own_plan", lambda _folder, name: Path(name))
    monkeypatch.setattr(replay, "read_plan", lambda _: SimpleNamespace(cases=cases))
    case, row = replay.recorded_case(tmp_path, "p-a")
    assert (case.run, dict(case.inputs), row["title"]) == ("p-a", {"plc:V.E.A": "7"}, "t")
    probe, _ = replay.recorded_case(tmp_path, "p-s-s02")
    assert (probe.run, probe.checks, probe.search) == ("p-s-s02", ("asked",), None)
    assert replay.altered_words(tmp_path, "p-x-1") == "of p-x-1"
    for run, message in (
        ("p-b", "the folder has no such run"),
        ("p-x", "says something over several runs"),
        ("q-b", "the plan of this run is not there any more"),
        ("p-gone", "the plan has no such run any more"),
    ):
        with pytest.raises(UserError, match=message):
            replay.recorded_case(tmp_path, run)
    # What was a probe is none of a row that does not search any more, and the other way round
    runs.append(stored_run("p-a-s01", probe="p-a"))
    runs.append(stored_run("p-s"))
    for run in ("p-a-s01", "p-s"):
        with pytest.raises(UserError, match="the plan has no such run any more"):
            replay.recorded_case(tmp_path, run)


def test_a_replay_is_the_same_by_its_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def run(case: Case, files: Any) -> Any:
        asked.append((case.run, files.bus_logs))
        return SimpleNamespace(frame_log_sha256="ab")

    monkeypatch.setattr(replay, "run_case", run)
    for sha, is_same in (("ab", True), ("cd", False)):
        found = replay.replay(case_of("a"), {"frame_log_sha256": sha}, [Path("x.blf")])
        assert found.is_same is is_same
    assert asked == [("p-a", [Path("x.blf")])] * 2


# What was used


def test_sources_count_by_name_and_content_and_what_was_made_of_them_does_not(
    tmp_path: Path,
) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    for folder, name, text in (
        (first, "one.py", "1"), (first, "deep/two.csv", "2"), (second, "three.py", "3"),
    ):  # fmt: skip
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    before = hash_of_sources([first, second])
    assert hash_of_sources([second, first]) == before
    for name in ("one.so", "deep/x.pyc", "y.pyd"):
        (first / name).touch()
    (second / "reports").mkdir()
    (second / "reports" / "glossary.csv").write_text("of the documents", encoding="utf-8")
    assert hash_of_sources([first, second]) == before
    (first / "one.py").write_text("x", encoding="utf-8")
    changed = hash_of_sources([first, second])
    (first / "one.py").write_text("1", encoding="utf-8")
    (first / "one.py").rename(first / "other.py")
    assert len({before, changed, hash_of_sources([first, second])}) == 3


def test_files_that_the_plc_starts_count_and_metrics_of_the_user() -> None:
    started = "file=a.nc after=5ms; at=motion file=sub/b.nc;file=c.nc"
    module: Any = SimpleNamespace(path=Path("/m/own.py"))
    own: Any = SimpleNamespace(path=None)
    base = case_of("a", program=Path("/n/part.nc"))
    assert other_files(base) == []
    found = other_files(replace(base, inputs={"plc:program_start": started}, module=module))
    assert found == [Path("/n/a.nc"), Path("/n/sub/b.nc"), Path("/n/c.nc"), Path("/m/own.py")]
    assert other_files(replace(base, inputs={"plc:V.E.A": "file=x.nc"}, module=own)) == []


# Hashes of files, and a program on real axes


def test_files_of_cases_are_hashed_once_by_their_names_from_the_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Program, rig with what it is made from, and a table that the plan takes rows from."""
    for name in ("p.csv", "rows.csv", "b.nc", "a.nc", "lists/z.lst", "r.toml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name, encoding="utf-8")
    monkeypatch.setattr(manifest, "rig_files", lambda rig: [rig, tmp_path / "lists" / "z.lst"])
    own = {"folder": tmp_path, "rig": tmp_path / "r.toml", "file": tmp_path / "p.csv"}
    cases = [
        case_of("a", program=tmp_path / "b.nc", **own),
        case_of("b", program=tmp_path / "a.nc", **own),
        case_of("c", program=tmp_path / "a.nc", **{**own, "file": tmp_path / "rows.csv"}),
    ]  # fmt: skip
    found = manifest.file_hashes(cases)
    assert list(found) == ["a.nc", "b.nc", "lists/z.lst", "r.toml", "rows.csv"]
    for name, digest in found.items():
        assert digest == hashlib.sha256(name.encode()).hexdigest()
    assert "rows.csv" not in manifest.file_hashes(cases[:2])


@pytest.mark.parametrize("is_real", [True, False])
def test_a_program_goes_to_real_axes_only_with_all_checks(
    is_real: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    news: list[Any] = []
    table = SimpleNamespace(axis={"Z": None}, segment={"can1": read_segment({})})
    monkeypatch.setattr(single, "read_rig", lambda _: (table, []))
    monkeypatch.setattr(single, "read_settings", lambda *given: ("settings", len(given[2])))
    monkeypatch.setattr(single, "is_paced", lambda _: is_real)
    monkeypatch.setattr(single, "refuse_processes", lambda *given: news.append(given))
    monkeypatch.setattr(single, "read_program", lambda *given: news.append(given))
    monkeypatch.setattr(single, "check_plant", lambda _: news.append("plant"))
    monkeypatch.setattr(single, "allow", lambda *_: news.append("allowed"))
    monkeypatch.setattr(single, "run_program", lambda *given: given)
    on = outside([], interface="slcan")
    object.__setattr__(on, "open_hardware", lambda: nullcontext("hardware"))
    found = single.run_outside(
        on, Path("a.nc"), RIG, ["plc:V.E.A=1"], [Path("x.blf")], print, is_apart=False
    )
    if not is_real:
        assert (found, news) == (None, [])
        return
    assert news == [(1, False), (Path("a.nc"), ("Z",)), "plant", "allowed"]
    changes = ["plc:V.E.A=1", "bus:can1.interface=slcan"]
    assert found == (Path("a.nc"), RIG, changes, [Path("x.blf")], print, "hardware")
