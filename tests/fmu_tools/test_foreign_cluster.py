"""A foreign FMU on a dask worker: what crashes or hangs costs its own row, and no worker."""

import sys
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest
from fmu_rigs import write_plan, write_rig

Call = Callable[..., tuple[int, str, str]]
Build = Callable[..., Path]

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(sys.platform == "win32", reason="the FMUs end by POSIX signals"),
]


def test_a_crash_and_a_hang_cost_their_rows(place: Path, axisrig: Call, ideal_axis: Build) -> None:
    distributed = pytest.importorskip("distributed", reason="the extra `dask` is not installed")
    good = write_rig(place, "good.toml", ideal_axis("good.fmu"))
    bad = [
        write_rig(place, f"{how.lower()}.toml", ideal_axis(f"{how.lower()}.fmu", **fault))
        for how, fault in (
            ("CRASH", {"CRASH_IN": "STEP", "CRASH_AT_S": 0.005}),
            ("HANG", {"CRASH_IN": "STEP", "CRASH_HOW": "HANG", "CRASH_AT_S": 0.005}),
        )
    ]
    plan = write_plan(place, good, *bad, good)
    limit = ("--call-timeout", "1")
    assert axisrig("run", plan, "-o", "local", *limit)[0] == 4
    with distributed.LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        local_directory=str(place / "workers"),
    ) as cluster:
        before = [worker.process.pid for worker in cluster.workers.values()]
        where = ("--engine", "dask", "--scheduler", cluster.scheduler_address)
        code, out, _ = axisrig("run", plan, "-o", "out", *limit, *where)
        assert [worker.process.pid for worker in cluster.workers.values()] == before
    assert code == 4
    assert "crashed in fmi3DoStep" in out
    assert "a call did not come back within 1 s" in out
    columns = ["run", "verdict", "frame_log_sha256", "depends_sha256"]
    here, there = (pd.read_csv(place / name / "cases.csv")[columns] for name in ("local", "out"))
    assert list(there["verdict"]) == ["pass", "error", "error", "pass"]
    pd.testing.assert_frame_equal(here, there)
