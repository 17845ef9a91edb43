"""What the report shows of a run to a fixed stop: values, timeline, what settings foretell."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEMAND,
    DETECT,
    DETECTED_NS,
    E0_MM,
    END_NS,
    FORCE_N,
    K_N_M,
    LATCHED_MM,
    MASS_KG,
    RUN,
    STOP,
    STOP_MM,
    V_MM_S,
    recorded,
)

from axisrig.bench.judge.fixed_stop.findings import stop_blocks, stop_events
from axisrig.kernel.time.clock import MS, US

OVERTRAVEL_MM = float(DEMAND[-1]) - LATCHED_MM


def test_values_stand_beside_what_was_expected() -> None:
    (block,) = stop_blocks(recorded())
    found = {value["key"]: value for value in block["values"]}
    lag = found["running_lag"]
    assert (lag["measured"], lag["expected"]) == pytest.approx((E0_MM, E0_MM))
    latched = found["latched"]
    assert latched["measured"] == pytest.approx(LATCHED_MM)
    assert latched["expected"] is None  # without damping the axis rings for ever
    peak = found["stop_force_max"]
    impact_n = V_MM_S * 1e-3 * math.sqrt(K_N_M * MASS_KG)
    assert peak["measured"] == pytest.approx(1.5 * FORCE_N)
    assert peak["low"] == pytest.approx(impact_n)
    assert peak["high"] == pytest.approx(FORCE_N + math.hypot(FORCE_N, impact_n))
    end = found["stop_force_end"]
    assert (end["measured"], end["low"], end["high"]) == pytest.approx((FORCE_N, 0.0, FORCE_N))
    assert found["command_excess"]["measured"] == pytest.approx(OVERTRAVEL_MM)


def test_a_damped_stop_has_a_band_for_what_is_latched() -> None:
    """x_stop + (F_lim -+ F_c)/k -+ 1 um; it decays in 2 m/d = 2 ms, the time is ten times that."""
    damped = {"viscous_friction": 1e5, "coulomb_friction": 50.0, "weight": 20.0}
    (block,) = stop_blocks(recorded(plant=damped))
    (latched,) = [value for value in block["values"] if value["key"] == "latched"]
    low, high = (STOP_MM + (FORCE_N - 20.0 + f) / K_N_M * 1e3 for f in (-50.0, 50.0))
    assert (latched["low"], latched["high"]) == pytest.approx((low - 0.001, high + 0.001))
    assert latched["expected"] == pytest.approx((low + high) / 2)
    short = {DETECT + "min_time": 9_000}
    (block,) = stop_blocks(recorded(plant=damped, written=short))
    (latched,) = [value for value in block["values"] if value["key"] == "latched"]
    assert (latched["low"], latched["note"]) == (
        None, "the minimum time is shorter than 5 decay times of the ringing",
    )  # fmt: skip


def test_the_timeline_is_in_the_order_of_its_process() -> None:
    observed = recorded()
    (block,) = stop_blocks(observed)
    found = [(mark["key"], mark["measured_ns"], mark["oracle_ns"]) for mark in block["marks"]]
    contact_ns = round(CONTACT_MS * MS)
    assert found == [
        ("monitoring_off", 11 * MS, None),
        ("begin", 12 * MS, None),
        ("armed", 30 * MS, None),
        ("contact", pytest.approx(contact_ns, abs=2), None),
        ("beyond", 183 * MS + 600 * US, pytest.approx(182.3 * MS, abs=2)),
        ("detected", DETECTED_NS, pytest.approx(202.3 * MS, abs=2)),
        ("stands", 221 * MS, None),
        ("relax_begin", 230 * MS, None),
        ("relax_end", 250 * MS, None),
        ("monitoring_on", 299 * MS, None),
        ("end", END_NS, None),
    ]
    detected = next(mark for mark in block["marks"] if mark["key"] == "detected")
    assert detected["is_inside"] is True
    # The SYNC after it, 0.6 ms until the cycle, one cycle of sampling
    assert (detected["low_ns"], detected["high_ns"]) == pytest.approx(
        (202.9 * MS, 203.9 * MS), abs=5
    )
    assert (block["main_axis"], block["is_found"]) == ("Z", True)
    assert block["decided_by"] == {"axis": "Z", "criterion": "lag"}
    assert block["limits"]["Z"]["force_limit_n"] == FORCE_N
    assert block["limits"]["Z"]["min_time_ms"] == 20.0
    labels = [(event.kind, event.label) for event in stop_events(observed)]
    assert ("contact", "Z: contact at the stop") in labels
    assert ("brake", "Z: stop detected") in labels
    assert "run over" not in {label for _, label in labels}
    assert block["prediction"] == "contact of Z with its stop, found by lag"
    late = replace(RUN, fixed_stop=replace(STOP, detected_ns=DETECTED_NS + MS))
    (block,) = stop_blocks(recorded(run=late))
    detected = next(mark for mark in block["marks"] if mark["key"] == "detected")
    assert detected["is_inside"] is False


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ({DETECT + "pos_lag_limit": 0, DETECT + "min_time": 0}, "nothing can detect: no crit"),
        ({DETECT + "pos_lag_limit": 1800}, "found in free motion: Z: "),
        ({DETECT + "max_delta_position_window": 500}, "contact of Z with its stop, found by l"),
    ],
)  # fmt: skip
def test_settings_foretell_what_is_found(written: Mapping[str, Any], words: str) -> None:
    (block,) = stop_blocks(recorded(written=written))
    assert block["prediction"].startswith(words)
