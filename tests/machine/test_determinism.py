"""The same inputs give the same frames and the same files, whoever runs them and how often."""

import csv
import hashlib
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.plan.plan import read_plan

Run = Callable[..., Any]
ROOT = Path(__file__).parents[2]
PLAN = """\
case,program,rig,repeats,plc:V.E.FEED,plant:probe.surface_mm,fault:drop,check:latch_error_um,check:alarms
one,{one},{plans}/rigs/probe-z.toml,2,3000,108,,-0.2 +- 0.0095,none
lost,{one},{plans}/rigs/probe-z.toml,,6000,109,Z.TPDO2,,900006
three,{three},{plans}/rigs/probe-xyz.toml,,,245,,<= 1,none
"""
ONE = '%one\nN10 G100 Z100 F=V.E.FEED\n#MSG SYN["z=%f", V.A.MESS.Z]\nN30 M30\n'
THREE = '%three\n#CS ON[0,0,0,0,5,0]\nN10 G91 G100 Z-12 F3000\n#MSG SYN["x=%f", V.A.MESS.X]\nM30\n'


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plan")
    (folder / "one.nc").write_text(ONE.replace("G100", "G90 G100"), encoding="utf-8")
    (folder / "three.nc").write_text(THREE, encoding="utf-8")
    path = folder / "same.csv"
    text = PLAN.format(one=folder / "one.nc", three=folder / "three.nc", plans=ROOT / "testplans")
    path.write_text(text, encoding="utf-8")
    return path


def _run(plan: Path, place: Path, jobs: int, seed: str) -> Path:
    """Run the plan in a process of its own with a hash seed; return its results."""
    folder = place / "same"
    command = [sys.executable, "-m", "axisrig.bench.cli", "run", str(plan), "-o", str(folder)]
    done = subprocess.run(
        [*command, "-j", str(jobs), "--bus-log", "blf,candump,pcap"],
        env={**os.environ, "PYTHONHASHSEED": seed},
        cwd=place,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def first(plan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of one process."""
    return _run(plan, tmp_path_factory.mktemp("first"), 1, "0")


def _cases(folder: Path) -> list[dict[str, str]]:
    with (folder / "cases.csv").open(encoding="utf-8", newline="") as file:
        return [
            {name: value for name, value in row.items() if name not in ("wall_s", "timestamp")}
            for row in csv.DictReader(file)
        ]


def _timeless(path: Path) -> bytes:
    content = path.read_bytes()
    return re.sub(rb' time(stamp)?="[^"]*"', b"", content) if path.name == "junit.xml" else content


def _bytes(folder: Path) -> dict[str, str]:
    """Hash of every file but those that say when and how it was run; JUnit without time."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {
        str(path.relative_to(folder)): hashlib.sha256(_timeless(path)).hexdigest()
        for path in files
        if path.name not in ("cases.csv", "manifest.json", "report.html")
    }


@pytest.mark.long
def test_processes_and_hash_seeds_do_not_show_in_any_file(
    plan: Path, first: Path, tmp_path: Path
) -> None:
    """Two processes, with another hash seed each."""
    other = _run(plan, tmp_path, 2, "4711")
    known = _bytes(first)
    runs = {row["run"] for row in _cases(first)}
    assert len(runs) == 4
    expected = {"results.csv", "junit.xml", "inputs.json", "plans/same.csv"}
    expected |= {f"traces/{run}.parquet" for run in runs}
    expected |= {f"runs/{run}.json" for run in runs}
    expected |= {f"bus/{run}{suffix}" for run in runs for suffix in (".blf", ".log")}
    for run in runs:
        segments = ("@can1", "@can2", "@can3") if "three" in run else ("",)
        expected |= {f"bus/{run}{segment}.pcap" for segment in segments}
    assert set(known) == expected
    assert _bytes(other) == known
    assert _cases(other) == _cases(first)


@pytest.mark.long
def test_this_process_gives_the_same_frames_twice(plan: Path, first: Path) -> None:
    recorded = [row["frame_log_sha256"] for row in _cases(first)]
    cases = read_plan(plan).cases
    for _ in range(2):
        assert [run_case(case, RunFiles()).frame_log_sha256 for case in cases] == recorded


@pytest.mark.long
def test_the_hash_tells_different_runs_apart(first: Path) -> None:
    """Repeats are the same run again; every other row has its own frames."""
    hashes = {row["run"]: row["frame_log_sha256"] for row in _cases(first)}
    assert len(hashes) == 4
    assert len(set(hashes.values())) == 3
    assert all(len(value) == 64 for value in hashes.values())


@pytest.mark.long
def test_one_increment_of_the_workpiece_shows_in_the_hash(run_nc: Run) -> None:
    surfaces = (125.0, 125.0, 125.0 + 1.5 * 10 / 2**20)
    digests = [
        run_nc(
            "N10 G100 Z120 F3000",
            f"[plant.probe]\nstart = {{ surface_mm = {surface!r} }}",
            base="probe-z.toml",
        ).machine.hexdigest()
        for surface in surfaces
    ]
    assert digests[0] == digests[1] != digests[2]
