"""How fast is the bench: one row of a plan, timed with all its files, and a cycle taken apart.

The whole is timed on runs of their own; the parts are timed on another run with counters around
the calls that separate them, so the counters do not spoil the whole.
"""

import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from statistics import median
from types import ModuleType
from typing import Any, NamedTuple

from axisrig.bench.bus.can.line import BusLine
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.bus.ethercat.segment import EthercatSegment
from axisrig.bench.campaign.preparing import prepare
from axisrig.bench.campaign.results.build_info import is_compiled, sources_sha256
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import (
    CaseResult,
    ResultsWriter,
    RunFiles,
)
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.drive.canopen.slave import CanopenSlave
from axisrig.bench.drive.ethercat.node import EthercatDrive
from axisrig.bench.machine.recording.recorder import Recorder
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.record.series import TIME
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.ethercat.master import Master
from axisrig.kernel.errors import UserError

# Part -> the calls that make it up, each by its class or module and its name. Inner calls are taken
# out of outer ones, so the parts add up.
Parts = Mapping[str, Sequence[tuple[type | ModuleType, str]]]
PARTS: Parts = {
    "kernel": [(Channel, "cycle")],
    "codec": [(AxisLink, "take"), (AxisLink, "send"), (CanopenSlave, "_cycle"),
              (Master, "_send"), (Master, "_take"), (EthercatDrive, "process")],
    "bus": [(BusLine, "arbitrate"), (BusLine, "end_of_frame"), (SimBus, "send_raw"),
            (EthercatSegment, "send"), (EthercatSegment, "_pass"), (EthercatSegment, "_deliver")],
    "fmu": [(Plant, "_step")],
    "recording": [(Recorder, "__call__")],
}  # fmt: skip


class Stack:
    """Self time per part: time in a call without the time in timed calls inside it."""

    def __init__(self, clock_ns: Callable[[], int], parts: Parts) -> None:
        self.clock_ns = clock_ns
        self.self_ns = dict.fromkeys(parts, 0)
        self._inner = [0]

    def timed(self, part: str, call: Callable[..., Any]) -> Callable[..., Any]:
        """Return the same call, whose own time counts for a part."""

        def wrapper(*args: Any, **kwargs: Any) -> Any:
            self._inner.append(0)
            begin = self.clock_ns()
            try:
                return call(*args, **kwargs)
            finally:
                spent = self.clock_ns() - begin
                self.self_ns[part] += spent - self._inner.pop()
                self._inner[-1] += spent

        return wrapper


@contextmanager
def counters(clock_ns: Callable[[], int], parts: Parts) -> Iterator[Stack]:
    """Time the calls of parts, of interpreted modules, as long as the context lasts."""
    stack = Stack(clock_ns, parts)
    originals = [(owner, name, getattr(owner, name)) for calls in parts.values()
                 for owner, name in calls]  # fmt: skip
    part_of = {(owner, name): part for part, calls in parts.items() for owner, name in calls}
    for owner, name, call in originals:
        setattr(owner, name, stack.timed(part_of[owner, name], call))
    try:
        yield stack
    finally:
        for owner, name, call in originals:
            setattr(owner, name, call)


class Timed(NamedTuple):
    """A run with all its files: its CPU and wall time, and the CPU time of its check before.

    folder_cpu_s: of it, what the results folder takes, which a campaign opens and closes once.
    """

    result: CaseResult
    cpu_s: float
    prepared_cpu_s: float
    wall_s: float
    folder_cpu_s: float

    @property
    def factor(self) -> float:
        """Simulated time by CPU time, start and files included."""
        return self.result.sim_s / self.cpu_s

    @property
    def beyond_simulation_ms(self) -> float:
        """CPU time that is not the simulation: check, start, files, verdict, ms."""
        return (self.prepared_cpu_s + self.cpu_s - self.result.loop_s) * 1e3

    @property
    def next_row_ms(self) -> float:
        """The same of one more row of a campaign, whose folder is open, ms."""
        return self.beyond_simulation_ms - self.folder_cpu_s * 1e3


class Row:
    """A row of a plan that is run again and again in this process, into a folder of its own.

    Raises UserError for a row that the plan does not have, see `read_plan`.
    """

    def __init__(self, path: Path, name: str | None, folder: Path, clocks: Clocks) -> None:
        self.plan = read_plan(path)
        found = [case for case in self.plan.cases if name in (None, case.case)]
        if not found:
            allowed = list(dict.fromkeys(case.case for case in self.plan.cases))
            raise UserError("no such case", value=name, allowed=allowed)
        self.case, self.folder, self._clocks = found[0], folder, clocks
        self._manifest = build_manifest(
            [self.plan], command=["axisrig", "perf"], started="", output=""
        )

    def run(self) -> Timed:
        """Check and run it once. Raises UserError when the run ends with an error."""
        clocks = self._clocks
        checked_s = clocks.cpu_s()
        prepare(self.case)
        began_s, began_ns = clocks.cpu_s(), clocks.wall_ns()
        with ResultsWriter(self.folder, [self.plan], self._manifest, is_fresh=True) as writer:
            opened_s = clocks.cpu_s()
            result = run_case(self.case, writer.files_of(self.case.run), clocks.cpu_s)
            writer.add(result)
            added_s = clocks.cpu_s()
        wall_s, ended_s = (clocks.wall_ns() - began_ns) / 1e9, clocks.cpu_s()
        if result.error:
            raise UserError(f"the case cannot be timed: {result.error}")
        folder_s = (opened_s - began_s) + (ended_s - added_s)
        return Timed(result, ended_s - began_s, began_s - checked_s, wall_s, folder_s)


def measure(
    path: Path,
    name: str | None,
    repeats: int,
    clocks: Clocks,
    build_report: Callable[[Path], Path],
) -> dict[str, Any]:
    """Time a case and return one flat object; see docs/performance.md for its keys."""
    runs, report_s = [], []
    with tempfile.TemporaryDirectory() as folder:
        row = Row(path, name, Path(folder) / "out", clocks)
        for _ in range(repeats):
            runs.append(row.run())
            begin = clocks.wall_ns()
            build_report(row.folder)
            report_s.append((clocks.wall_ns() - begin) / 1e9)
        with nullcontext() if is_compiled() else counters(clocks.wall_ns, PARTS) as stack:
            begin = clocks.wall_ns()
            result = run_case(row.case, RunFiles([Path(folder) / "split.blf"]))
            split_s = (clocks.wall_ns() - begin) / 1e9
    cycles = 0 if result.series is None else len(result.series.column(TIME))
    own_ns = {} if stack is None else stack.self_ns
    split = {part: ns / 1e3 / max(cycles, 1) for part, ns in own_ns.items()}
    split["rest"] = split_s * 1e6 / max(cycles, 1) - sum(split.values())
    walls_s = [run.wall_s for run in runs]
    cpu_s = median(run.cpu_s for run in runs)
    # The first run of a process also fills what later ones find
    warm = runs[1:] or runs
    return {
        "case": row.case.run,
        "simulated_s": runs[0].result.sim_s,
        "wall_s": median(walls_s),
        "wall_s_min": min(walls_s),
        "wall_s_max": max(walls_s),
        "real_time_factor": runs[0].result.sim_s / median(walls_s),
        "cpu_s": cpu_s,
        "cpu_factor": runs[0].result.sim_s / cpu_s,
        "beyond_simulation_ms": median(run.beyond_simulation_ms for run in warm),
        "next_row_ms": median(run.next_row_ms for run in warm),
        "cycles": cycles,
        "cycle_us": split,
        "report_s": median(report_s),
        "repeats": repeats,
        "frame_log_sha256": runs[-1].result.frame_log_sha256,
        **build(),
    }


def build() -> dict[str, Any]:
    """Return which axisrig was measured: `compiled`, `sources_sha256`."""
    return {"compiled": is_compiled(), "sources_sha256": sources_sha256()}


def show(result: dict[str, Any], as_json: bool) -> str:
    """Return the result as one JSON object or as a table."""
    if as_json:
        return json.dumps(result)
    lines = [
        f"{result['case']}: {result['simulated_s']:.3f} s simulated in {result['wall_s']:.3f} s"
        f" (min {result['wall_s_min']:.3f}, max {result['wall_s_max']:.3f},"
        f" {result['repeats']} runs, every file written)",
        f"real time factor {result['real_time_factor']:.1f}",
        f"CPU time {result['cpu_s']:.3f} s: {result['cpu_factor']:.1f} times real time;"
        f" a next run takes {result['beyond_simulation_ms']:.1f} ms beyond its simulation",
        f"report.html {result['report_s']:.3f} s",
        "",
    ]
    if result["compiled"]:
        lines.append(f"a cycle, us ({result['cycles']} cycles; counters around its parts act only"
                     " on interpreted modules)")  # fmt: skip
    else:
        lines.append(f"a cycle with counters around its parts, us ({result['cycles']} cycles; the"
                     " counters themselves cost, so read the shares)")  # fmt: skip
    total = sum(result["cycle_us"].values())
    for part, spent in result["cycle_us"].items():
        lines.append(f"  {part:<10}{spent:>8.1f}{100 * spent / total:>6.0f} %")
    lines += ["", f"frame_log_sha256 {result['frame_log_sha256']}", build_line(result)]
    return "\n".join(lines)


def build_line(result: Mapping[str, Any]) -> str:
    """Say which axisrig was measured."""
    word = "compiled" if result["compiled"] else "interpreted"
    return f"axisrig {word}, sources {result['sources_sha256']}"
