"""Runs to a fixed stop of 100 ms, by hand: marks, limits and signals in round numbers."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
from tests.reports.stops import MS

from axisrig.bench.judge.fixed_stop.stop_findings import (
    KERNEL,
    Decision,
    Mark,
    StopLimits,
)
from axisrig.reports.fixed_stop.signals import Stop

LIMITS = StopLimits(1.0, 0.01, 20.0, 0.5)


def at(key: str, ms: float | None, axis: str | None = None, **more: Any) -> Mark:
    return Mark(key, key, axis, None if ms is None else round(ms * MS), KERNEL, **more)


def stop(*marks: Mark, **more: Any) -> Stop:
    """From 100 to 200 ms, axis Z with a slave Z2; found by the lag of Z."""
    values = {
        "number": 1, "block": "N10", "axes": ["Z"], "watched": ["Z", "Z2"], "main_axis": "Z",
        "is_found": True, "decided_by": Decision("Z", "lag"),
        "limits": {"Z": LIMITS, "Z2": replace(LIMITS, min_time_ms=40.0)}, "rotary": {},
        "begin_ns": 100 * MS, "end_ns": 200 * MS, "broken_contacts": {}, "marks": marks, **more,
    }  # fmt: skip
    signals = values.pop("signals", None)
    if signals is None:
        names = ("cnc_lag_mm", "truth_mm", "stop_force_n")
        signals = {axis: {name: f"{axis}.{name}" for name in names} for axis in ("Z", "Z2")}
    return Stop(**values, signals=signals)


def trace(**columns: Sequence[float]) -> pa.Table:
    """A row each ms, 300 of them; names of columns have __ for the dot."""
    return pa.table(
        {"time_ns": np.arange(300, dtype=np.int64) * MS}
        | {name.replace("__", "."): np.array(v, np.float64) for name, v in columns.items()}
    )


def during(value: float, first: int, last: int, rest: float = 0.0) -> list[float]:
    return [value if first <= row <= last else rest for row in range(300)]


def added(one: Sequence[float], other: Sequence[float]) -> list[float]:
    return [a + b for a, b in zip(one, other, strict=True)]


def fields_of(found: Stop) -> dict[str, Any]:
    """What the judge finds of it: without the names of its signals."""
    return {name: value for name, value in vars(found).items() if name != "signals"}
