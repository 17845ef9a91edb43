"""Metrics of a measurement run, of what the plant and the record say."""

from typing import Any

import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import AxisRecord, Contact, ProbeRecord
from axisrig.bench.record.facts import Facts, Timing
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import Series
from axisrig.kernel.time.clock import MS, US, S

CONTACT_NS = 123_456_789


def told(metric: str, period_ns: int, end_ns: int | None) -> Any:
    """Observe a metric of a run of Z whose contact came at CONTACT_NS."""
    facts = Facts(
        Timing(period_ns, 0, 0),
        sim_ns=S,
        start_ns=0,
        end_ns=S,
        frame_log_sha256="",
        axes={"Z": AxisRecord("can1", 1, 1000.0, plant="z", signals={"probe_1": "probe"})},
        probes={"probe": ProbeRecord(True, 1.0, (Contact(CONTACT_NS, {"z": 100.0}),))},
        runs=(MeasurementRun(("Z",), inputs={"Z": 1}, end_ns=end_ns),),
    )
    series = Series(pa.table({"time_ns": [0, S], "Z.truth_mm": [0.0, 1.0]}))
    return observe(Observed(facts, series), parse_check(metric, "> 0", ""))


@pytest.mark.parametrize("period_ms", [1, 2])
def test_contact_to_standstill_is_known_to_a_period(period_ms: int) -> None:
    """The axes stand in a cycle; that they stood one earlier it cannot have seen."""
    end_ns = 200 * MS + 600 * US
    found = told("contact_to_standstill_ms", period_ms * MS, end_ns)
    assert found.value == (end_ns - CONTACT_NS) / 1e6 == 77.143211
    assert found.uncertainty == period_ms


def test_a_run_that_did_not_end_has_no_standstill() -> None:
    found = told("contact_to_standstill_ms", MS, None)
    assert (found.value, found.note) == (None, "the measurement run did not end")
