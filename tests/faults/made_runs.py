"""What a run of scenarios has left, made by hand: series, edges, alarms and facts."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from axisrig.bench.record.axes import AxisRecord, DriveState
from axisrig.bench.record.distance import Controller, DistanceChange, DistanceRecord
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.facts import AlarmRecord, Facts, Timing
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import Series
from axisrig.bench.tools.scenarios.invariants import broken
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.kernel.time.clock import MS

PER_MM = 100_000.0
STEP_MM = 1.0 / PER_MM
STEPS = ("stufe_1", "stufe_2", "grenz_stufe_1", "grenz_stufe_2")
LISTS = {
    "getriebe[0].dynamik.vb_max": 100_000,  # 100 mm/s
    "getriebe[0].lslope_profil.a_stufe_1": 2000,
    "getriebe[0].lslope_profil.a_feedh": 4000,
    "kenngr.hub_messtaster": 10_000,  # 1 mm
    "kenngr.measure.edge": "POS",
}
BRAKES = {
    **LISTS,
    **{f"getriebe[0].lslope_profil.a_{step}": 2000 for step in STEPS},
}
OF_CONTROL = {
    "kenngr.dist_ctrl[0].v_max": 50_000,  # 50 mm/s
    "kenngr.dist_ctrl[0].a_max": 1000,
    "kenngr.dist_ctrl[0].max_deviation": 5000,  # 0.5 mm
    "kenngr.dist_ctrl[0].min_pos": -80_000,
    "kenngr.dist_ctrl[0].max_pos": 0,
    "kenngr.dist_ctrl[0].tolerance": 1000,
}
CONTROLLER = Controller(0.2, 0.0, 0.0, "MOVING_AVERAGE", 1, 0.0, 1, 0.0, 0.0, False)


def edge(at_ms: int, place_mm: float | None, axis: str = "Z", level: bool = True) -> EdgeTruth:
    return EdgeTruth("probe", axis, level, at_ms * MS, 0.0, 0.0, at_ms * MS + 1, place_mm, place_mm)


def ramp(speed_mm_s: float, a_mm_s2: float, rows: int = 100) -> list[float]:
    """Set positions, a row each ms: up to the speed with the acceleration, then on."""
    speeds = np.minimum(np.arange(rows) * a_mm_s2 * 1e-3, speed_mm_s)
    return [float(place) for place in np.cumsum(speeds * 1e-3)]


def left(
    machine: str = "one-axis",
    set_mm: Sequence[float] = (1.0,) * 100,
    lists: Mapping[str, Any] = LISTS,
    *,
    columns: Mapping[str, Sequence[float]] | None = None,
    crept_mm: Mapping[str, float] | None = None,
    channel: Sequence[str] = ("STARTING", "POWERING", "RUNNING", "ENDED"),
    drive: Sequence[str] = (),
    control: Sequence[str] = (),
    hidden: Sequence[str] = (),
    axis: str = "Z",
    channel_lists: Mapping[str, Any] | None = None,
    **facts: Any,
) -> Left:
    times_ns = np.arange(len(set_mm)) * MS
    table = {
        "time_ns": pa.array(times_ns),
        f"{axis}.set_mm": pa.array(set_mm, pa.float64()),
        f"{axis}.truth_mm": pa.array(set_mm, pa.float64()),
        f"{axis}.velocity_mm_s": pa.array(np.gradient(np.array(set_mm)) * 1e3),
        **{name: pa.array(values, pa.float64()) for name, values in (columns or {}).items()},
    }
    record = AxisRecord(
        "can1", 3, PER_MM, plant="z", signals={"probe_1": "probe"}, written=dict(lists),
        states=tuple(DriveState(n, name) for n, name in enumerate(drive)),
    )  # fmt: skip
    changes = tuple(
        DistanceChange(n, name, "NC", "gap", False, CONTROLLER) for n, name in enumerate(control)
    )
    distance = {axis: DistanceRecord(changes=changes)} if control else {}
    if channel_lists is not None:
        facts["distance_3d"] = DistanceRecord(changes=())
        facts["channel"] = {f"dist_ctrl[0].{name}": it for name, it in channel_lists.items()}
    whole = {
        "timing": Timing(MS, 600_000, 0), "sim_ns": len(set_mm) * MS, "start_ns": 0,
        "end_ns": len(set_mm) * MS, "frame_log_sha256": "", "axes": {axis: record},
        "distance": distance, **facts,
    }  # fmt: skip
    return Left(
        machines()[machine],
        Facts(**whole),
        Series(pa.table(table)),
        crept_mm or {},
        channel,
        frozenset(hidden),
    )


def run(begin_ms: int, end_ms: int, value_mm: float | None, **more: Any) -> MeasurementRun:
    latched = {} if value_mm is None else {"Z": value_mm}
    return MeasurementRun(
        ("Z",), inputs={"Z": 1}, sources={"Z": "DRIVE"}, begin_ns=(begin_ms - 5) * MS,
        start_ns=begin_ms * MS, end_ns=end_ms * MS, latched_mm=latched, **more,
    )  # fmt: skip


def alarm(at_ms: int, ends: bool = True, number: int = 1) -> AlarmRecord:
    return AlarmRecord(at_ms * MS, number, 7 if ends else 1, ends, "")


def braked(a_mm_s2: float, dead: int = 2) -> list[float]:
    """Set positions with 60 mm/s until row 30 and `dead` more, then braked."""
    speeds = [60.0] * (31 + dead)
    speeds += [max(0.0, 60.0 - a_mm_s2 * 1e-3 * n) for n in range(1, 100 - len(speeds) + 1)]
    return [float(place) for place in np.cumsum(speeds) * 1e-3]


def found(made: Left) -> list[str]:
    """Names of the invariants that do not hold."""
    return [name for name, _ in broken(made)]
