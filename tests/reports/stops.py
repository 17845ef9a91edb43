"""Runs to a fixed stop made of formulas: one case per way in which such a run may end.

An axis without mass runs at V against a stop: it stands at STOP + PENETRATION from the contact on;
the set value goes on, brakes, and is led back. Instants are those of the formulas, in ns.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pyarrow as pa

from axisrig.bench.judge.fixed_stop.stop_findings import (
    KERNEL,
    PLANT,
    Decision,
    Mark,
    StopFindings,
    StopLimits,
)
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings

MS = 1_000_000
V, KV, LAG = 10.0, 40.0, 0.25
STOP, PENETRATION = 40.0, 0.025
FORCE = 500.0
BEGIN, CONTACT, RELAX = 500 * MS, 1500 * MS, 108 * MS
OFFSET = 600_000


@dataclass
class Sample:
    """What a case is made of; times in ms. detected_ms: None for a stop that is not found."""

    name: str
    criterion: str = "lag"
    lag_limit_mm: float | None = 1.0
    window_mm: float | None = None
    tau_ms: float = 100.0
    watched: tuple[str, ...] = ("Z",)
    decided: str = "Z"
    is_found: bool = True
    has_contact: bool = True
    has_plant: bool = True
    has_oracle: bool = True
    run_ms: float = 1600.0
    false_ms: float | None = None
    moving_mm_s: float = 0.0
    trouble: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    count: int = 1
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def beyond_ns(self) -> int:
        """t_c + (L - e0 + delta)/v; source: facts on the run to a fixed stop."""
        limit = self.lag_limit_mm or 0.0
        return CONTACT + round((limit - LAG + PENETRATION) / V * 1e9)

    @property
    def window_ns(self) -> int:
        """t_c + tau - (W - delta)/v, here for an axis that stands at once."""
        return CONTACT + round(self.tau_ms * MS)

    @property
    def detected_ns(self) -> int:
        """The later of the criteria in use; a false trigger comes when it is told to."""
        if self.false_ms is not None:
            return BEGIN + round(self.false_ms * MS)
        lag = self.beyond_ns + round(self.tau_ms * MS)
        return max(
            lag if "lag" in self.criterion else 0,
            self.window_ns if "window" in self.criterion else 0,
        )

    @property
    def end_ns(self) -> int:
        """When the run is over."""
        if not self.is_found:
            return BEGIN + round(self.run_ms * MS)
        return self.detected_ns + 11 * MS + RELAX


def samples() -> list[Sample]:
    """One case for each thing that a reader has to tell apart."""
    return [
        Sample("found-by-lag"),
        Sample("found-by-window", "window", None, 0.001),
        Sample("found-by-both", "lag and window", 0.5, 0.001),
        Sample("found-by-a-gantry-slave", watched=("Z", "Z2"), decided="Z2"),
        Sample("not-found", is_found=False, has_contact=False, window_mm=0.001),
        Sample("stop-too-far-for-the-time", is_found=False, run_ms=1150.0, tau_ms=200.0),
        Sample("false-trigger", lag_limit_mm=0.2, has_contact=False, false_ms=220.0),
        Sample("contact-after-a-false-trigger", "window", None, 2.0, false_ms=990.0),
        Sample(
            "drive-fault",
            is_found=False,
            run_ms=1120.0,
            trouble=(("fault", "Z: fault reaction active"), ("alarm", "ID 900034")),
        ),
        Sample("moving-stop", moving_mm_s=2.0),
        Sample("no-closed-form", has_oracle=False, notes=("friction is above the torque limit",)),
        Sample("on-a-real-bus", has_plant=False, has_oracle=False),
        Sample("three-runs", count=3),
        Sample("extreme", lag_limit_mm=0.2501, tau_ms=5000.0, window_mm=1e-5),
        Sample(
            "never-armed", is_found=False, has_contact=False, run_ms=90.0, extra={"arming": 5.0}
        ),
    ]


def info(sample: Sample, **changes: Any) -> RunFindings:
    """What the judge finds of a run to a fixed stop: its marks and each run, with changes of it."""
    stops = [replace(stop(sample, number), **changes) for number in range(1, sample.count + 1)]
    events = [Event(sample.end_ns - MS, kind, label) for kind, label in sample.trouble]
    if sample.has_contact and sample.has_plant:
        for found in stops:
            touched_ns = CONTACT + found.begin_ns - BEGIN
            events.append(Event(touched_ns, "contact", "Z: contact", "Z"))
    events.sort(key=lambda event: event.time_ns)
    return RunFindings(events=events, of_topics=stops)


def stop(sample: Sample, number: int = 1) -> StopFindings:
    """What the judge finds of one of its runs."""
    limits = StopLimits(
        sample.lag_limit_mm,
        sample.window_mm,
        sample.tau_ms,
        sample.extra.get("arming", 0.5),
        force_limit_n=FORCE if sample.has_plant else None,
    )
    shift = (number - 1) * 4000 * MS
    return StopFindings(
        number=number,
        block="stop.nc:5 N50 G100 Z1000 F600",
        axes=["Z"],
        watched=sample.watched,
        main_axis=sample.decided,
        is_found=sample.is_found,
        decided_by=Decision(sample.decided, sample.criterion) if sample.is_found else None,
        limits=dict.fromkeys(sample.watched, limits),
        rotary={},
        begin_ns=BEGIN + shift,
        end_ns=sample.end_ns + shift,
        broken_contacts={},
        marks=[_shifted(row, shift) for row in _marks(sample)],
        values=_values(sample) if sample.has_plant and sample.is_found else [],
        prediction="contact at the stop, found by the lag" if sample.has_oracle else "",
        notes=sample.notes,
    )


def _shifted(row: Mark, shift: int) -> Mark:
    names = ("measured_ns", "oracle_ns", "low_ns", "high_ns")
    instants = {name: getattr(row, name) for name in names}
    return replace(row, **{n: None if at is None else at + shift for n, at in instants.items()})


def _mark(key: str, label: str, at: int | None, **more: Any) -> Mark:
    form = more.get("form")
    low, high = (None, None) if form is None else (form - 2 * MS, form + 3 * MS)
    inside = None if form is None or at is None else low <= at <= high
    source = PLANT if key == "contact" else KERNEL
    note = "closed form, +2 -3 cycles" if form is not None else ""
    return Mark(key, label, more.get("axis"), at, source, form, low, high, inside, note)


def _marks(sample: Sample) -> list[Mark]:
    """The rows in the order of the process; the kernel acts 0.6 ms after a SYNC."""
    oracle, decided, found = sample.has_oracle, sample.decided, sample.is_found
    real = sample.false_ms is None and found

    def cycle(at: int) -> int:
        return -(-(at - OFFSET) // MS) * MS + OFFSET

    rows = [
        _mark("monitoring_off", "lag monitoring off", BEGIN - MS),
        _mark("begin", "path begins", BEGIN),
    ]
    if "arming" not in sample.extra:
        form = BEGIN + 54 * MS if oracle else None
        rows.append(_mark("armed", "criteria armed", BEGIN + 55 * MS, form=form))
    if sample.has_contact and sample.has_plant:
        rows += [_mark("contact", "contact at the stop", CONTACT, axis=a) for a in sample.watched]
    if found and "lag" in sample.criterion:
        at = sample.beyond_ns if real else sample.detected_ns - round(sample.tau_ms * MS)
        form = at if oracle else None
        rows.append(_mark("beyond", "lag above the limit", cycle(at), axis=decided, form=form))
    if found and "window" in sample.criterion:
        at = sample.window_ns if real else sample.detected_ns
        form = at if oracle else None
        rows.append(_mark("window", "stays in the window", cycle(at), axis=decided, form=form))
    if found:
        at = sample.detected_ns
        form = at - sample.extra.get("late", 0) if oracle else None
        stands = at + 10 * MS
        rows += [
            _mark("detected", "stop detected", cycle(at), axis=decided, form=form),
            _mark("stands", "set values at rest", cycle(stands), form=stands if oracle else None),
            _mark("relax_begin", "relaxing motion begins", cycle(stands) + MS),
            _mark("relax_end", "relaxing motion ends", cycle(stands) + RELAX),
        ]
    elif oracle and sample.has_contact:
        form = sample.beyond_ns + round(sample.tau_ms * MS)
        rows.append(_mark("detected", "stop detected", None, axis=decided, form=form))
    on = sample.end_ns if not sample.trouble else None
    rows.append(_mark("monitoring_on", "lag monitoring on", on))
    return [*rows, _mark("end", "run over", sample.end_ns)]


def _values(sample: Sample) -> list[Value]:
    def row(key: str, label: str, unit: str, *numbers: float | None) -> Value:
        measured, *form = numbers
        form = form if sample.has_oracle else [None, None, None]
        return Value(key, label, unit, sample.decided, measured, *form, "F_lim/k")

    rows = [row("running_lag", "lag while running", "mm", LAG, LAG, LAG - 1e-4, LAG + 1e-4)]
    place = STOP + PENETRATION
    rows.append(
        row("latched", "latched position", "mm", 40.0252, place, place - 1e-3, place + 1e-3)
    )
    if sample.has_contact:
        rows += [
            row("stop_force_max", "largest force at the stop", "N", 505.0, None, 103.1, 1010.6),
            row("stop_force_end", "force at the stop at the end", "N", 498.2, None, 0.0, 500.0),
        ]
    excess = (sample.lag_limit_mm or 0.0) + V * sample.tau_ms / 1000 + 0.05
    last = row(
        "command_excess",
        "set value beyond latch",
        "mm",
        excess,
        excess,
        excess - 0.01,
        excess + 0.01,
    )
    return [*rows, last]


def trace(sample: Sample) -> pa.Table:
    """The signals of a case, a row per ms."""
    shift = (sample.count - 1) * 4000 * MS
    times = np.arange(0, sample.end_ns + shift + 300 * MS, MS, dtype=np.int64)
    columns: dict[str, Any] = {"time_ns": times}
    local = times if sample.count == 1 else times % (4000 * MS)
    for axis in sample.watched:
        columns |= _signals(sample, axis, local)
    return pa.table(columns)


def _signals(sample: Sample, axis: str, times: Any) -> dict[str, Any]:
    begin, stands = BEGIN, (sample.detected_ns + 10 * MS if sample.is_found else sample.end_ns)
    contact_mm = STOP if sample.has_contact else np.inf
    start = STOP - V * (CONTACT - BEGIN) * 1e-9 + LAG
    run = np.clip(times, begin, stands)
    lead = start + V * (run - begin) * 1e-9
    place = contact_mm + sample.moving_mm_s * np.clip(times - CONTACT, 0, stands - CONTACT) * 1e-9
    since = np.clip((times - CONTACT) * 1e-9, 0.0, None)
    ring = np.exp(-since / 0.018) * np.cos(2 * np.pi * 71 * since)
    stand = place + PENETRATION * (1.0 - ring)
    free = start + V * (run - begin) * 1e-9 - np.where(times > begin, LAG, 0.0)
    actual = np.minimum(free, stand)
    if sample.is_found:
        back = np.clip((times - stands - 2 * MS) / (RELAX - 2 * MS), 0.0, 1.0)
        lead = np.where(times > stands, lead + back * (actual - lead), lead)
    pressed = (actual >= place) & np.isfinite(place)
    force = np.where(pressed, np.where(np.isfinite(place), FORCE * (1.0 - ring), 0.0), 0.0)
    moving = (times > begin) & (times < stands)
    columns = {
        "set_mm": lead,
        "actual_mm": np.round(actual, 4),
        "truth_mm": actual,
        "cnc_lag_mm": lead - actual,
        "force_n": np.where(pressed, FORCE, np.where(moving, 44.0, 0.0)),
        "stop_force_n": force,
    }
    if sample.moving_mm_s:
        columns["stop_mm"] = place
    if not sample.has_plant:
        for name in ("truth_mm", "force_n", "stop_force_n"):
            del columns[name]
    return {f"{axis}.{name}": values for name, values in columns.items()}
