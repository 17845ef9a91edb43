"""`--isolate`: an FMU that crashes, ends the process or hangs costs its own case only."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest
from fmu_rigs import write_plan, write_rig

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Build = Callable[..., Path]

CRASHES = {
    "LOAD": "load",
    "INSTANTIATE": "fmi3InstantiateCoSimulation",
    "INITIALIZE": "fmi3ExitInitializationMode",
    "SET": "fmi3SetFloat64",
    "GET": "fmi3GetFloat64",
    "STEP": "fmi3DoStep",
    "TERMINATE": "fmi3Terminate",
    "FREE": "fmi3FreeInstance",
}
SIGNALS = {"SEGFAULT": "SIGSEGV", "ABORT": "SIGABRT", "KILL": "SIGKILL"}

pytestmark = pytest.mark.skipif(
    sys.platform == "win32", reason="the FMUs of this test end by POSIX signals"
)


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("crash_in", "function"), CRASHES.items())
def test_a_crash_is_told_with_file_instance_and_call(
    place: Path, axisrig: Call, ideal_axis: Build, crash_in: str, function: str
) -> None:
    at_s = 0.005 if crash_in in ("SET", "GET", "STEP") else 0
    bad = ideal_axis("bad.fmu", CRASH_IN=crash_in, CRASH_AT_S=at_s)
    rig = write_rig(place, "bad.toml", bad)
    code, out, err = axisrig("nc", "move.nc", "--rig", rig, "--isolate")
    assert (code, out) == (2, "")
    message = f"FMU bad.fmu (plant z) crashed in {function} at t = "
    assert message in err
    assert "SIGSEGV, it reached for memory that is not its own" in err
    if at_s:
        time_ms = float(err.partition(message)[2].split()[0])
        # The drive hands its demand over with each SYNC, and the first one follows the start-up
        assert 4.9 < time_ms < 20


@pytest.mark.long
@pytest.mark.parametrize("how", [*SIGNALS, "EXIT"])
def test_finished_cases_stay_and_the_others_go_on(
    place: Path, axisrig: Call, ideal_axis: Build, how: str
) -> None:
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    bad = ideal_axis("bad.fmu", CRASH_IN="STEP", CRASH_HOW=how, CRASH_AT_S=0.005)
    plan = write_plan(place, good, write_rig(place, "bad.toml", bad), good)
    code, out, _ = axisrig("run", plan, "--isolate", "-o", "results")
    assert code == 4
    cases = pd.read_csv(place / "results" / "cases.csv")
    assert list(cases["verdict"]) == ["pass", "error", "pass"]
    assert cases["frame_log_sha256"][0] == cases["frame_log_sha256"][2]
    found = "ended the process in fmi3DoStep" if how == "EXIT" else "crashed in fmi3DoStep"
    assert re.search(rf"FMU bad.fmu \(plant z\) {found} at t = [5-9]\.\d+ ms: ", out)
    assert SIGNALS.get(how, "exit code 3") in out
    assert "pass" in (place / "results" / "report.html").read_text(encoding="utf-8")
    code, out, err = axisrig("replay", "results", cases["run"][1], "--isolate")
    assert (code, out) == (2, "")
    assert found in err
    code, out, _ = axisrig("replay", "results", cases["run"][0], "--isolate")
    assert (code, out.splitlines()[-1]) == (0, "frame_log_sha256 equal")


@pytest.mark.long
def test_several_processes_name_the_fmu_too(place: Path, axisrig: Call, ideal_axis: Build) -> None:
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    bad = ideal_axis("bad.fmu", CRASH_IN="STEP", CRASH_AT_S=0.005)
    plan = write_plan(place, *[good, write_rig(place, "bad.toml", bad)] * 3)
    code, out, _ = axisrig("run", plan, "-j", "2", "-o", "results")
    assert code == 4
    cases = pd.read_csv(place / "results" / "cases.csv")
    assert list(cases["verdict"]) == ["pass", "error"] * 3
    named = re.findall(r"FMU bad.fmu \(plant z\) crashed in fmi3DoStep at t = [5-9]\.", out)
    assert len(named) == 3 * 2  # in the table, and as the cause after it


@pytest.mark.long
@pytest.mark.parametrize(
    ("crash_in", "options"), [("STEP", ["--isolate"]), ("STEP", []), ("INITIALIZE", [])]
)
def test_a_call_that_does_not_come_back_is_ended(
    place: Path, axisrig: Call, ideal_axis: Build, crash_in: str, options: list[str]
) -> None:
    """A limit of a call wants a process apart, so that it is taken without being asked for."""
    at_s = 0.005 if crash_in == "STEP" else 0
    bad = ideal_axis("bad.fmu", CRASH_IN=crash_in, CRASH_HOW="HANG", CRASH_AT_S=at_s)
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    plan = write_plan(place, write_rig(place, "bad.toml", bad), good)
    code, out, _ = axisrig("run", plan, *options, "--call-timeout", "1", "-o", "results")
    assert code == 4
    assert list(pd.read_csv(place / "results" / "cases.csv")["verdict"]) == ["error", "pass"]
    assert f"a call did not come back within 1 s: it was in {CRASHES[crash_in]} at t = " in out
    assert "of plant z (bad.fmu)" in out


@pytest.mark.long
def test_a_time_out_of_the_whole_case_names_the_call(
    place: Path, axisrig: Call, ideal_axis: Build
) -> None:
    """4 s of wall time are enough to come to the step on a busy machine too."""
    bad = ideal_axis("bad.fmu", CRASH_IN="STEP", CRASH_HOW="HANG", CRASH_AT_S=0.005)
    plan = write_plan(place, write_rig(place, "bad.toml", bad))
    code, out, _ = axisrig("run", plan, "--timeout", "4", "-o", "results")
    assert code == 4
    assert re.search(r"no end within 4 s of wall time: it was in fmi3DoStep at t = [5-9]\.", out)


@pytest.mark.long
def test_isolated_results_are_those_of_one_process(
    place: Path, axisrig: Call, ideal_axis: Build
) -> None:
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    plan = write_plan(place, good)
    hashes = []
    for number, options in enumerate([[], ["--isolate"], ["--isolate", "-j", "2"]]):
        assert axisrig("run", plan, *options, "-o", f"out{number}")[0] == 0
        cases = pd.read_csv(place / f"out{number}" / "cases.csv")
        hashes.append(cases["frame_log_sha256"][0])
    assert len(set(hashes)) == 1


def test_what_is_wrong_before_the_run_is_rejected_as_without_isolation(
    place: Path, axisrig: Call, ideal_axis: Build
) -> None:
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    plan = write_plan(place, good, "none.toml")
    plain = axisrig("run", plan, "-o", "results")
    assert axisrig("run", plan, "--isolate", "-o", "results") == plain
    assert plain[0] == 2
    assert not (place / "results").exists()


def _nc_apart(place: Path, rig: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """`nc --isolate` as a program of its own: its outputs are those of two processes."""
    return subprocess.run(
        [
            *(
                sys.executable,
                "-m",
                "axisrig.bench.cli",
                "nc",
                "move.nc",
                "--rig",
                rig,
                "--isolate",
            ),
            *("--set", "set:channel.meas_error_no_signal=1"),
        ],
        cwd=place,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.long
def test_nc_shows_messages_and_alarms_of_the_process_apart(place: Path, ideal_axis: Build) -> None:
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    (place / "move.nc").write_text('N10 #MSG["%d",1+1]\nN20 G100 Z131 F6000\nN30 M30\n')
    ended = _nc_apart(place, good)
    assert (ended.returncode, ended.stdout) == (1, "2\n")
    assert "ID " in ended.stderr


@pytest.mark.long
def test_check_of_a_rig_may_be_isolated_too(place: Path, axisrig: Call, ideal_axis: Build) -> None:
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    bad = write_rig(place, "bad.toml", ideal_axis("bad.fmu", CRASH_IN="INITIALIZE"))
    assert axisrig("check", good, "--isolate") == axisrig("check", good)
    code, out, err = axisrig("check", bad, "--isolate")
    assert (code, out) == (2, "")
    assert err.startswith("error: bad.toml: FMU bad.fmu (plant z) crashed in fmi3ExitInit")


@pytest.mark.long
def test_of_a_crash_stays_one_message_and_nothing_on_the_disk(
    place: Path, ideal_axis: Build
) -> None:
    """Also where Python is told to print its stack at a crash: that of the bench helps nobody."""
    rig = write_rig(place, "bad.toml", ideal_axis("bad.fmu", CRASH_IN="INITIALIZE"))
    scratch = place / "scratch"
    scratch.mkdir()
    ended = _nc_apart(place, rig, TMPDIR=str(scratch), PYTHONFAULTHANDLER="1")
    *progress, message = ended.stderr.splitlines()
    assert all(line.startswith("running move.nc on bad.toml") for line in progress)
    assert message.startswith("error: move.nc: FMU bad.fmu (plant z) crashed"), ended
    assert list(scratch.iterdir()) == []
