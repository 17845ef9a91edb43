"""The stages of a next run: what it takes on a warm bench that is not its simulation."""

import gc
import tempfile
from pathlib import Path
from statistics import median
from typing import Any

from axisrig.bench.campaign import runner
from axisrig.bench.campaign.results import writer
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.writer import ResultsWriter
from axisrig.bench.machine import machine
from axisrig.bench.machine.machine import Machine
from axisrig.bench.record.series import SeriesWriter
from axisrig.bench.tools.perf import perf
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.bench.tools.perf.perf import Parts, Row, build, build_line, counters

SIMULATION, REST = "simulation", "columns of the trace, and what is between the stages"
STAGES: Parts = {
    "files of the run before removed": [(writer, "clear")],
    "folder locked, and looked at": [
        (FolderLock, "__enter__"),
        (FolderLock, "__exit__"),
        (writer, "refuse_folder"),
    ],
    "folder: plan, tables, manifest, junit.xml": [
        (ResultsWriter, "__init__"),
        (ResultsWriter, "close"),
    ],
    "files that the row is made of, as they were?": [(perf, "prepare"), (runner, "recall")],
    "plants: FMUs reset and started": [(machine, "build_plant"), (machine, "start_plant")],
    "machine built besides": [(runner, "Machine")],
    SIMULATION: [(Machine, "run")],
    "facts": [(runner, "facts_of")],
    "trace: last block (Parquet, LZ4)": [(SeriesWriter, "add"), (SeriesWriter, "close")],
    "bus log: last container (zlib), file closed": [(Machine, "close")],
    "machine freed": [(machine, "close_plant"), (gc, "collect")],
    "metrics and verdict": [(runner, "judged"), (runner, "met"), (runner, "sampled")],
    "row of the tables, run file": [(ResultsWriter, "add")],
}


def measure_stages(path: Path, name: str | None, repeats: int, clocks: Clocks) -> dict[str, Any]:
    """Return the CPU time of each stage, ms: medians over runs of a warm bench.

    `stages_ms` are those beside the simulation; they add up to the median of the whole, but for
    what medians differ. See `Row` for what it raises.
    """
    found: dict[str, list[float]] = {stage: [] for stage in (*STAGES, REST)}
    beyond_ms: list[float] = []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        row = Row(path, name, Path(folder) / "out", clocks)
        row.run()
        for _ in range(repeats):
            with counters(clocks.cpu_ns, STAGES) as stack:
                run = row.run()
            beyond_ms.append(run.beyond_simulation_ms)
            own_ms = {stage: ns / 1e6 for stage, ns in stack.self_ns.items()}
            rest_ms = beyond_ms[-1] - sum(own_ms.values()) + own_ms[SIMULATION]
            for stage, spent_ms in {**own_ms, REST: rest_ms}.items():
                found[stage].append(spent_ms)
    stages_ms = {stage: median(spent) for stage, spent in found.items() if stage != SIMULATION}
    return {
        "case": row.case.run,
        "beyond_simulation_ms": median(beyond_ms),
        "stages_ms": stages_ms,
        "repeats": repeats,
        **build(),
    }


def show_stages(result: dict[str, Any]) -> str:
    """Return the stages as a table that a page can have."""
    lines = ["| a next run beside its simulation | ms |", "|---|---|"]
    lines += [f"| {stage} | {spent:.2f} |" for stage, spent in result["stages_ms"].items()]
    lines.append(f"| all of it | {result['beyond_simulation_ms']:.2f} |")
    said = f"{result['case']}, CPU time, median of {result['repeats']}; {build_line(result)}"
    return "\n".join([*lines, "", said])
