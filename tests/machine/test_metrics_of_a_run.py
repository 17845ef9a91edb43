"""Metrics of a measurement run, of what the plant and the record say."""

from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import AxisRecord, Contact, PlantRecord, ProbeRecord
from axisrig.bench.record.facts import Facts, Timing
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import Series
from axisrig.kernel.time.clock import MS, US, S

CONTACT_NS = 123_456_789


def braking(metric: str, first_ns: int, end_ns: int = 200 * MS) -> Any:
    """Observe a metric of Z that goes down with 50 mm/s and brakes with 10 000 mm/s2, 8 ms rows.

    It meets 100 mm at CONTACT_NS and brakes from there on: 0.125 mm in 5 ms. first_ns: of the rows.
    """
    times = np.arange(first_ns, S, 8 * MS)
    t = (times - CONTACT_NS) * 1e-9
    back = np.clip(t, 0.0, 0.01)  # 5 ms down, 5 ms up again, then on with 50 mm/s
    table = {
        "time_ns": times,
        "Z.truth_mm": 100.0 - 50.0 * t + 5000.0 * back**2 + 100.0 * np.maximum(t - 0.01, 0.0),
        "Z.velocity_mm_s": -50.0 + 10_000.0 * back,
        "Z.drive_lag_mm": np.zeros(len(times)),
    }
    facts = Facts(
        Timing(8 * MS, 0, 0),
        sim_ns=S,
        start_ns=0,
        end_ns=S,
        frame_log_sha256="",
        axes={"Z": AxisRecord("can1", 1, 1000.0, plant="z", signals={"probe_1": "probe"})},
        plants={"z": PlantRecord()},
        probes={"probe": ProbeRecord(True, 1.0, (Contact(CONTACT_NS, {"z": 100.0}),))},
        runs=(MeasurementRun(("Z",), inputs={"Z": 1}, end_ns=end_ns),),
    )
    return observe(Observed(facts, Series(pa.table(table))), parse_check(metric, "> 0", ""))


@pytest.mark.parametrize("phase", range(8))
def test_overtravel_and_speed_at_contact_are_known_between_two_syncs(phase: int) -> None:
    """Wherever the SYNCs are: the farthest place is 0.125 mm past the contact, or 0.7 mm back."""
    end_ns = CONTACT_NS + 9 * MS
    way = braking("overtravel_mm", phase * MS, end_ns)
    assert abs(way.value - 0.125) <= 3 * way.uncertainty <= 0.2
    speed = braking("contact_velocity_mm_s", phase * MS)
    assert abs(speed.value + 50.0) <= 3 * speed.uncertainty
    assert "signed" in speed.note


def test_the_lag_of_no_delay_is_the_one_that_the_cnc_judges() -> None:
    """P-AXIS-00191 = 0: the row has s(k) - x(k); judged is s(k-1) - x(k), 0.4 mm and not 0.5."""
    rows, written = 5000, {"antr.nbr_delay_cycles": 0}
    set_mm = np.arange(rows) * 0.1
    table = pa.table(
        {
            "time_ns": np.arange(rows) * MS,
            "Z.set_mm": set_mm,
            "Z.cnc_lag_mm": np.full(rows, 0.5),
            "Y.set_mm": set_mm,
            "Y.cnc_lag_mm": np.full(rows, 0.45),
        }
    )
    axes = {
        "Z": AxisRecord("can1", 1, 1000.0, written=written),
        "Y": AxisRecord("can1", 2, 1000.0, written={"antr.nbr_delay_cycles": 1}),
    }
    facts = Facts(Timing(MS, 0, 0), 5 * S, 0, 5 * S, "", axes=axes)
    observed = Observed(facts, Series(table))
    # The first row has none before it
    for metric, value in (("lag_mm_max:Z", 0.5), ("lag_mm_max:Y", 0.45), ("lag_mm_max", 0.5)):
        assert observe(observed, parse_check(metric, "> 0", "")).value == pytest.approx(value)
    table = table.set_column(2, "Z.cnc_lag_mm", pa.array([0.0, *[0.5] * (rows - 1)]))
    observed = Observed(facts, Series(table))
    for metric, value in (("lag_mm_max:Z", 0.4), ("lag_mm_max", 0.45)):
        assert observe(observed, parse_check(metric, "> 0", "")).value == pytest.approx(value)


def test_a_motor_that_goes_straight_has_no_lag_between_two_rows() -> None:
    """It is where its demand is, and its speed jumps at each row."""
    speeds = np.array([0.0, 0.01, 0.03, 0.03, -0.02])
    times, motor = np.arange(5) * 8 * MS, np.cumsum(speeds) * 8e-3
    lag = largest_lag(times, (motor, motor, speeds), 250 * US)
    assert lag == pytest.approx(0.0, abs=1e-15)
    bent = largest_lag(times, (motor, motor, speeds + 1e-4), 250 * US)
    assert np.max(bent) > 1e-6


def answer(metric: str, period_ns: int, end_ns: int | None) -> Any:
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
    found = answer("contact_to_standstill_ms", period_ms * MS, end_ns)
    assert found.value == (end_ns - CONTACT_NS) / 1e6 == 77.143211
    assert found.uncertainty == period_ms


def test_a_run_that_did_not_end_has_no_standstill() -> None:
    found = answer("contact_to_standstill_ms", MS, None)
    assert (found.value, found.note) == (None, "the measurement run did not end")
