"""What the topic adds to the plots: the lag in um, a line at its largest amount, a window."""

import numpy as np
import pyarrow as pa
from tests.exercise.lag.findings import LagFindings

from axisrig.bench.judge.run_findings import RunFindings
from axisrig.reports.parts.topic import Plots

_AROUND_NS = 5_000_000


def with_signals(trace: pa.Table, info: RunFindings) -> pa.Table:
    """Return the signals of a run with `<axis>.lag_um`."""
    for block in info.of(LagFindings):
        axis = block.axis
        lead, place = (
            trace.column(f"{axis}.{name}").to_numpy() for name in ("set_mm", "actual_mm")
        )
        trace = trace.append_column(f"{axis}.lag_um", pa.array(1000.0 * np.abs(lead - place)))
    return trace


def plots(_trace: pa.Table, info: RunFindings) -> Plots:
    """Return what the topic adds to the plots of a run."""
    return Plots(
        limits=[
            {"plot": "lag_um", "axis": b.axis, "value": 1000.0 * b.mm, "label": "largest"}
            for b in info.of(LagFindings)
        ],
        windows=[
            {
                "label": f"lag of {b.axis}",
                "start_ns": b.time_ns - _AROUND_NS,
                "end_ns": b.time_ns + _AROUND_NS,
            }
            for b in info.of(LagFindings)
        ],
    )
