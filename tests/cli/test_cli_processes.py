"""The command line in processes of its own: pipes, encodings, Ctrl-C, a killed worker."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import pytest
from cli_plan import write_plan


def _command(*words: str) -> list[str]:
    return [sys.executable, "-m", "axisrig.bench.cli", *words]


def _environment(**more: str) -> dict[str, str]:
    return {**os.environ, "COLUMNS": "120", **more}


def _hear_ctrl_c() -> None:
    """A shell lets its background jobs ignore SIGINT, and their children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextmanager
def _started(place: Path, words: Sequence[str]) -> Iterator[subprocess.Popen[str]]:
    """A process in a group of its own, ended with the test whatever happens."""
    process = subprocess.Popen(
        _command(*words),
        cwd=place,
        env=_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=_hear_ctrl_c if os.name == "posix" else None,  # noqa: PLW1509 - no threads
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def _wait_for_rows(folder: Path, rows: int) -> None:
    for _ in range(1500):
        path = folder / "cases.csv"
        if path.is_file() and path.read_text(encoding="utf-8").count("\n") > rows:
            return
        time.sleep(0.02)
    pytest.fail(f"no {rows} rows in {folder}")


posix = pytest.mark.skipif(os.name != "posix", reason="signals and pipes of POSIX")


@pytest.mark.long
@posix
@pytest.mark.parametrize("words", [["nc", "many.nc", "--rig", "rig.toml"], ["check", "rig.toml"]])
def test_reader_that_goes_away_is_no_rejection(place: Path, words: list[str]) -> None:
    lines = "".join(f'N{n} #MSG SYN["{n}"]\n' for n in range(10, 3000))
    (place / "many.nc").write_text(f"{lines}M30\n", encoding="utf-8")
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w") as pipe:
        ended = subprocess.run(
            _command(*words), cwd=place, env=_environment(), stdout=pipe, stderr=subprocess.PIPE,
            text=True, check=False,
        )  # fmt: skip
    progress = ("checking ", "running ")
    assert [line for line in ended.stderr.splitlines() if not line.startswith(progress)] == []
    assert ended.returncode not in (1, 2)


@pytest.mark.long
@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "ascii"])
def test_terminal_that_lacks_the_signs(place: Path, encoding: str) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 0,")
    ended = subprocess.run(
        _command("run", plan, "-o", "out"),
        cwd=place,
        env=_environment(PYTHONIOENCODING=encoding, PYTHONUTF8="0"),
        capture_output=True,
        check=False,
    )
    assert ended.returncode == 1
    assert b"Traceback" not in ended.stderr
    assert b"msg:N30" in ended.stdout
    assert (place / "out" / "report.html").is_file()


@pytest.mark.long
@posix
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_ctrl_c_keeps_what_is_there_and_stops_the_rest(place: Path, jobs: str) -> None:
    quick = "a,part.nc,rig.toml,3000,== 1,"
    # 6 mm at 1 mm/min: six simulated minutes that must not be waited for
    slow = [f"s{n},part.nc,rig.toml,1,== 1," for n in range(4)]
    plan = write_plan(place, quick, *slow)
    words = ["run", plan, "-o", "out", "-j", jobs, "--timeout", "600"]
    with _started(place, words) as process:
        _wait_for_rows(place / "out", 1)
        time.sleep(0.2)
        os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=15)
    assert process.returncode == 4
    assert "Traceback" not in out + err
    assert "interrupted" in err
    assert "out" in err.rpartition("interrupted")[2]  # where the results are
    cases = pd.read_csv(place / "out" / "cases.csv")
    assert list(cases["run"]) == ["plan-a"]
    assert [path.stem for path in (place / "out" / "bus").iterdir()] == ["plan-a"]
    manifest = json.loads((place / "out" / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["finished"] is False
    assert manifest["runs_planned"] == 5


@pytest.mark.long
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="finds the workers in /proc")
def test_killed_worker_costs_its_row_only(place: Path) -> None:
    rows = ["slow,part.nc,rig.toml,1,== 1,"]
    rows += [f"q{n},part.nc,rig.toml,3000,== 1," for n in range(3)]
    plan = write_plan(place, *rows)
    with _started(place, ["run", plan, "-o", "out", "-j", "2"]) as process:
        for _ in range(1500):
            if list((place / "out" / "bus").glob("plan-q2.blf")):
                break
            time.sleep(0.02)
        time.sleep(0.5)
        listed = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text()
        busy = max(map(int, listed.split()), key=_cpu_ticks)
        os.kill(busy, signal.SIGKILL)
        out, err = process.communicate(timeout=15)
    assert process.returncode == 4, out + err
    assert "Traceback" not in out + err
    cases = pd.read_csv(place / "out" / "cases.csv").set_index("case")["verdict"]
    assert dict(cases) == {"slow": "error", "q0": "pass", "q1": "pass", "q2": "pass"}


def _cpu_ticks(pid: int) -> int:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])
