"""Results of runs that were never run, and a folder written with them."""

import csv
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import Plan
from axisrig.bench.record.axes import AxisRecord, Edge, Latch, ProbeRecord
from axisrig.bench.record.facts import Facts, MessageRecord

PlanWriter = Callable[..., Path]

posix = pytest.mark.skipif(os.name != "posix", reason="forks")

TEXT = (
    "case,program,rig,title,requirement,set:Z.edge,check:latch_error_um:Z,check:lag_mm_max:Z\n"
    "a,probe.nc,machine.toml,first,REQ-1,NEG,<= 0.5,<= 2\n"
    "b,probe.nc,machine.toml,second,,,-1 .. 1,\n"
    "c,probe.nc,machine.toml,third,,POS,!= 3,\n"
)


def left(message: str = "Z 67.0 \x00 <&>") -> Facts:
    """What each of the runs leaves beside its series: an edge, a latch and a message."""
    probe = ProbeRecord(True, 1.0, edges=(Edge(1_000_000, True),))
    axis = AxisRecord("can1", 1, 10_000.0, latches=(Latch(2_000_000, 1),))
    messages = (MessageRecord(None, (), message),)
    return facts(axes={"Z": axis}, probes={"probe": probe}, messages=messages)


def add(
    writer: ResultsWriter, case: Case, error_um: float | None = 0.1, message: str | None = None
) -> None:
    """Write a run with its series, as one that has been run does."""
    result = run_case(case, error_um, writer.files_of(case.run).trace)
    writer.add(result if message is None else replace(result, facts=left(message)))


def run_case(case: Case, error_um: float | None = 0.1, file: Path | None = None) -> CaseResult:
    """A run with its value; file: of its series, None to keep them in memory."""
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
        facts=left(),
        series=kept(trace, file),
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
            add(writer, plan.cases[index], error_um)
    return folder


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def contents(folder: Path) -> dict[str, bytes]:
    """Every file but the manifest."""
    paths = [p for p in folder.rglob("*") if p.is_file() and p.name != "manifest.json"]
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in paths}


def manifest(folder: Path) -> dict[str, object]:
    content: dict[str, object] = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    return content
