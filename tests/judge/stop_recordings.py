"""Recordings of an axis that meets a fixed stop and does not bounce, in closed form.

Z goes with v = 10 mm/s from row 20 on, 0.2 mm behind its demand (v/Kv), meets its stop at 140.3 ms
and goes on for 10 ms into it: F/k = 1000 N/(10 kN/mm) = 0.1 mm. The demand goes on until 220 ms.
The CNC sees e0 = v/Kv + (2 - d) v T = 0.18 mm of lag with d = 4, so its limit of 0.5 mm is passed
t_c + (L - e0 + F/k)/v = 182.3 ms, for 20 ms at 202.3 ms; the cycle of SYNC 203 finds the stop.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import AxisRecord, PlantRecord, PlantValue
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.measuring import Criteria, FixedStop, MeasurementRun
from axisrig.kernel.time.clock import MS, US

ROWS, FIRST = 400, 20
K = np.arange(ROWS)
V_MM_S, KV_PER_S, LAG_MM = 10.0, 50.0, 0.2
CONTACT_MS, STOP_MM, DEEP_MM = 140.3, 1.003, 0.1
FORCE_N, K_N_M, MASS_KG = 1000.0, 1e7, 100.0
E0_MM, LIMIT_MM = 0.18, 0.5
DETECTED_NS, BRAKES_ROW, END_NS = 203 * MS + 600 * US, 220, 300 * MS + 600 * US
LATCHED_MM = STOP_MM + DEEP_MM + 0.0004
DETECT = "kenngr.measure.fixed_stop_detect."
BY_LAG = {DETECT + "pos_lag_limit": 5000, DETECT + "min_time": 20_000}
PLANT = {
    "stop_direction": 1.0, "stop_position": STOP_MM * 1e-3, "stop_stiffness": K_N_M,
    "effective_mass": MASS_KG, "force_limit_motor": FORCE_N, "kv": KV_PER_S,
}  # fmt: skip
DEMAND = np.clip((K - FIRST) * V_MM_S * 1e-3, 0.0, (BRAKES_ROW - FIRST) * V_MM_S * 1e-3)
LOAD = np.minimum(np.maximum(DEMAND - LAG_MM, 0.0), STOP_MM + DEEP_MM)
SPEED = np.where((LOAD > 0.0) & (LOAD < STOP_MM + DEEP_MM), V_MM_S, 0.0)
PRESSED_N = np.maximum(LOAD - STOP_MM, 0.0) * 1e-3 * K_N_M
STOP = FixedStop(
    {"Z": Criteria()},
    armed_ns=30 * MS, beyond_ns={"Z": 183 * MS + 600 * US}, window_ns={"Z": 190 * MS + 600 * US},
    detected_ns=DETECTED_NS, detected_by="Z", brake_end_ns=221 * MS, relax_begin_ns=230 * MS,
    relax_end_ns=250 * MS, watch_off_ns=11 * MS, watch_on_ns=299 * MS, axes=("Z",),
)  # fmt: skip
RUN = MeasurementRun(
    ("Z",), block="N30", inputs={"Z": 1}, begin_ns=10 * MS, start_ns=12 * MS, end_ns=END_NS,
    signal_ns=DETECTED_NS, latched_mm={"Z": LATCHED_MM}, target_mm={"Z": 5.0}, fixed_stop=STOP,
)  # fmt: skip


def recorded(
    side: float = 1.0,
    run: MeasurementRun = RUN,
    before: tuple[MeasurementRun, ...] = (),
    plant: Mapping[str, Any] | None = None,
    written: Mapping[str, Any] | None = None,
    columns: Mapping[str, Any] | None = None,
    rows: int = ROWS,
) -> Observed:
    """side: -1 mirrors everything, so that the stop is met going down."""
    values = {**PLANT, **(plant or {})}
    values = {name: value for name, value in values.items() if value is not None}
    if side < 0:
        values["stop_direction"] *= side
        values["stop_position"] *= side
        run = replace(
            run,
            latched_mm={name: side * place for name, place in run.latched_mm.items()},
            target_mm={name: side * place for name, place in (run.target_mm or {}).items()},
        )
    known = {
        "set_mm": side * DEMAND,
        "actual_mm": side * LOAD,
        "truth_mm": side * LOAD,
        "velocity_mm_s": side * SPEED,
        "drive_lag_mm": side * (DEMAND - LOAD),
        "cnc_lag_mm": side * (DEMAND - LOAD - 2 * V_MM_S * 1e-3),
        "stop_force_n": PRESSED_N,
        "stop_force_peak_n": PRESSED_N * 1.5,
        **(columns or {}),
    }
    table = {f"Z.{name}": column[:rows] for name, column in known.items() if column is not None}
    plants = {"z": PlantRecord({name: PlantValue(value) for name, value in values.items()})}
    axis = AxisRecord("can1", 1, 1000.0, plant="z", written={**BY_LAG, **(written or {})})
    other = AxisRecord("can1", 2, 1000.0)
    left = facts(
        timing=Timing(MS, 600 * US, 0), axes={"Z": axis, "X": other}, plants=plants,
        runs=(*before, run), end_ns=(rows - 1) * MS,
    )  # fmt: skip
    return Observed(left, kept(pa.table({"time_ns": K[:rows] * MS, **table})))


def seen(observed: Observed, metric: str) -> Observation:
    condition = "== lag" if metric == "detection_criterion" else "> -1e9"
    return observe(observed, parse_check(metric, condition, ""))
