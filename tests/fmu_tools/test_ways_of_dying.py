"""An FMU that ends its process never makes anything green, whichever way it does it, and wherever.

One source with the way as its parameter (ideal_axis.c). Nothing here asks for `--isolate` unless it
says so: an FMU that was not built here runs in a process of its own anyway.
"""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

import pandas as pd
import pytest
from fmu_rigs import write_plan, write_rig

from axisrig.bench.bus.can.logs import log_kinds
from axisrig.bench.campaign.campaign import Choice, run_campaign
from axisrig.bench.campaign.hardware_runs import Outside, allow
from axisrig.bench.cli.main import main
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.foreign import foreign_rigs
from axisrig.bench.rig.settings import read_settings
from axisrig.fmus import ensure_built

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Build = Callable[..., Path]

ROOT = Path(__file__).parents[2]
# How a process ends, and the words of the message about it
# exit() runs the handlers of all that the process holds while its other threads go on: these then
# reach for what is gone, or a handler that needs the interpreter gives up (DuckDB's, if loaded)
WAYS = {
    "EXIT": "exit code 0|SIGABRT|SIGSEGV",
    "QUIT": "exit code 0",
    "ABORT": "SIGABRT",
    "SEGFAULT": "SIGSEGV",
    "KILL": "SIGKILL",
    "HANG": "a call did not come back within 1 s",
}
CALL_TIMEOUT = ("--call-timeout", "1")
# A thread that never ends harms nothing
SPINS = ("HANG", "THREAD")
DEADLY = [(way, place) for place in ("CALL", "THREAD") for way in WAYS if (way, place) != SPINS]

# So long that a thread surely comes to its turn before the end
LONG = "N10 G90 G1 Z200 F3000\nN12 Z130\n"

pytestmark = pytest.mark.skipif(
    sys.platform == "win32", reason="the FMUs of this test end by POSIX signals"
)


@pytest.fixture(autouse=True)
def _long_program(place: Path) -> None:
    (place / "move.nc").write_text(f"{LONG}N20 M30\n", encoding="utf-8")


@pytest.fixture(scope="session")
def deadly(ideal_axis: Build) -> Build:
    """Build an FMU that dies in a way from a place, in a step or in another call."""
    built: dict[tuple[str, str, str], Path] = {}

    def build(way: str, place: str, crash_in: str = "STEP") -> Path:
        key = (way, place, crash_in)
        if key not in built:
            at_s = 0.005 if crash_in == "STEP" else 0
            faults = {"CRASH_IN": crash_in, "CRASH_HOW": way, "CRASH_FROM": place}
            name = f"{way}-{place}.fmu".lower()
            built[key] = ideal_axis(name, **faults, CRASH_AT_S=at_s, EXIT_CODE=0)
        return built[key]

    return build


def _row(place: Path, fmu: Path) -> str:
    return write_rig(place, f"{fmu.stem}.toml", fmu)


def _without_options(way: str, place: str) -> bool:
    """Whether it ends by itself: a call that hangs wants a limit shorter than a minute."""
    return (way, place) != ("HANG", "CALL")


def _hold_to(place: Path, rows: list[tuple[str, str]], code: int, out: str) -> None:
    """Every planned run has its row; those of the ways are errors and say so."""
    cases = pd.read_csv(place / "results" / "cases.csv")
    verdicts = ["pass" if row in (SPINS, ("GOOD", "")) else "error" for row in rows]
    assert list(cases["verdict"]) == verdicts, out
    assert code == 4
    for (way, _), run in zip(rows, cases["run"], strict=True):
        log = (place / "results" / "runs" / f"{run}.json").read_text(encoding="utf-8")
        assert way in ("GOOD", "HANG") or re.search(WAYS[way], log)


@pytest.mark.parametrize("place_of_death", ["CALL", "THREAD"])
@pytest.mark.long
def test_each_way_costs_its_own_row(
    place: Path, axisrig: Call, ideal_axis: Build, deadly: Build, place_of_death: str
) -> None:
    """Without a single option, one process after the other."""
    ways = [(way, place_of_death) for way in WAYS if _without_options(way, place_of_death)]
    rigs = [_row(place, deadly(*way)) for way in ways]
    plan = write_plan(place, *rigs, write_rig(place, "good.toml", ideal_axis("good.fmu")))
    code, out, _ = axisrig("run", plan, "-o", "results")
    _hold_to(place, [*ways, ("GOOD", "")], code, out)


@pytest.mark.long
@pytest.mark.parametrize("options", ["-j 1", "-j 2", "--isolate", "-j 2 --isolate"])
def test_run(place: Path, axisrig: Call, ideal_axis: Build, deadly: Build, options: str) -> None:
    ways = [*DEADLY, SPINS]
    rigs = [_row(place, deadly(*way)) for way in ways]
    plan = write_plan(place, *rigs, write_rig(place, "good.toml", ideal_axis("good.fmu")))
    code, out, _ = axisrig("run", plan, "-o", "results", *options.split(), *CALL_TIMEOUT)
    _hold_to(place, [*ways, ("GOOD", "")], code, out)


def _nc(place: Path, axisrig: Call, fmu: Path, *options: str) -> Outcome:
    text = f'N5 #MSG SYN["begun"]\n{LONG}N20 #MSG SYN["ended"]\nN30 M30\n'
    (place / "say.nc").write_text(text, encoding="utf-8")
    return axisrig("nc", "say.nc", "--rig", _row(place, fmu), *options)


@pytest.mark.long
def test_a_program_whose_process_ends_with_0_is_rejected(
    place: Path, axisrig: Call, deadly: Build
) -> None:
    code, out, err = _nc(place, axisrig, deadly("EXIT", "THREAD"))
    assert (code, "ended" in out) == (2, False)
    assert re.match(rf"error: say\.nc: .*({WAYS['EXIT']})", err)


@pytest.mark.long
@pytest.mark.parametrize(("way", "place_of_death"), DEADLY)
def test_nc(place: Path, axisrig: Call, deadly: Build, way: str, place_of_death: str) -> None:
    for options in [CALL_TIMEOUT, ("--isolate", *CALL_TIMEOUT)]:
        code, out, err = _nc(place, axisrig, deadly(way, place_of_death), *options)
        assert (code, "ended" in out) == (2, False)
        assert re.search(WAYS[way], err)


@pytest.mark.long
def test_an_endless_thread_ends_nothing(place: Path, axisrig: Call, deadly: Build) -> None:
    """The run goes on to its end, and the process is ended after it."""
    fmu, before = deadly("HANG", "THREAD"), _children()
    assert _nc(place, axisrig, fmu)[:2] == (0, "begun\nended\n")
    assert _children() == before


def _children() -> list[str]:
    """The living processes that this one has started, where the system lists them."""
    listed = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children")
    return listed.read_text().split() if listed.is_file() else []


@pytest.mark.parametrize(
    ("way", "place_of_death"),
    [
        pytest.param(way, where, marks=[pytest.mark.long] * (way != "QUIT"))
        for way in WAYS
        for where in ("CALL", "AWAITED")
        if (way, where) != ("HANG", "AWAITED")
    ],
)
def test_check(place: Path, axisrig: Call, deadly: Build, way: str, place_of_death: str) -> None:
    rig = _row(place, deadly(way, place_of_death, "INITIALIZE"))
    code, out, err = axisrig("check", rig, *(CALL_TIMEOUT if way == "HANG" else ()))
    assert (code, out) == (2, "")
    assert re.search(WAYS[way], err)
    plan = write_plan(place, rig)
    # What dies before a run dies again in it, and there it is a row; nothing else is wrong here
    assert axisrig("check", plan, *(CALL_TIMEOUT if way == "HANG" else ()))[0] == 2


@pytest.mark.parametrize(
    ("way", "place_of_death"),
    [
        pytest.param(way, where, marks=[pytest.mark.long] * ((way, where) != ("EXIT", "AWAITED")))
        for way in WAYS
        for where in ("CALL", "AWAITED")
        if (way, where) != ("HANG", "AWAITED")
    ],
)
def test_fmu_check(axisrig: Call, deadly: Build, way: str, place_of_death: str) -> None:
    fmu = deadly(way, place_of_death, "TERMINATE")
    code, out, _ = axisrig("fmu", "check", fmu, *(CALL_TIMEOUT if way == "HANG" else ()))
    assert code == 1
    assert re.search(WAYS[way], " ".join(out.split()))


@pytest.mark.long
@pytest.mark.parametrize(
    "ways", [[("EXIT", "CALL"), ("HANG", "CALL")], [*DEADLY, SPINS]], ids=["two", "all"]
)
def test_pytest(place: Path, ideal_axis: Build, deadly: Build, ways: list[tuple[str, str]]) -> None:
    rigs = [_row(place, deadly(*way)) for way in ways]
    write_plan(place, *rigs, write_rig(place, "good.toml", ideal_axis("good.fmu")))
    shutil.copy(ROOT / "testplans" / "conftest.py", place)
    words = ["-q", "-p", "no:cacheprovider", "-c", os.devnull, "--rootdir", ".", "."]
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *words, "--axisrig-call-timeout", "1"],
        cwd=place, env=os.environ | {"COLUMNS": "200"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    failed = [way for way in ways if way in DEADLY]
    assert ended.returncode == 1, ended.stdout + ended.stderr
    assert f"{len(failed)} failed, {len(ways) + 1 - len(failed)} passed" in ended.stdout
    for way, _ in failed:
        assert re.search(WAYS[way], ended.stdout)


def test_which_rigs_are_foreign(place: Path, ideal_axis: Build) -> None:
    """Ours are the models of the library, and the bytes built of them wherever they lie."""
    model = "AxisRig.Drives.KinematicAxis"
    copied = place / "axis.fmu"
    shutil.copy(ensure_built(model), copied)
    model_rig = place / write_rig(place, "model.toml", Path(model))
    copied_rig = place / write_rig(place, "copied.toml", copied)
    foreign_rig = place / write_rig(place, "foreign.toml", ideal_axis("good.fmu"))
    without = place / write_rig(place, "none.toml", place / "none.fmu")
    rigs = [model_rig, copied_rig, foreign_rig, without]
    assert foreign_rigs(rigs) == {foreign_rig, without}
    copied.write_bytes(copied.read_bytes() + b"\0")
    assert foreign_rigs(rigs) == {copied_rig, foreign_rig, without}


OUTSIDE = """
[axis.X]
list = "lists/axis-x.lst"
segment = "can1"
node = 1
drive = "servo"
plant = "x"

[plant.x]
fmu = "AxisRig.Drives.ServoAxis"
"""


def test_before_axes_outside_move_it_is_said_what_cannot_be_caught(
    place: Path, ideal_axis: Build
) -> None:
    """A real bus is driven from the process that has the FMU of a simulated axis."""
    rig = place / write_rig(place, "rig.toml", ideal_axis("good.fmu"))
    text = rig.read_text(encoding="utf-8").replace("000_000", '000_000\ninterface = "virtual"', 1)
    text = text.replace("[axis.Z]", "[axis.Z]\noutside = false")
    rig.write_text(text + OUTSIDE, encoding="utf-8")
    said: list[str] = []
    allow([read_settings(*read_rig(rig), [])], Outside(nullcontext, True, said.append))
    (line,) = [line for line in said if "foreign" in line]
    assert line.startswith("plant z is a foreign FMU in this process: if it ends the process")


@pytest.mark.long
def test_our_own_rows_stay_in_this_process(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_rig(place, "model.toml", Path("AxisRig.Drives.ServoAxis"))
    monkeypatch.setattr("axisrig.bench.campaign.processes._Worker.__init__", _refuse)
    campaign = run_campaign(
        [place / write_plan(place, "model.toml")],
        out=place / "results", select=Choice(), jobs=1, timeout_s=None, assignments=[],
        command=[], started="", stopwatch=lambda: 0.0, bus_logs=log_kinds(""),
    )  # fmt: skip
    assert campaign.exit_code == 0


def _refuse(*_: object) -> None:
    raise AssertionError("a process was started")


@pytest.mark.long
def test_what_an_fmu_prints_is_in_the_log_of_its_plant(
    place: Path,
    ideal_axis: Build,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Not among the lines of the program, also where the C library keeps it for a while."""
    rig = write_rig(place, "bad.toml", ideal_axis("liar.fmu", FLAW="LIES"))
    (place / "say.nc").write_text('N5 #MSG["begun"]\nN10 M30\n', encoding="utf-8")
    said = "plant z wrote to standard output: V.A.MESS.Z=1"
    monkeypatch.chdir(place)
    for words in (["nc", "say.nc", "--rig", rig], ["check", rig], ["run", write_plan(place, rig)]):
        with pytest.raises(SystemExit, match="0"):
            main(words)
        out, err = capfd.readouterr()
        if words[0] == "nc":
            assert out == "begun\n"
            assert said in err.splitlines()
        elif words[0] == "check":
            assert said in out.splitlines()
    log = (place / "out" / "plan" / "runs" / "plan-bad0.json").read_text(encoding="utf-8")
    assert said in log


@pytest.mark.long
def test_what_an_fmu_prints_without_end_fills_no_disk(
    place: Path, axisrig: Call, ideal_axis: Build
) -> None:
    rig = write_rig(place, "bad.toml", ideal_axis("chatty.fmu", FLAW="PRINTS"))
    assert axisrig("run", write_plan(place, rig), "-o", "results")[0] == 0
    log = (place / "results" / "runs" / "plan-bad0.json").read_text(encoding="utf-8")
    assert log.count("wrote to standard output: a step") == 20
    assert re.search(r"plant z wrote \d+ more lines to standard output", log)


MEDDLING = {
    "WRITES": "something in the process wrote into the channel of its answer",
    "LOWERS": "it had lowered limits of its process: RLIMIT_FSIZE to 1000",
}


@pytest.mark.long
@pytest.mark.parametrize("options", ["-j 1", "-j 2"])
def test_an_fmu_that_meddles_with_its_process_costs_its_own_row(
    place: Path, axisrig: Call, ideal_axis: Build, options: str
) -> None:
    """Neither waits anybody for its answer nor does the campaign end."""
    bad = [ideal_axis(f"{flaw.lower()}.fmu", FLAW=flaw) for flaw in MEDDLING]
    rigs = [write_rig(place, f"{fmu.stem}.toml", fmu) for fmu in bad]
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    plan = write_plan(place, *rigs, good)
    code, out, err = axisrig("run", plan, "-o", "results", *options.split())
    assert (code, "interrupted" in err) == (4, False)
    cases = pd.read_csv(place / "results" / "cases.csv")
    assert list(cases["verdict"]) == ["error", "error", "pass"], out
    for run, words in zip(cases["run"], MEDDLING.values(), strict=False):
        assert words in (place / "results" / "runs" / f"{run}.json").read_text(encoding="utf-8")


@pytest.mark.long
def test_an_fmu_that_writes_where_it_should_not_ends_nc_and_its_check_with_a_message(
    place: Path, axisrig: Call, ideal_axis: Build
) -> None:
    fmu = ideal_axis("writes.fmu", FLAW="WRITES")
    code, _, err = _nc(place, axisrig, fmu)
    assert (code, MEDDLING["WRITES"] in err) == (2, True)
    code, out, _ = axisrig("fmu", "check", fmu)
    assert (code, "wrote into the channel" in " ".join(out.split())) == (1, True)
