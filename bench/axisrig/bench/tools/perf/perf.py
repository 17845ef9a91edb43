"""How fast is the bench: one row of a plan, timed with all its files, and a cycle taken apart.

The whole is timed on runs of their own; the parts are timed on another run with counters around
the calls that separate them, so the counters do not spoil the whole.
"""

import json
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import Any

from axisrig.bench.bus.segment import Segment
from axisrig.bench.bus.simbus import SimBus
from axisrig.bench.campaign.results.writer import ResultsWriter, RunFiles, build_manifest
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.drive.communication.slave import CanopenSlave
from axisrig.bench.machine.recording.recorder import Recorder
from axisrig.bench.plan.plan import Case, read_plan
from axisrig.bench.record.series import TIME
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.drives.link import AxisLink
from axisrig.kernel.errors import UserError

# Part -> the calls that make it up. Inner calls are taken out of outer ones, so the parts add up.
PARTS: dict[str, list[tuple[type, str]]] = {
    "kernel": [(Channel, "cycle")],
    "codec": [(AxisLink, "take"), (AxisLink, "send"), (CanopenSlave, "_cycle")],
    "bus": [(Segment, "_arbitrate"), (Segment, "_end_of_frame"), (SimBus, "send_raw")],
    "fmu": [(Plant, "_step")],
    "recording": [(Recorder, "__call__")],
}  # fmt: skip


class _Stack:
    """Self time per part: time in a call without the time in timed calls inside it."""

    def __init__(self, clock_ns: Callable[[], int]) -> None:
        self.clock_ns = clock_ns
        self.self_ns = dict.fromkeys(PARTS, 0)
        self._inner = [0]

    def timed(self, part: str, call: Callable[..., Any]) -> Callable[..., Any]:
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
def _counters(clock_ns: Callable[[], int]) -> Iterator[_Stack]:
    stack = _Stack(clock_ns)
    originals = [(owner, name, getattr(owner, name)) for calls in PARTS.values()
                 for owner, name in calls]  # fmt: skip
    part_of = {(owner, name): part for part, calls in PARTS.items() for owner, name in calls}
    for owner, name, call in originals:
        setattr(owner, name, stack.timed(part_of[owner, name], call))
    try:
        yield stack
    finally:
        for owner, name, call in originals:
            setattr(owner, name, call)


def _pick(path: Path, name: str | None) -> Case:
    cases = read_plan(path).cases
    found = [case for case in cases if name in (None, case.case)]
    if not found:
        raise UserError("no such case", value=name, allowed=[case.case for case in cases])
    return found[0]


def measure(
    path: Path,
    name: str | None,
    repeats: int,
    clock_ns: Callable[[], int],
    build_report: Callable[[Path], Path],
) -> dict[str, Any]:
    """Time a case and return one flat object; see docs/performance.md for its keys."""
    case = _pick(path, name)
    plan = read_plan(path)
    walls_s, sims_s, report_s = [], [], []
    digest = ""
    with tempfile.TemporaryDirectory() as folder:
        manifest = build_manifest([plan], command=["axisrig", "perf"], started="", output="")
        for _ in range(repeats):
            begin = clock_ns()
            out = Path(folder) / "out"
            with ResultsWriter(out, [plan], manifest, is_fresh=True) as writer:
                result = run_case(case, writer.files_of(case.run))
                writer.add(result)
            walls_s.append((clock_ns() - begin) / 1e9)
            if result.error:
                raise UserError(f"the case cannot be timed: {result.error}")
            sims_s.append(result.sim_s)
            begin = clock_ns()
            build_report(Path(folder) / "out")
            report_s.append((clock_ns() - begin) / 1e9)
            digest = result.frame_log_sha256
        with _counters(clock_ns) as stack:
            begin = clock_ns()
            result = run_case(case, RunFiles([Path(folder) / "split.blf"]))
            split_s = (clock_ns() - begin) / 1e9
    cycles = 0 if result.series is None else len(result.series.column(TIME))
    split = {part: ns / 1e3 / max(cycles, 1) for part, ns in stack.self_ns.items()}
    split["rest"] = split_s * 1e6 / max(cycles, 1) - sum(split.values())
    return {
        "case": case.run,
        "simulated_s": sims_s[0],
        "wall_s": median(walls_s),
        "wall_s_min": min(walls_s),
        "wall_s_max": max(walls_s),
        "real_time_factor": sims_s[0] / median(walls_s),
        "cycles": cycles,
        "cycle_us": split,
        "report_s": median(report_s),
        "repeats": repeats,
        "frame_log_sha256": digest,
    }


def show(result: dict[str, Any], as_json: bool) -> str:
    """Return the result as one JSON object or as a table."""
    if as_json:
        return json.dumps(result)
    lines = [
        f"{result['case']}: {result['simulated_s']:.3f} s simulated in {result['wall_s']:.3f} s"
        f" (min {result['wall_s_min']:.3f}, max {result['wall_s_max']:.3f},"
        f" {result['repeats']} runs, every file written)",
        f"real time factor {result['real_time_factor']:.1f}",
        f"report.html {result['report_s']:.3f} s",
        "",
        f"a cycle with counters around its parts, us ({result['cycles']} cycles; the counters"
        " themselves cost, so read the shares)",
    ]
    total = sum(result["cycle_us"].values())
    for part, spent in result["cycle_us"].items():
        lines.append(f"  {part:<10}{spent:>8.1f}{100 * spent / total:>6.0f} %")
    lines += ["", f"frame_log_sha256 {result['frame_log_sha256']}"]
    return "\n".join(lines)
