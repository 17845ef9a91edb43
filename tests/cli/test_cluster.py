"""`axisrig run --engine dask`: two workers on 127.0.0.1, one killed in the middle."""

import asyncio
import csv
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest
from cli_plan import write_plan

Call = Callable[..., tuple[int, str, str]]

# What a worker opens of the folder with the plans is an error: it is on another machine
DENY = """\
import sys

def look(event, arguments):
    if event == "open" and str(arguments[0]).startswith({!r}):
        raise PermissionError(f"the worker opens {{arguments[0]}}")

sys.addaudithook(look)
"""

# A cluster whose scheduler and worker are one process
SERVE = """\
import time
from distributed import LocalCluster
with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, host="127.0.0.1", protocol="tcp://",
                  dashboard_address=None) as cluster:
    print(cluster.scheduler_address, flush=True)
    time.sleep(300)
"""
OWN = """\
\"\"\"Metrics of this test.\"\"\"


def metric_broken(recording):
    return 1 / 0
"""
MIXED = """\
case,program,rig,plc:V.E.FEED,module,search:plant:probe.surface_mm,check:msg:N30,check:broken,check:search_good
a,deep/part.nc,derived.toml,3000,,,== 1,,
e,part.nc,../elsewhere/rig.toml,3000,,,== 1,,
b,part.nc,rig.toml,3000,own.py,,== 1,== 1,
c,part.nc,rig.toml,3000,,,== 0,,
d,part.nc,rig.toml,3000,,125.1 .. 129 to 0.5,== 1,,126 .. 126.5
"""


@pytest.fixture
def cluster(place: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A scheduler and two workers with an empty cache; they may open nothing below `place`."""
    distributed = pytest.importorskip("distributed", reason="the extra `dask` is not installed")
    folder = tmp_path_factory.mktemp("cluster")
    (folder / "deny.py").write_text(DENY.format(str(place)), encoding="utf-8")
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        local_directory=str(folder / "workers"),
        env={"XDG_CACHE_HOME": str(folder / "cache")},
        preload=str(folder / "deny.py"),
    ) as made:
        yield made
    assert list((folder / "cache" / "axisrig" / "cluster").iterdir())


def _rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "cases.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _content(folder: Path) -> dict[str, bytes]:
    """Every file but manifest, report and lock; without wall time."""
    found = {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name not in ("manifest.json", "report.html", ".lock")
    }
    table = pd.read_csv(folder / "cases.csv", dtype=str).drop(columns=["wall_s", "timestamp"])
    found["cases.csv"] = table.to_csv().encode()
    found["junit.xml"] = re.sub(rb' time(stamp)?="[^"]*"', b"", found["junit.xml"])
    return found


@pytest.mark.long
def test_a_lost_worker_costs_nothing(place: Path, cluster: Any) -> None:
    """Nothing is missing, nothing doubled, and all files are those of this machine alone."""
    rows = [f"{name},part.nc,rig.toml,{feed},== 1," for name, feed in
            zip("abcdefghijklmnop", range(1000, 5000, 250), strict=True)]  # fmt: skip
    plan = write_plan(place, *rows)
    command = [sys.executable, "-m", "axisrig.bench.cli", "run", plan, "-o"]
    subprocess.run([*command, "local"], cwd=place, check=True, capture_output=True)
    workers = [worker.process.pid for worker in cluster.workers.values()]
    with subprocess.Popen(
        [*command, "out", "--engine", "dask", "--scheduler", cluster.scheduler_address],
        cwd=place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    ) as process:  # fmt: skip
        table = place / "out" / "cases.csv"
        ended = 0
        while process.poll() is None and ended == 0:
            time.sleep(0.01)
            ended = max(0, table.read_bytes().count(b"\n") - 1) if table.is_file() else 0
        os.kill(workers[0], signal.SIGKILL)
        text, _ = process.communicate(timeout=120)
    assert 0 < ended < len(rows)
    assert process.returncode == 0, text
    assert [row["case"] for row in _rows(place / "out")] == list("abcdefghijklmnop")
    assert _content(place / "out") == _content(place / "local")


@pytest.mark.long
def test_failures_and_messages_name_the_files_of_the_plan(
    place: Path, axisrig: Call, cluster: Any
) -> None:
    """Files travel: the worker has them in its cache, and what it says names those of the plan.

    A program in a folder, a rig with a base, one outside the folder of the plan, a metric of an own
    file that breaks, a search.
    """
    shutil.copytree(place, place.parent / "elsewhere")
    (place / "deep").mkdir()
    shutil.copy(place / "part.nc", place / "deep" / "part.nc")
    (place / "derived.toml").write_text('base = "rig.toml"\ntitle = "derived"\n', "utf-8")
    (place / "own.py").write_text(OWN, encoding="utf-8")
    (place / "plan.csv").write_text(MIXED, encoding="utf-8")
    where = ("--engine", "dask", "--scheduler", cluster.scheduler_address)
    for out, options in (("local", ()), ("out", where)):
        assert axisrig("run", "plan.csv", "-o", out, *options)[0] == 4
    assert _content(place / "out") == _content(place / "local")
    verdicts = {row["case"]: row["verdict"] for row in _rows(place / "out") if not row["probe"]}
    assert verdicts == {"a": "pass", "e": "pass", "b": "error", "c": "fail", "d": "pass"}
    reasons = (place / "out" / "results.csv").read_text(encoding="utf-8")
    assert "own.py:5" in reasons, reasons


def test_options_go_together(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    code, _, err = axisrig("run", plan, "-o", "out", "--engine", "dask")
    assert code == 2
    assert "--engine dask and --scheduler ADDRESS go together" in err


@pytest.mark.long
def test_a_scheduler_that_is_lost_leaves_what_has_ended(place: Path, axisrig: Call) -> None:
    """The campaign is interrupted, the runs that ended are there, and `--resume` does the rest."""
    pytest.importorskip("distributed", reason="the extra `dask` is not installed")
    rows = [f"r{number},part.nc,rig.toml,{1000 + number},== 1," for number in range(24)]
    plan = write_plan(place, *rows)
    serve = [sys.executable, "-c", SERVE]
    with subprocess.Popen(serve, stdout=subprocess.PIPE, text=True, cwd=place) as server:
        assert server.stdout is not None
        address = server.stdout.readline().strip()
        command = [sys.executable, "-m", "axisrig.bench.cli", "run", plan, "-o", "out"]
        with subprocess.Popen(
            [*command, "--engine", "dask", "--scheduler", address],
            cwd=place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        ) as process:  # fmt: skip
            table = place / "out" / "cases.csv"
            while process.poll() is None:
                if table.is_file() and table.read_bytes().count(b"\n") > 1:
                    break
                time.sleep(0.01)
            server.kill()
            text, _ = process.communicate(timeout=120)
    assert process.returncode == 4, text
    assert "is lost; `axisrig run --resume` runs the rest" in text
    ended = len(_rows(place / "out"))
    assert 0 < ended < len(rows)
    assert axisrig("run", plan, "-o", "out", "--resume")[0] == 0
    assert len(_rows(place / "out")) == len(rows)


def test_without_dask_it_says_what_to_install(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    monkeypatch.setitem(sys.modules, "distributed", None)
    where = ("--engine", "dask", "--scheduler", "tcp://127.0.0.1:8786")
    code, _, err = axisrig("run", plan, "-o", "out", *where)
    assert code == 2
    assert "pip install 'axisrig[dask]'" in err


class _Lost:
    """A cluster whose scheduler goes away in one of the ways in which that can be noticed."""

    def __init__(self, way: str) -> None:
        self.way, self.status, self.loop = way, "lost" if way == "status" else "finished", None

    def client(self, *_: object, **__: object) -> "_Lost":
        return self

    def submit(self, *_: object, **__: object) -> "_Lost":
        return self

    def as_completed(self, *_: object, **__: object) -> Iterator["_Lost"]:
        if self.way == "waiting":
            raise OSError("the stream is closed")
        yield self

    def result(self) -> bytes:
        raise asyncio.CancelledError if self.way == "cancelled" else OSError("no answer")

    def cancel(self, *_: object) -> None:
        raise OSError("what is cancelled at the end")

    def close(self) -> None:
        raise TimeoutError


@pytest.mark.parametrize("way", ["status", "waiting", "cancelled", "result"])
def test_why_a_campaign_on_a_cluster_ended_is_said_whatever_comes_after_it(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    lost = _Lost(way)
    made = SimpleNamespace(Client=lost.client, as_completed=lost.as_completed)
    monkeypatch.setitem(sys.modules, "distributed", made)
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    where = ("--engine", "dask", "--scheduler", "tcp://127.0.0.1:8786")
    code, _, err = axisrig("run", plan, "-o", "out", *where)
    assert code == 4
    assert "error: the output: the scheduler tcp://127.0.0.1:8786 is lost" in err
    assert "interrupted: 0 of 1 runs are in out" in err
