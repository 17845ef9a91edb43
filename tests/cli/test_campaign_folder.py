"""`axisrig run` into a folder that has results, that is in use, or on a disk that is full."""

import errno
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pyarrow as pa
import pytest
from cli_plan import write_plan
from typer import Exit

from axisrig.bench import files
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.cli.options import rejecting
from axisrig.bench.record import series
from axisrig.kernel.errors import UserError

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Reject = Callable[..., str]

PASSES, FAILS = "a,part.nc,rig.toml,3000,== 1,", "b,part.nc,rig.toml,3000,== 0,"


def _verdicts(folder: Path) -> dict[str, str]:
    table = pd.read_csv(folder / "cases.csv")
    return dict(zip(table["run"], table["verdict"], strict=True))


@pytest.mark.long
def test_the_code_is_that_of_the_runs_of_this_call(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, PASSES, FAILS)
    assert axisrig("run", plan, "-o", "out")[0] == 1
    code, out, _ = axisrig("run", plan, "-o", "out", "-k", "a")
    assert code == 0
    assert "plan-b" not in out
    assert _verdicts(place / "out") == {"plan-a": "pass", "plan-b": "fail"}
    assert "plan-b" in (place / "out" / "report.html").read_text(encoding="utf-8")
    changed = write_plan(place, PASSES, FAILS.replace("== 0", "== 1"))
    assert axisrig("run", changed, "-o", "out", "-k", "b")[0] == 0
    assert _verdicts(place / "out") == {"plan-a": "pass", "plan-b": "pass"}


@pytest.mark.long
def test_a_run_that_the_plan_has_no_more_is_shown_and_does_not_count(
    place: Path, axisrig: Call
) -> None:
    axisrig("run", write_plan(place, PASSES, FAILS), "-o", "out")
    assert axisrig("run", write_plan(place, PASSES), "-o", "out")[0] == 0
    assert _verdicts(place / "out") == {"plan-a": "pass", "plan-b": "fail"}
    page = (place / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count("no longer in the plan") == 1
    assert '<span class="said">it passed</span>' in page
    assert "1 run of 2" in page  # of an earlier call, which began in the year 2...


@pytest.mark.long
def test_changed_inputs_have_a_folder_of_their_own(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, PASSES)
    assert axisrig("run", plan, "--force")[1].endswith("out/plan/report.html\n")
    changed = axisrig("run", plan, "--set", "plc:V.E.FEED=2500")
    assert changed[1].endswith("out/plan-set/report.html\n")
    assert pd.read_csv(place / "out" / "plan" / "cases.csv")["plc:V.E.FEED"][0] == 3000
    assert pd.read_csv(place / "out" / "plan-set" / "cases.csv")["plc:V.E.FEED"][0] == 2500


@pytest.mark.long
def test_another_plan_is_refused_until_the_folder_is_cleared(
    place: Path, axisrig: Call, rejected: Reject
) -> None:
    plan, other = write_plan(place, PASSES), write_plan(place, PASSES, name="other.csv")
    assert axisrig("run", plan, "-o", "out")[0] == 0
    before = (place / "out" / "cases.csv").read_bytes()
    message = rejected("run", other, "-o", "out")
    assert "another plan" in message
    assert "'other.csv'; allowed: plan.csv" in message
    assert (place / "out" / "cases.csv").read_bytes() == before
    assert axisrig("run", other, "-o", "out", "--fresh")[0] == 0
    assert _verdicts(place / "out") == {"other-a": "pass"}


def test_a_plan_that_is_refused_leaves_no_folder(place: Path, rejected: Reject) -> None:
    rejected("run", write_plan(place, PASSES.replace("3000", "much")), "-o", "out/of/today")
    assert not (place / "out").exists()


@pytest.mark.skipif(os.name != "posix", reason="kills a process")
@pytest.mark.long
def test_a_second_campaign_is_refused_as_long_as_the_first_one_lives(
    place: Path, axisrig: Call, rejected: Reject
) -> None:
    # 6 mm at 1 mm/min: six simulated minutes
    plan = write_plan(place, PASSES, "slow,part.nc,rig.toml,1,== 1,")
    first = subprocess.Popen(
        [sys.executable, "-m", "axisrig.bench.cli", "run", plan, "-o", "out", "-j", "1"],
        cwd=place,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    try:
        for _ in range(1500):
            if list((place / "out" / ".new").glob("*/bus/plan-slow.blf")):
                break
            time.sleep(0.02)
        before = _verdicts(place / "out")
        for options in ([], ["-k", "a"], ["--fresh"]):
            message = rejected("run", plan, "-o", "out", *options)
            assert f"in use: process {first.pid} on " in message
        assert _verdicts(place / "out") == before == {"plan-a": "pass"}
        assert first.poll() is None
    finally:
        os.killpg(first.pid, signal.SIGKILL)
        first.wait()
    assert axisrig("report", "out")[0] == 0
    assert axisrig("run", plan, "-o", "out", "-k", "a")[0] == 0
    assert not (place / "out" / "bus" / "plan-slow.blf").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.long
def test_a_full_disk_ends_with_4_and_names_the_file(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def opened(path: str, mode: str) -> pa.OSFile:
        return pa.OSFile("/dev/full" if Path(path).stem == "plan-b" else path, mode)

    plan = write_plan(place, PASSES, FAILS, PASSES.replace("a,", "c,", 1))
    monkeypatch.setattr(series, "OSFile", opened)
    code, out, err = axisrig("run", plan, "-o", "out", "-j", "1")
    assert code == 4
    assert "Traceback" not in out + err
    assert re.search(r"error: out/\.new/.*/traces/plan-b\.parquet: No space left on device\n", err)
    assert "interrupted: 1 of 3 runs are in out" in err
    assert _verdicts(place / "out") == {"plan-a": "pass"}
    assert out.endswith("out/report.html\n")
    assert "2 of 3 planned runs left no result" in (place / "out" / "report.html").read_text()


@pytest.mark.long
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("suffix", [".blf", ".log", ".asc", ".pcap"])
def test_a_full_disk_under_a_bus_log(place: Path, axisrig: Call, suffix: str) -> None:
    (place / f"bus{suffix}").symlink_to("/dev/full")
    words = ("nc", "part.nc", "--rig", "rig.toml", "--set", "plc:V.E.FEED=3000")
    code, _, err = axisrig(*words, "--bus-log", f"bus{suffix}")
    assert (code, err) == (4, f"error: bus{suffix}: No space left on device\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.long
def test_a_full_disk_under_the_report(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = write_plan(place, PASSES)
    assert axisrig("run", plan, "-o", "out")[0] == 0
    full = Path("/dev/full")
    monkeypatch.setattr(files, "opened_new", lambda _: full.open("w"))
    code, _, err = axisrig("report", "out")
    assert (code, err) == (4, "error: out/report.html: No space left on device\n")


def test_a_disk_that_is_full_has_code_4_whatever_is_told_of_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """An FMU that cannot be unpacked is told as such; chains may lead back to themselves."""

    def unpack(number: int) -> None:
        try:
            raise OSError(number, os.strerror(number), "file")
        except OSError as error:
            raise UserError("the FMU cannot be unpacked") from error

    def circle() -> None:
        first, second = UserError("one"), UserError("two")
        first.__cause__, second.__cause__ = second, first
        raise first

    calls = {
        4: lambda: unpack(errno.ENOSPC),
        2: lambda: unpack(errno.EACCES),
    }
    for code, call in [*calls.items(), (2, circle)]:
        with pytest.raises(Exit) as ended:
            rejecting(call)()
        assert ended.value.exit_code == code
    assert capsys.readouterr().err.count("error: ") == 3


@pytest.mark.long
def test_a_folder_that_goes_while_rows_run_ends_with_4(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An interrupted campaign, not a rejected one: something ran."""
    add = ResultsWriter.add

    def add_and_remove(writer: ResultsWriter, result: CaseResult) -> None:
        add(writer, result)
        shutil.rmtree(writer.folder)

    monkeypatch.setattr(ResultsWriter, "add", add_and_remove)
    plan = write_plan(place, PASSES, FAILS)
    code, out, err = axisrig("run", plan, "-o", "out", "-j", "1")
    assert (code, "Traceback" in out + err) == (4, False)
    assert "No such file or directory" in err
    assert "interrupted: 1 of 2 runs are in out" in err
