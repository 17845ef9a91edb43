"""Recordings of distance control made of formulas: 1 ms, kp 0.2, no filter, on from row 100 on."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
from tests.recordings import facts, kept

from axisrig.bench.judge.distance.times import Unbroken
from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, INACTIVE
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.oracles.distance.acting import Acting
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.distance import (
    Controller,
    DistanceChange,
    DistanceOrder,
    DistanceRecord,
)
from axisrig.kernel.time.clock import MS

ROWS, ON = 1000, 100
STEM = "kenngr.dist_ctrl[0]."
INVERTS = "lr_hw[1].vz_istw"
"""P-AXIS-00230: 60E4 gives the gap, the control wants what falls when the tool lifts."""
K = np.arange(ROWS)
N = 2
"""Sent in the cycle after, acting at the next SYNC, reached at the one after it."""
WITH_CONST_DIST = DistanceOrder((ON - 1) * MS, "NC", "ON_CONST_DIST")
WITH_SET_POS = DistanceOrder((ON - 1) * MS, "NC", "ON")
SET_DIST_MM = 2.0
CLAMP = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, False)
"""P control with kp 0.2, whose speed and acceleration are clamped."""


def recorded(
    behind_mm: Any = 0.0,
    surface_mm: Any = 0.0,
    state: int = ACTIVE_CONST_DIST,
    orders: tuple[DistanceOrder, ...] = (),
    words: Mapping[str, Any] | None = None,
    columns: Mapping[str, Any] | None = None,
    changes: tuple[DistanceChange, ...] = (),
    has_plant: bool = True,
    **of_axis: Any,
) -> Observed:
    """behind_mm, surface_mm: of each row; words: of the list."""
    written = {"kp": 0.2, "n_cycles": 1, **(words or {})}
    gap_mm = SET_DIST_MM - behind_mm * np.ones(ROWS)
    known = {
        "distance_state": np.where(K < ON, INACTIVE, state).astype(float),
        "distance_held": np.zeros(ROWS),
        "distance_override_pct": np.full(ROWS, 100.0),
        "set_mm": np.zeros(ROWS),
        "offset_mm": np.zeros(ROWS),
        "step_mm": np.zeros(ROWS),
        "delta_mm": np.zeros(ROWS),
        "error_mm": np.zeros(ROWS),
        "set_pos_mm": np.full(ROWS, -SET_DIST_MM),
        "set_dist_mm": np.full(ROWS, SET_DIST_MM),
        "sensor_mm": -gap_mm,
        "truth_mm": surface_mm + gap_mm,
        "actual_mm": surface_mm + gap_mm,
        **(columns or {}),
    }
    table = {f"Z.{name}": values for name, values in known.items()}
    if has_plant:
        table |= {"gap.distance_mm": gap_mm, "gap.distance_true_mm": gap_mm}
    listed = {INVERTS: 1, **{STEM + name: value for name, value in written.items()}}
    axis = AxisRecord("can1", 1, 10_000.0, plant="z", sensor="gap", written=listed, **of_axis)
    control = DistanceRecord(orders=orders or (WITH_CONST_DIST,), changes=changes)
    left = facts(axes={"Z": axis}, distance={"Z": control}, end_ns=(ROWS - 1) * MS)
    return Observed(left, kept(pa.table({"time_ns": K * MS, **table})))


def seen(observed: Observed, metric: str) -> Observation:
    words = {"distance_stability": "== stable", "distance_state_end": "== FREEZE"}
    condition = words.get(metric, "> -1e9")
    return observe(observed, parse_check(metric, condition, ""))


def no_value(observed: Observed, metric: str) -> str:
    found = seen(observed, metric)
    assert found.value is None
    return found.note


def truth_of_steps(steps_mm: Any) -> Any:
    """A control that is on throughout, above a surface with these steps from row to row."""
    still = np.zeros(len(steps_mm) + 1)

    class Part:
        surface_mm = np.concatenate([[0.0], np.cumsum(steps_mm)])

        def wanted_mm(self, _column: str) -> Any:
            return still

        def __getitem__(self, _column: str) -> Any:
            return still

    law = Acting(0, "a list", False, True)  # type: ignore[arg-type]
    return SimpleNamespace(
        has_surface=True,
        period_s=1e-3,
        states=[Unbroken(0, len(still), ACTIVE)],
        acting=[law],
        acting_in=lambda _row: law,
        mode_in=lambda _state, _listed: "SET_POS",
        gathered=lambda made, rows: made(Part())[rows],
    )
