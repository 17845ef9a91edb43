"""Write a results folder of many runs made of formulas, to measure what reads one.

    python tests/tools/many_runs.py DIR [--runs 1000] [--samples 20000]

Each run is a probing move of Z with five signals beside its time; one in 25 fails. Runs share
series: the same 20 follow each other, as hard links.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa

from axisrig.bench.campaign.results.layout import TRACES
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.plan.checks import Value, judge
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import worst
from axisrig.bench.record.axes import AxisRecord, Contact, Edge, Latch, ProbeRecord
from axisrig.bench.record.blocks import BlockTrace, ProgramLine, pack_rows
from axisrig.bench.record.facts import Facts, Timing
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import Series, SeriesWriter

MS = 1_000_000
DIFFERENT = 20
_FAILS_EVERY = 25
_SURFACE_MM = 40.0
_AXIS = AxisRecord("can1", 3, 10_000.0)
_HEAD = (
    "case,program,rig,title,tags,requirement,plc:V.E.FEED,check:latch_error_um:Z,check:lag_mm_max:Z"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the folder; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=20_000)
    chosen = parser.parse_args(arguments)
    print(write_many(chosen.folder, chosen.runs, chosen.samples))
    return 0


def write_many(folder: Path, runs: int, samples: int) -> Path:
    """Write plan, program and rig into `folder` and the results into `folder/out`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "touch.nc").write_text("N10 G100 Z0 F600\n", encoding="utf-8")
    (folder / "machine.toml").write_text("[machine]\n", encoding="utf-8")
    rows = [
        f"touch-{n:04},touch.nc,machine.toml,Touch at {300 + n} mm/min,feed t{n % 7},"
        f"REQ-{n % 40},{300 + n},-0.2 .. 0.2,<= 0.5"
        for n in range(runs)
    ]
    (folder / "many.csv").write_text("\n".join([_HEAD, *rows]) + "\n", encoding="utf-8")
    plan = read_plan(folder / "many.csv")
    manifest = build_manifest(
        [plan], command=["axisrig", "run", "many.csv", "-o", "out"], started="2026-11-24",
        output="out",
    )  # fmt: skip
    with ResultsWriter(folder / "out", [plan], manifest) as writer:
        series: list[Path] = []
        for case in plan.cases:
            path = writer.files_of(case.run).trace
            assert path is not None
            if case.index < DIFFERENT:
                _write_series(path, samples, seed=case.index)
                series.append(folder / "out" / TRACES / path.name)  # where it is once added
            else:
                os.link(series[case.index % len(series)], path)
            is_bad = case.index % _FAILS_EVERY == 3
            values: dict[str, tuple[Value, float]] = {
                "latch_error_um:Z": (0.31 if is_bad else 0.02, 0.01),
                "lag_mm_max:Z": (0.3, 0.0),
                "alarms": ([], 0.0),
            }
            checks = [judge(check, *values[check.metric]) for check in case.checks]
            facts = replace(_facts(samples), frame_log_sha256=f"{case.index:064x}")
            verdict = worst(check.verdict for check in checks)
            writer.add(CaseResult(case, verdict, checks, facts=facts, series=Series(path)))
    return folder / "out"


def _write_series(path: Path, samples: int, seed: int) -> None:
    """Z runs at 10 mm/s to the surface with a lag of 0.25 mm and stays there; noise of a nm."""
    noise = np.random.default_rng(seed)
    time_s = np.arange(samples) * 0.001
    set_mm = _SURFACE_MM + np.clip(10.0 * (0.6 * time_s[-1] - time_s), 0.0, None)
    lag = 0.25 * (set_mm > _SURFACE_MM) + 2e-5 * np.sin(2 * np.pi * 60 * time_s)
    truth = set_mm + lag + noise.normal(0.0, 1e-6, samples)
    actual = np.round(truth / 1e-4) * 1e-4
    columns = {
        "time_ns": (np.arange(samples) * MS).astype(np.int64),
        "Z.set_mm": set_mm,
        "Z.actual_mm": actual,
        "Z.truth_mm": truth,
        "Z.cnc_lag_mm": set_mm - actual,
        "Z.velocity_mm_s": np.gradient(truth, 0.001),
    }
    writer = SeriesWriter(path)
    writer.add({name: pa.array(values) for name, values in columns.items()})
    writer.close()


def _blocks(contact_ns: int) -> BlockTrace:
    """A program of a dozen blocks, the measurement run among them."""
    lines = [ProgramLine("touch.nc", n, 10 * n, f"N{10 * n} G1 Z{140 - n} F600") for n in range(12)]
    lines[5] = ProgramLine("touch.nc", 5, 50, "N50 G100 Z0 F600")
    begin = np.arange(12) * 1.0 * MS
    begin[6:] = contact_ns + 150 * MS + begin[6:]
    end = np.append(begin[1:], begin[-1] + MS)
    whole = [np.arange(12), np.arange(12) == 5, begin, begin, end, np.arange(12) == 5]
    columns = np.array([*whole, np.full(12, 600.0), np.full(12, 1.0), np.full(12, 1.0)])
    return BlockTrace(tuple(lines), ("feed", "measurement run"), 12, pack_rows(columns))


def _facts(samples: int) -> Facts:
    """A touch at 60 % of the time."""
    contact = round(0.6 * (samples - 1)) * MS
    edges = (Edge(contact + 3_000, True),)
    run = MeasurementRun(
        ("Z",), inputs={"Z": 1}, begin_ns=MS, signal_ns=contact + 2 * MS, end_ns=contact + 150 * MS
    )
    return Facts(
        Timing(MS, 600_000, 2),
        sim_ns=samples * MS,
        start_ns=0,
        end_ns=samples * MS,
        frame_log_sha256="",
        axes={"Z": replace(_AXIS, latches=(Latch(contact + 4_000, 1),))},
        probes={"probe": ProbeRecord(True, 1.0, (Contact(contact, {"Z": _SURFACE_MM}),), edges)},
        runs=(run,),
        blocks=_blocks(contact),
    )


if __name__ == "__main__":
    sys.exit(main())
