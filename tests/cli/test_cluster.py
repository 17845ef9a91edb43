"""`axisrig run --engine dask`: two workers on 127.0.0.1, one killed in the middle."""

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
from typing import Any

import pandas as pd
import pytest
from cli_plan import write_plan

Call = Callable[..., tuple[int, str, str]]

pytestmark = pytest.mark.long


@pytest.fixture
def cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A scheduler and two workers with caches of their own, none of them sees the plans."""
    distributed = pytest.importorskip("distributed", reason="the extra `dask` is not installed")
    monkeypatch.setenv("XDG_CACHE_HOME", os.environ.get("XDG_CACHE_HOME", ""))
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        local_directory=str(tmp_path / "workers"),
    ) as made:
        yield made


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
    table = pd.read_csv(folder / "cases.csv", dtype=str).drop(columns="wall_s")
    found["cases.csv"] = table.to_csv().encode()
    found["junit.xml"] = re.sub(rb' time="[^"]*"', b"", found["junit.xml"])
    return found


def test_a_lost_worker_costs_nothing(place: Path, cluster: Any) -> None:
    """Nothing is missing, nothing doubled, and all files are those of this machine alone."""
    rows = [f"{name},part.nc,rig.toml,{feed},== 1," for name, feed in
            zip("abcdefgh", range(1000, 5000, 500), strict=True)]  # fmt: skip
    plan = write_plan(place, *rows)
    command = [sys.executable, "-m", "axisrig.bench.cli", "run", plan, "-o"]
    subprocess.run([*command, "local"], cwd=place, check=True, capture_output=True)
    workers = [worker.process.pid for worker in cluster.workers.values()]
    with subprocess.Popen(
        [*command, "out", "--engine", "dask", "--scheduler", cluster.scheduler_address],
        cwd=place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    ) as process:  # fmt: skip
        table = place / "out" / "cases.csv"
        while process.poll() is None:
            if table.is_file() and table.read_bytes().count(b"\n") > 1:
                os.kill(workers[0], signal.SIGKILL)
                break
            time.sleep(0.01)
        text, _ = process.communicate(timeout=120)
    assert process.returncode == 0, text
    assert [row["case"] for row in _rows(place / "out")] == list("abcdefgh")
    assert _content(place / "out") == _content(place / "local")


def test_failures_and_messages_name_the_files_of_the_plan(
    place: Path, axisrig: Call, cluster: Any
) -> None:
    """Files travel: the worker has them in its cache, and what it says names those of the plan."""
    program = (place / "part.nc").read_text(encoding="utf-8")
    (place / "bad.nc").write_text(program.replace("N40 M30", "N40 Z129.5 /0\nN50 M30"), "utf-8")
    (place / "deep").mkdir()
    shutil.copy(place / "part.nc", place / "deep" / "part.nc")
    plan = write_plan(place, "a,deep/part.nc,rig.toml,3000,== 0,", "b,part.nc,rig.toml,0,== 1,")
    where = ("--engine", "dask", "--scheduler", cluster.scheduler_address)
    for out, options in (("local", ()), ("out", where)):
        assert axisrig("run", plan, "-o", out, *options)[0] == 1
    assert _content(place / "out") == _content(place / "local")
    assert str(place / "bad.nc") not in str(_rows(place / "out"))


def test_options_go_together(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    code, _, err = axisrig("run", plan, "-o", "out", "--engine", "dask")
    assert code == 2
    assert "--engine dask and --scheduler ADDRESS go together" in err
