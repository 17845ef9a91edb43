"""Distance controls made of formulas: the discrete model walked over a surface, state by state.

An axis without mass stands two cycles later where it was sent; everything is one cycle of 1 ms.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.judge.distance.control_findings import (
    MM,
    ControlFindings,
    DeadCycles,
    DistanceLaw,
    DistanceStretch,
    EndError,
    UsedLimit,
)
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.oracles.distance.lists import Control, Limits
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.model import Law
from axisrig.bench.oracles.distance.smoothing import of_control
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.reports.distance.signals import STATES

MS = 1_000_000
LIMITS = Limits(100.0, 5000.0, 5.0, 2000.0, -8.0, 8.0)
INACTIVE, ACTIVE, FREEZE, TURNING_OFF, CONST, ERROR = STATES
Signal = npt.NDArray[np.float64]


@dataclass
class Sample:
    """One case. plan: (row, state, by) from when on. surface: height at each row."""

    name: str
    surface: Callable[[Signal], Signal]
    plan: tuple[tuple[int, str, str], ...]
    control: Control
    program_mm: float = 42.0
    set_mm: float = 40.0
    rows: int = 2000
    feed_mm_s: float = 0.0
    alarm: tuple[int, str] | None = None
    is_dry_run: bool = False
    limits: Limits = LIMITS


def samples() -> list[Sample]:
    """One case for each thing that a reader has to tell apart."""
    calm = Control(kp=0.2, count=4)

    def lifted(t: Signal) -> Signal:
        return 40.0 + 2.0 * ((t > 400) & (t < 900)) + 0.5 * (t >= 1100)

    def wavy(t: Signal) -> Signal:
        return 40.0 + 0.8 * np.sin(t / 150.0)

    def flat(t: Signal) -> Signal:
        return np.full_like(t, 40.0) + 0.1 * (t > 300)

    whole = (
        (0, INACTIVE, "NC"),
        (100, ACTIVE, "PLC"),
        (1000, FREEZE, "PLC"),
        (1300, ACTIVE, "PLC"),
        (1600, TURNING_OFF, "PLC"),
        (1690, INACTIVE, "PLC"),
    )
    on = ((0, INACTIVE, "NC"), (100, CONST, "NC"))
    return [
        Sample("surface-with-freeze", lifted, whole, calm),
        Sample("profile", wavy, on, calm, set_mm=2.0, feed_mm_s=50.0),
        Sample("oscillates", flat, on, Control(kp=1.0, count=4), set_mm=2.0, rows=600),
        Sample("dry-run", lifted, on, calm, set_mm=2.0, is_dry_run=True),
        Sample(
            "alarm",
            lambda t: 40.0 + 0.02 * np.clip(t - 200, 0, None),
            (*on, (480, ERROR, "NC")),
            calm,
            set_mm=2.0,
            rows=600,
            alarm=(480, "ID 70331"),
        ),
    ]


def mode(state: str) -> str:
    """Law of a following state."""
    return SET_POS if state == ACTIVE else CONST_DIST


def trace(sample: Sample) -> pa.Table:
    """Signals as the recorder writes them."""
    count = sample.rows
    at = np.arange(count, dtype=np.float64)
    surface = sample.surface(at)
    state = np.zeros(count, dtype=np.int64)
    for row, word, _ in sample.plan:
        state[row:] = STATES.index(word)
    found = {name: np.zeros(count) for name in ("offset", "error", "delta", "step", "filtered")}
    sent = np.full(count, sample.program_mm)
    truth = sent.copy()
    law, offset = None, 0.0
    for row in range(count):
        truth[row] = sent[max(row - 2, 0)] if row > 1 else sample.program_mm
        sensor = surface[row] - truth[row]
        word = STATES[state[row]]
        before = offset
        if word in (ACTIVE, CONST):
            if law is None:
                smooth = of_control(sample.control, MS)
                law = Law(mode(word), sample.control, MS, sample.limits, smooth, offset)
            moved = law.walk(sensor, truth[row], sent[max(row - 1, 0)], sample.set_mm)
            offset = before if sample.is_dry_run else moved
            law.offset_mm = offset
            found["error"][row], found["filtered"][row] = law.error_mm, law.filtered_mm
            found["delta"][row] = sample.control.kp * law.error_mm
        else:
            law = None
            if word == TURNING_OFF:
                offset -= np.sign(offset) * min(abs(offset), 0.01)
        found["offset"][row], found["step"][row] = offset, offset - before
        sent[row] = sample.program_mm + offset
    gap = truth - surface
    in_surface = any(word == ACTIVE for _, word, _ in sample.plan)
    return pa.table(
        {
            "time_ns": (at * MS).astype(np.int64),
            "X.set_mm": sample.feed_mm_s * at / 1000.0,
            "X.actual_mm": sample.feed_mm_s * at / 1000.0,
            "X.truth_mm": sample.feed_mm_s * at / 1000.0,
            "Z.set_mm": sent,
            "Z.actual_mm": truth,
            "Z.truth_mm": truth,
            "Z.velocity_mm_s": np.gradient(truth, 0.001),
            **{f"Z.{name}_mm": values for name, values in found.items()},
            "Z.distance_state": state.astype(np.float64),
            "Z.sensor_mm": -gap,
            "Z.distance_cnc_mm": gap,
            "Z.surface_cnc_mm": truth - gap,
            "Z.set_pos_mm": np.full(count, sample.set_mm if in_surface else np.nan),
            "Z.set_dist_mm": np.full(count, np.nan if in_surface else sample.set_mm),
            "gap.distance_mm": gap,
            "gap.distance_true_mm": gap,
            "gap.valid": np.ones(count, dtype=np.int8),
        }
    )


def info(sample: Sample, **changes: Any) -> RunFindings:
    """What the judge finds of distance control: its marks and the control, with changes of it."""
    events = [
        Event(row * MS, "alarm", label) for row, label in ([sample.alarm] if sample.alarm else [])
    ]
    return RunFindings(events=events, of_topics=[replace(control(sample), **changes)])


def control(sample: Sample) -> ControlFindings:
    """What the judge finds of the control itself."""
    ends = [*(row for row, _, _ in sample.plan[1:]), sample.rows - 1]
    word = next(word for _, word, _ in sample.plan if word in (ACTIVE, CONST))
    followed = law(sample.control, mode(word))
    stretches = []
    for (row, state, by), end in zip(sample.plan, ends, strict=True):
        is_on = state in (ACTIVE, CONST)
        set_mm = sample.set_mm if is_on else None
        stretches.append(
            DistanceStretch(
                row * MS, end * MS, state, by, sample.is_dry_run and is_on, set_mm, set_mm,
                followed if is_on else None,
            )
        )  # fmt: skip
    offset = trace(sample).column("Z.offset_mm").to_numpy()
    expected, note = (None, "the transient needs 40 cycles") if sample.alarm else (0.0, "")
    return ControlFindings(
        axis="Z",
        unit=MM,
        sensor="gap",
        zero_mm=0.0,
        late_cycles=0,
        period_ms=1.0,
        stretches=stretches,
        laws=[followed],
        dead=DeadCycles(1, 1),
        errors=[EndError(100 * MS, mode(word), 0.0, 0.0004, 0.0001, expected, note)],
        limits=[
            limit("v_max", 415, 100.0, "mm/s", float(np.abs(np.diff(offset)).max()) * 1000.0),
            limit("max_deviation", 414, 5.0, "mm", float(np.abs(offset).max())),
            limit("max_pos", 419, 8.0, "mm", 0.0),
            limit("min_pos", 420, -8.0, "mm", -2.5),
        ],
    )


def law(control: Control, of_mode: str) -> DistanceLaw:
    """One law as the bench finds it."""
    smooth = of_control(control, MS)
    loop = replace(Loop(of_mode, 1), smoothing=smooth)
    return DistanceLaw(
        mode=of_mode,
        formula="o += limit(kp (SET_DIST − filter(d)))",
        kp=control.kp,
        tn_s=control.tn_s,
        tv_s=control.tv_s,
        filter=smooth.name,
        delay_cycles=smooth.delay_cycles,
        noise_gain=smooth.noise_gain,
        dead_cycles=1,
        age_cycles=0,
        drive_lag_ms=0.0,
        kp_limit=kp_limit(loop),
        growth=growth(loop, control.kp),
    )


def limit(key: str, number: int, value: float, unit: str, used: float) -> UsedLimit:
    """One limit as the bench finds it."""
    return UsedLimit(key, f"P-AXIS-{number:05d}", value, unit, used, "clamps")
