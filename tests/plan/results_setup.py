"""Results of runs that were never run, and a folder written with them."""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from axisrig.bench.record.event import Event

from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter, build_manifest
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import Case, Plan

TEXT = (
    "case,program,rig,title,requirement,set:Z.edge,check:latch_error_um:Z,check:lag_mm_max:Z\n"
    "a,probe.nc,machine.toml,first,REQ-1,NEG,<= 0.5,<= 2\n"
    "b,probe.nc,machine.toml,second,,,-1 .. 1,\n"
    "c,probe.nc,machine.toml,third,,POS,!= 3,\n"
)


def run_case(case: Case, error_um: float | None = 0.1) -> CaseResult:
    values: dict[str, Any] = {"latch_error_um:Z": error_um, "lag_mm_max:Z": 1.7, "alarms": []}
    checks = [judge(check, values[check.metric], 0.0, "why") for check in case.checks]
    trace = pa.table(
        {
            "time_ns": np.arange(5, dtype=np.int64) * 1_000_000,
            "Z.set_mm": np.linspace(0.0, 0.1, 5),
            "probe.signal": np.array([0, 0, 1, 1, 1], dtype=np.int8),
        }
    )
    return CaseResult(
        case,
        max(item.verdict for item in checks),
        checks,
        sim_s=0.005,
        frame_log_sha256="ab" * 32,
        trace=trace,
        events=[Event(2_000_000, "latch", "latch", "Z"), Event(1_000_000, "edge", "edge", "Z")],
        messages=["Z 67.0 \x00 <&>"],
    )


def write(
    folder: Path,
    plan: Plan,
    order: Sequence[int],
    error_um: float | None = 0.1,
    *,
    is_part: bool = False,
    is_fresh: bool = False,
) -> Path:
    """Write runs of a plan; is_part: the call was for these alone."""
    manifest = build_manifest([plan], command=["axisrig"], started="then", output="out")
    runs = [plan.cases[index].run for index in order] if is_part else None
    with ResultsWriter(folder, [plan], manifest, runs=runs, is_fresh=is_fresh) as writer:
        for index in order:
            writer.add(run_case(plan.cases[index], error_um))
    return folder


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
