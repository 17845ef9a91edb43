"""Commands of the command line: what becomes of their options, and with which code they end."""

import gc
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.cli import main as command_line
from axisrig.bench.cli import start
from axisrig.bench.cli.main import main
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.settings import AS_CANOPEN, FORCED
from axisrig.kernel.errors import UserError

CAMPAIGN = "axisrig.bench.campaign"


def call(*words: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(words)
    return int(ended.value.code or 0)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What `run_campaign` is called with."""
    found: dict[str, Any] = {}

    def run_campaign(plans: Any, **given: Any) -> Any:
        found.update(given, plans=plans)
        return SimpleNamespace(exit_code=3)

    monkeypatch.setattr(f"{CAMPAIGN}.campaign.run_campaign", run_campaign)
    monkeypatch.setattr(f"{CAMPAIGN}.campaign.show_campaign", lambda *_: None)
    return found


def test_a_run_without_options_leaves_all_as_it_is(asked: dict[str, Any]) -> None:
    assert call("run", "a.csv", "b.csv") == 3
    assert asked["plans"] == [Path("a.csv"), Path("b.csv")]
    plain = ("out", "jobs", "timeout_s", "is_isolated", "is_fresh", "assignments", "call_limit_s")
    assert [asked[name] for name in plain] == [None, None, None, False, False, [], 60.0]
    assert (asked["select"].select, asked["select"].shard) == (None, None)
    assert not asked["outside"].says_anything
    assert not asked["outside"].may_move
    assert not asked["build_report"].keywords["is_full"]
    assert not asked["warn"].keywords["is_strict"]
    assert asked["command"][0] == "axisrig"


def test_each_option_of_a_run_gets_where_it_belongs(asked: dict[str, Any]) -> None:
    words = (
        "run a.csv -o out -k probe -j 3 --timeout 5 --isolate --call-timeout 7 --set plc:V.E.A=1"
        " --force --as-canopen --interface slcan --channel /dev/x --option a=1 --bitrate 500000"
        " --segment can1 --yes --bus-log asc --fresh --full --shard 2/3 --strict"
    )
    assert call(*words.split()) == 3
    found = {name: asked[name] for name in ("out", "jobs", "timeout_s", "is_isolated", "is_fresh",
                                            "call_limit_s", "assignments")}  # fmt: skip
    assert found == {
        "out": Path("out"), "jobs": 3, "timeout_s": 5.0, "is_isolated": True, "is_fresh": True,
        "call_limit_s": 7.0, "assignments": ["plc:V.E.A=1", FORCED, AS_CANOPEN],
    }  # fmt: skip
    select, outside = asked["select"], asked["outside"]
    assert (select.select, select.shard.number, select.shard.count) == ("probe", 2, 3)
    assert (outside.may_move, outside.interface, outside.channel) == (True, "slcan", "/dev/x")
    assert (outside.bitrate, outside.segment, list(outside.options)) == (500_000, "can1", ["a=1"])
    assert asked["build_report"].keywords["is_full"]
    assert asked["warn"].keywords["is_strict"]
    assert asked["bus_logs"]


@pytest.mark.parametrize(
    ("words", "is_isolated", "call_limit_s"),
    [("", False, 60.0), ("--isolate", True, 60.0), ("--call-timeout 7", True, 7.0)],
)
def test_a_limit_of_calls_needs_a_process_of_its_own(
    words: str, is_isolated: bool, call_limit_s: float, asked: dict[str, Any]
) -> None:
    call("run", "a.csv", *words.split())
    assert (asked["is_isolated"], asked["call_limit_s"]) == (is_isolated, call_limit_s)


@pytest.mark.parametrize(("option", "select"), [((), "demo"), (("--all",), None)])
def test_the_demo_runs_its_rows_of_every_plan(
    option: tuple[str, ...], select: str | None, asked: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    built: list[None] = []
    monkeypatch.setattr(command_line, "build_library", lambda: built.append(None))
    monkeypatch.setattr(f"{CAMPAIGN}.plan_files.plans_in", lambda folder: [folder / "a.csv"])
    assert call("demo", "--plans", "mine", "-j", "2", *option) == 3
    assert built == [None]
    assert (asked["plans"], asked["out"]) == ([Path("mine/a.csv")], Path("out/demo"))
    assert (asked["select"].select, asked["jobs"]) == (select, 2)
    assert ("rows tagged demo" in capsys.readouterr().err) is (select == "demo")


@pytest.mark.parametrize("more", [(), ("--all",)])
@pytest.mark.parametrize("is_fresh", [False, True])
def test_a_fresh_demo_is_one_with_any_rows(
    more: tuple[str, ...], is_fresh: bool, asked: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command_line, "build_library", lambda: None)
    monkeypatch.setattr(f"{CAMPAIGN}.plan_files.plans_in", lambda folder: [folder / "a.csv"])
    assert call("demo", *more, *["--fresh"] * is_fresh) == 3
    assert asked["is_fresh"] is is_fresh


def test_warnings_are_shown_and_refused_where_asked(capsys: pytest.CaptureFixture[str]) -> None:
    command_line._warn(["one", "two"], is_strict=False)
    assert capsys.readouterr().err == "warning: one\nwarning: two\n"
    command_line._warn([], is_strict=True)
    with pytest.raises(UserError, match="one"):
        command_line._warn(["one", "two"], is_strict=True)
    assert capsys.readouterr().err == ""


def test_a_judged_folder_ends_by_its_worst_verdict_and_names_what_is_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: dict[str, Any] = {}

    def rejudge(folder: Path, plan: Path, **more: Any) -> Any:
        given.update(more, folder=folder, plan=plan)
        return SimpleNamespace(results=[], left=["p-a"], report=Path("r.html"), exit_code=4)

    monkeypatch.setattr(f"{CAMPAIGN}.rejudge.rejudge", rejudge)
    monkeypatch.setattr(f"{CAMPAIGN}.verdict_table.show_verdicts", lambda *_, **__: None)
    assert call("judge", "out", "--plan", "new.csv", "--set", "plc:V.E.A=1", "--as-canopen") == 4
    assert (given["folder"], given["plan"]) == (Path("out"), Path("new.csv"))
    assert given["assignments"] == ["plc:V.E.A=1", AS_CANOPEN]
    out, err = capsys.readouterr()
    assert out == "r.html\n"
    assert err.splitlines()[0] == "no row of the plan judges p-a"
    assert err.splitlines()[1].startswith("nothing ran in ")


# One program


Ended = SimpleNamespace


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What runs a program, and its arguments; `real` and `ended` are what it returns."""
    found: dict[str, Any] = {"real": None, "ended": []}

    def run_outside(outside: Any, *given: Any, is_apart: bool) -> Any:
        found.update(outside=outside, given=given, is_apart=is_apart)
        return found["real"]

    def do_apart(_function: Any, *given: Any, **more: Any) -> Any:
        found.update(more, simulated=given)
        return found["ended"]

    monkeypatch.setattr(f"{CAMPAIGN}.single_program.run_outside", run_outside)
    monkeypatch.setattr(f"{CAMPAIGN}.processes.do_apart", do_apart)
    return found


@pytest.mark.parametrize(
    ("ends", "code"), [((), 0), ((False,), 0), ((True,), 1), ((False, True, False), 1)]
)
def test_a_program_ends_with_1_where_an_alarm_has_ended_it(
    ends: tuple[bool, ...], code: int, ran: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    ran["ended"] = [Ended(text=f"t{n}", ends_program=is_it) for n, is_it in enumerate(ends)]
    assert call("nc", "a.nc", "--rig", "r.toml") == code
    assert capsys.readouterr().err.split() == [f"t{n}" for n in range(len(ends))]
    assert ran["simulated"] == ran["given"]
    assert (ran["rigs"], ran["file"], ran["limits"]) == (
        [Path("r.toml")], Path("a.nc"), (False, None),
    )  # fmt: skip
    ran["real"], ran["ended"] = ran["ended"], None
    assert call("nc", "a.nc", "--rig", "r.toml") == code  # on a real bus nothing is simulated


def test_options_of_a_program_get_where_they_belong(ran: dict[str, Any]) -> None:
    words = "nc a.nc --rig r.toml --bus-log x.ASC --set plc:limit_s=5 --force --yes --isolate"
    assert call(*words.split()) == 0
    program, rig, inputs, logs, _ = ran["given"]
    assert (program, rig, inputs) == (Path("a.nc"), Path("r.toml"), ["plc:limit_s=5", FORCED])
    assert logs == [Path("x.ASC")]
    assert (ran["outside"].may_move, ran["is_apart"], ran["limits"]) == (True, True, (True, None))
    call("nc", "a.nc", "--rig", "r.toml", "--call-timeout", "3")
    assert (ran["is_apart"], ran["limits"], ran["outside"].may_move) == (True, (False, 3.0), False)
    ran.pop("given")
    assert call("nc", "a.nc", "--rig", "r.toml", "--bus-log", "x.txt") == 2
    assert call("nc", "a.nc") == 2
    assert "given" not in ran


@pytest.mark.parametrize(("is_well", "code"), [(True, 0), (False, 2)])
def test_a_check_of_a_program_runs_nothing(
    is_well: bool, code: int, ran: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Any] = []

    def check_file(program: Path, rig: Path | None) -> bool:
        seen.append((program, rig))
        return is_well

    monkeypatch.setattr("axisrig.bench.cli.nc_check.check_file", check_file)
    assert call("nc", "a.nc", "--check") == code
    assert call("nc", "a.nc", "--check", "--rig", "r.toml") == code
    assert seen == [(Path("a.nc"), None), (Path("a.nc"), Path("r.toml"))]
    assert "given" not in ran


# Once more, drives, checks


@pytest.mark.parametrize(
    ("verdict", "is_same", "code"),
    [(Verdict.PASS, True, 0), (Verdict.FAIL, True, 1), (Verdict.ERROR, True, 4),
     (Verdict.PASS, False, 1), (Verdict.ERROR, False, 1)],
)  # fmt: skip
def test_a_replay_ends_by_its_verdict_where_its_frames_are_the_same(
    verdict: Verdict, is_same: bool, code: int, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    given: list[Any] = []
    case = SimpleNamespace(rig=Path("r.toml"))

    def do_apart(*what: Any, **more: Any) -> Any:
        given.append((what[1:], more))
        return SimpleNamespace(result=SimpleNamespace(verdict=verdict), is_same=is_same)

    monkeypatch.setattr(f"{CAMPAIGN}.replay.recorded_case", lambda *_: (case, {"run": "p-a"}))
    monkeypatch.setattr(f"{CAMPAIGN}.replay.altered_words", lambda *_: "" if is_same else "odd")
    monkeypatch.setattr(f"{CAMPAIGN}.processes.do_apart", do_apart)
    monkeypatch.setattr(f"{CAMPAIGN}.verdict_table.show_verdicts", lambda *_, **__: None)
    assert call("replay", "out", "p-a", "--bus-log", "x.blf") == code
    out, err = capsys.readouterr()
    word = "equal" if is_same else "DIFFERS from the recorded one"
    assert out == f"frame_log_sha256 {word}\n"
    assert err == ("" if is_same else "p-a: odd\n")
    ((what, more),) = given
    assert what == (case, {"run": "p-a"}, [Path("x.blf")])
    assert more == {"rigs": [case.rig], "file": Path("out"), "limits": (False, None)}


def test_drives_are_served_or_their_eds_is_written(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    served: dict[str, Any] = {}
    room = "axisrig.bench.tools.virtual_drive.serve"

    def drive_settings(*given: Any) -> str:
        served.update(given=given)
        return "settings"

    monkeypatch.setattr(f"{room}.drive_settings", drive_settings)
    monkeypatch.setattr(f"{room}.serve", lambda *given, **more: served.update(more, said=given))
    monkeypatch.setattr(f"{room}.write_eds", lambda _, path: path)
    monkeypatch.setattr(f"{room}.whose_eds", lambda _: "axis Z")
    words = "drive r.toml --interface slcan --axis Z --axis X --for 3 --by-sync -o o --store s"
    call(*words.split(), "--set", "drive:servo.heartbeat_ms=20")
    rig, outside, axes, inputs = served["given"]
    assert (rig, axes, inputs) == (Path("r.toml"), ["Z", "X"], ["drive:servo.heartbeat_ms=20"])
    assert (outside.interface, outside.may_move) == ("slcan", True)
    assert served["said"][0] == "settings"
    assert (served["by_sync"], served["for_s"]) == (True, 3.0)
    assert (served["folder"], served["store"]) == (Path("o"), Path("s"))
    served.clear()
    call("drive", "r.toml", "--eds", "d.eds")
    assert "said" not in served
    assert capsys.readouterr() == ("d.eds\n", "the drive of axis Z\n")
    call("drive", "r.toml")
    assert (served["by_sync"], served["for_s"], served["folder"]) == (False, None, None)


def test_a_check_gets_its_files_and_how_strict_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def check_files(files: Any, inputs: Any, limits: Any, _say: Any, **how: Any) -> None:
        seen.append((files, inputs, limits, how))

    monkeypatch.setattr(f"{CAMPAIGN}.checking.check_files", check_files)
    call("check", "a.csv", "r.toml")
    call(
        "check", "a.csv", "--force", "--isolate", "--call-timeout", "4", "--strict", "-v", "-k", "b"
    )
    assert seen == [
        ([Path("a.csv"), Path("r.toml")], [], (False, None),
         {"is_strict": False, "is_verbose": False, "select": None}),
        ([Path("a.csv")], [FORCED], (True, 4.0),
         {"is_strict": True, "is_verbose": True, "select": "b"}),
    ]  # fmt: skip


def test_going_on_takes_the_words_of_the_folder_and_those_of_this_call(
    monkeypatch: pytest.MonkeyPatch, asked: dict[str, Any]
) -> None:
    room = f"{CAMPAIGN}.resuming.stored_arguments"
    monkeypatch.setattr(room, lambda *_: ["p.csv", "-o", "out", "-k", "probe"])
    monkeypatch.setattr(sys, "argv", ["axisrig", "run", "-o", "out", "--resume"])
    assert call("run", "-o", "out", "--resume") == 3
    assert (asked["plans"], asked["select"].select) == ([Path("p.csv")], "probe")
    assert asked["going_on"].option == "--resume"
    asked.clear()
    assert call("run", "-o", "out") == 2  # no plan, and nothing to go on with
    assert asked == {}


# The process of a command


def test_an_interrupt_that_python_drops_comes_once_more(monkeypatch: pytest.MonkeyPatch) -> None:
    if not hasattr(signal, "setitimer"):
        pytest.skip("no such timer")
    hooks: list[Any] = []
    timers: list[Any] = []
    monkeypatch.setattr(sys, "unraisablehook", hooks.append)
    monkeypatch.setattr(start.signal, "setitimer", lambda *given: timers.append(given))
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGALRM)}
    try:
        start.end_on_signals()
        first = sys.unraisablehook
        start.end_on_signals()
        assert sys.unraisablehook is first
        assert signal.getsignal(signal.SIGTERM) is signal.default_int_handler
        odd: list[Any] = [SimpleNamespace(exc_type=kind) for kind in (ValueError, BaseException)]
        for one in odd:
            first(one)
        assert (hooks, timers) == (odd, [])
        stop: Any = SimpleNamespace(exc_type=KeyboardInterrupt)
        first(stop)
        assert (hooks, len(timers)) == (odd, 1)
        assert timers[0][0] == signal.ITIMER_REAL
        assert signal.getsignal(signal.SIGALRM) is signal.default_int_handler
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def test_a_short_command_looks_for_little_garbage_and_starts_no_threads(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    at_end: list[Callable[[], object]] = []
    monkeypatch.setattr(start.atexit, "register", at_end.append)
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    before = gc.get_threshold()
    known = sys.modules.get("asammdf", ...)
    try:
        start.start_lightly()
        assert gc.get_threshold()[0] == start.GARBAGE_MIN
        assert at_end == [gc.freeze]
        assert start.os.environ["OPENBLAS_NUM_THREADS"] == "1"
        assert "asammdf" in sys.modules
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")
        start.start_lightly()
        assert start.os.environ["OPENBLAS_NUM_THREADS"] == "4"  # who set it wants it
    finally:
        gc.set_threshold(*before)
        if known is ...:
            sys.modules.pop("asammdf", None)
