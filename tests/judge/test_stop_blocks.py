"""What the report shows of a run to a fixed stop: values, timeline, what settings foretell."""

import math
from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    BY_LAG,
    CONTACT_MS,
    DEEP_MM,
    DEMAND,
    DETECT,
    DETECTED_NS,
    E0_MM,
    END_NS,
    FORCE_N,
    K_N_M,
    LATCHED_MM,
    MASS_KG,
    ROWS,
    RUN,
    STOP,
    STOP_MM,
    V_MM_S,
    K,
    recorded,
    seen,
)

from axisrig.bench.judge.fixed_stop.findings import stop_events, stop_findings
from axisrig.bench.judge.fixed_stop.stop_findings import Decision
from axisrig.bench.judge.fixed_stop.values import Value, prediction
from axisrig.bench.oracles.fixed_stop.lists import Limits
from axisrig.bench.oracles.fixed_stop.slopes import slopes_as_written
from axisrig.kernel.time.clock import MS, US

OVERTRAVEL_MM = float(DEMAND[-1]) - LATCHED_MM


def test_values_stand_beside_what_was_expected() -> None:
    (block,) = stop_findings(recorded())
    found = {value.key: value for value in block.values}
    lag = found["running_lag"]
    assert (lag.measured, lag.expected) == pytest.approx((E0_MM, E0_MM))
    latched = found["latched"]
    assert latched.measured == pytest.approx(LATCHED_MM)
    assert latched.expected is None  # without damping the axis rings for ever
    peak = found["stop_force_max"]
    impact_n = V_MM_S * 1e-3 * math.sqrt(K_N_M * MASS_KG)
    assert peak.measured == pytest.approx(1.5 * FORCE_N)
    assert peak.low == pytest.approx(impact_n)
    assert peak.high == pytest.approx(FORCE_N + math.hypot(FORCE_N, impact_n))
    end = found["stop_force_end"]
    assert (end.measured, end.low, end.high) == pytest.approx((FORCE_N, 0.0, FORCE_N))
    assert found["command_excess"].measured == pytest.approx(OVERTRAVEL_MM)


def test_a_damped_stop_has_a_band_for_what_is_latched() -> None:
    """x_stop + (F_lim -+ F_c)/k -+ 1 um; it decays in 2 m/d = 2 ms, the time is ten times that."""
    damped = {"viscous_friction": 1e5, "coulomb_friction": 50.0, "weight": 20.0}
    (block,) = stop_findings(recorded(plant=damped))
    (latched,) = [value for value in block.values if value.key == "latched"]
    low, high = (STOP_MM + (FORCE_N - 20.0 + f) / K_N_M * 1e3 for f in (-50.0, 50.0))
    assert (latched.low, latched.high) == pytest.approx((low - 0.001, high + 0.001))
    assert latched.expected == pytest.approx((low + high) / 2)
    for way_mm in (0.01, -0.01):  # in each ms from the contact on
        path = STOP_MM + way_mm * np.maximum(K - 190.0, 0.0)
        (block,) = stop_findings(recorded(plant=damped, columns={"stop_mm": path}))
        (latched,) = [value for value in block.values if value.key == "latched"]
        assert (latched.low, latched.note) == (None, "the stop moves")
    for way_mm in (0.04, -0.04):  # it has come to rest again where it was detected
        path = STOP_MM + way_mm * np.clip((K - 150) / 20.0, 0.0, 1.0)
        (block,) = stop_findings(recorded(plant=damped, columns={"stop_mm": path}))
        (latched,) = [value for value in block.values if value.key == "latched"]
        assert (latched.low, latched.high) == pytest.approx(
            (low + way_mm - 0.001, high + way_mm + 0.001)
        )
    short = {DETECT + "min_time": 9_000}
    (block,) = stop_findings(recorded(plant=damped, written=short))
    (latched,) = [value for value in block.values if value.key == "latched"]
    assert (latched.low, latched.note) == (
        None, "the minimum time is shorter than 5 decay times of the ringing",
    )  # fmt: skip


def test_the_timeline_is_in_the_order_of_its_process() -> None:
    observed = recorded()
    (block,) = stop_findings(observed)
    found = [(mark.key, mark.measured_ns, mark.oracle_ns) for mark in block.marks]
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
    detected = next(mark for mark in block.marks if mark.key == "detected")
    assert detected.is_inside is True
    # The SYNC after it, 0.6 ms until the cycle, one cycle of sampling
    assert (detected.low_ns, detected.high_ns) == pytest.approx((202.9 * MS, 203.9 * MS), abs=5)
    assert (block.main_axis, block.is_found) == ("Z", True)
    assert block.decided_by == Decision("Z", "lag")
    assert block.limits["Z"].force_limit_n == FORCE_N
    assert block.limits["Z"].min_time_ms == 20.0
    labels = [(event.kind, event.label) for event in stop_events(observed)]
    assert ("contact", "Z: contact at the stop") in labels
    assert ("brake", "Z: stop detected") in labels
    assert "run over" not in {label for _, label in labels}
    assert block.prediction == "contact of Z with its stop, found by lag"
    late = replace(RUN, fixed_stop=replace(STOP, detected_ns=DETECTED_NS + MS))
    (block,) = stop_findings(recorded(run=late))
    detected = next(mark for mark in block.marks if mark.key == "detected")
    assert detected.is_inside is False


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ({DETECT + "pos_lag_limit": 0, DETECT + "min_time": 0}, "nothing can detect: no crit"),
        ({DETECT + "pos_lag_limit": 1800}, "found in free motion: Z: "),
        ({DETECT + "max_delta_position_window": 500}, "contact of Z with its stop, found by l"),
    ],
)  # fmt: skip
def test_settings_foretell_what_is_found(written: Mapping[str, Any], words: str) -> None:
    (block,) = stop_findings(recorded(written=written))
    assert block.prediction.startswith(words)


@pytest.mark.parametrize("axes", ["", "X", "Z", "XZ"])
def test_something_can_detect_where_one_axis_has_a_criterion(axes: str) -> None:
    """Of two axes; ramps are on, so that nothing else is foretold."""
    limits = {name: Limits(0.5 if name in axes else None) for name in "XZ"}
    facts = SimpleNamespace(channel={"prog_start.slope.profile": 2}, blocks=None)
    run: Any = SimpleNamespace(limits=limits, observed=SimpleNamespace(facts=facts))
    words = "no closed form with the ramps" if axes else "nothing can detect: no criterion is on"
    assert prediction(run).startswith(words)


def value_of(key: str, **changes: Any) -> Value | None:
    (block,) = stop_findings(recorded(**changes))
    return next((value for value in block.values if value.key == key), None)


def test_the_set_value_goes_on_until_the_cycle_that_brakes_has_acted() -> None:
    """L + v (tau + t_d) + v^2/2a: found between 202.3 and 203.3 ms, d - 1 = 3 cycles later sent."""
    found = value_of("command_excess", plant={"viscous_friction": 1e5})
    assert found is not None
    way_mm = slopes_as_written(BY_LAG, {}).on_signal.way_mm(V_MM_S)
    low = E0_MM + V_MM_S * 1e-3 * (202.3 - CONTACT_MS + 3) - DEEP_MM + way_mm
    assert (found.low, found.high) == pytest.approx((low, low + V_MM_S * 1e-3), abs=1e-5)
    assert found.expected == pytest.approx(low + V_MM_S * 1e-3 / 2, abs=1e-5)
    # A stop that rings has no such end, and none of two axes
    ringing = value_of("command_excess")
    assert ringing is not None
    assert (ringing.low, ringing.note) == (
        None, "the minimum time is shorter than 5 decay times of the ringing",
    )  # fmt: skip


def at(row: int, value: float, otherwise: Any = 0.0) -> Any:
    return np.where(row == K, value, otherwise)


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({"columns": {"velocity_mm_s": at(203, 0.11)}}, "the axis was not at rest at the detec"),
        ({"columns": {"velocity_mm_s": at(203, -0.11)}}, "the axis was not at rest at the detec"),
        ({"columns": {"stop_mm": STOP_MM + 2e-4 * K}}, "the stop moves"),
        ({"columns": {"stop_mm": STOP_MM + 0.05e-3 * K}}, "x_stop + (F_lim"),  # 0.05 mm/s is rest
        ({"run": replace(RUN, fixed_stop=replace(STOP, detected_ns=130 * MS))}, "latched before c"),
        ({"run": replace(RUN, fixed_stop=replace(STOP, detected_ns=None))}, "no detection at a st"),
        ({}, "x_stop + (F_lim - F_g +- F_c)/k +- 1 um, F_lim 1000 N, F_g 0 N, F_c 0 N; ringing de"
             "cays in 2 ms"),
    ],
)  # fmt: skip
def test_a_latched_value_has_a_band_at_rest_alone(changes: dict[str, Any], note: str) -> None:
    """It decays in 2 m/d = 2 ms, the axis counts as at rest up to 0.1 mm/s."""
    found = value_of("latched", plant={"viscous_friction": 1e5}, **changes)
    assert found is not None
    assert found.note.startswith(note)
    assert (found.low is None) is not note.startswith("x_stop")


def test_what_still_rings_at_the_end_adds_to_the_force() -> None:
    """v sqrt(k m) of the largest speed in the last period of 2 pi sqrt(m/k) = 19.9 ms."""
    for row, speed, adds in ((295, 0.05, True), (295, -0.05, True), (279, 0.05, False)):
        found = value_of("stop_force_end", columns={"velocity_mm_s": at(row, speed)})
        assert found is not None
        more = 0.05e-3 * math.sqrt(K_N_M * MASS_KG) if adds else 0.0
        assert found.high == pytest.approx(FORCE_N + more)
    restless = value_of("stop_force_end", columns={"velocity_mm_s": at(295, 0.11)})
    assert restless is not None
    assert (restless.high, restless.note) == (
        None, "the axis was not at rest at the end: no bound",
    )  # fmt: skip
    assert value_of("stop_force_end", columns={"stop_mm": STOP_MM + 1e-6 * K}) is None


@pytest.mark.parametrize(
    ("plant", "columns", "deep_mm"),
    [
        ({}, {}, 0.1),
        ({"stop_damping": 1.0}, {"velocity_mm_s": at(203, 100.0)}, 0.1 / 1.1),  # F = k p (1 + a v)
        ({"stop_damping": 1.0}, {"velocity_mm_s": at(203, -100.0)}, 0.1 / 0.9),
        ({"stop_damping": 1.0}, {"velocity_mm_s": at(204, 100.0)}, 0.1),
        # The screw gives F/k and half of its backlash: of the stop's force, or the motor's
        ({"screw_stiffness": 1e8, "backlash": 2e-6}, {}, 0.1 + 0.01 + 0.001),
        ({"screw_stiffness": 1e8}, {"force_n": np.full(ROWS, -800.0)}, 0.1 + 0.008),
        ({"screw_stiffness": 1e8, "effective_mass": None}, {}, 0.1),
    ],
)
def test_an_encoder_is_where_the_force_and_the_screw_put_it(
    plant: dict[str, Any], columns: dict[str, Any], deep_mm: float
) -> None:
    found = seen(recorded(plant=plant, columns=columns), "latch_force_error_um")
    assert found.value == pytest.approx((LATCHED_MM - STOP_MM - deep_mm) * 1e3, abs=1e-6)


def test_both_criteria_and_the_path_are_in_the_timeline() -> None:
    both = {DETECT + "max_delta_position_window": 1500, DETECT + "start_distance": 5000}
    (block,) = stop_findings(recorded(written=both))
    found = {mark.key: mark for mark in block.marks}
    window = found["window"]
    assert window.measured_ns == STOP.window_ns["Z"]
    assert window.oracle_ns == pytest.approx(155.3 * MS, abs=5)
    assert window.is_inside is False
    armed = found["armed"]
    assert armed.measured_ns == 30 * MS
    # 0.5 mm after row 20 are row 70; the interpolation was there a cycle before
    assert armed.oracle_ns == pytest.approx(69 * MS, abs=1)
    assert armed.note.startswith("arming path 0.5 mm gone")
    # 1 % of a cycle, which an increment of the demand makes, and the sampling
    assert (armed.low_ns, armed.high_ns) == pytest.approx((69.59 * MS, 70.61 * MS), abs=2)
    contact = found["contact"]
    assert (contact.source, contact.note) == ("plant", "known to 0.001 us")
    assert found["detected"].source == "kernel"
    assert (block.begin_ns, block.end_ns, block.watched) == (10 * MS, END_NS, ["Z"])


def test_a_mark_with_a_reason_alone_is_shown_and_an_empty_one_is_not() -> None:
    """Nothing came true and no closed form says when; the run made no relaxing motion."""
    both = {DETECT + "max_delta_position_window": 1500}
    never = replace(
        STOP, beyond_ns={}, window_ns={}, detected_ns=None, detected_by=None, relax_begin_ns=None,
        relax_end_ns=None, brake_end_ns=None,
    )  # fmt: skip
    changes: dict[str, Any] = {"run": replace(RUN, fixed_stop=never, latched_mm={})}
    (block,) = stop_findings(recorded(plant={"kv": None}, written=both, **changes))
    marks = {mark.key: mark for mark in block.marks}
    for key in ("beyond", "window", "detected"):
        mark = marks[key]
        assert (mark.measured_ns, mark.oracle_ns, mark.is_inside) == (None, None, None)
        assert mark.note == "the plant does not give gain, mass and stiffness"
    assert not marks.keys() & {"stands", "relax_begin", "relax_end"}
    (plain,) = stop_findings(recorded(**changes))
    assert [mark.oracle_ns is None for mark in plain.marks if mark.key == "beyond"] == [False]


def test_notes_say_once_why_there_is_no_closed_form() -> None:
    both = {DETECT + "max_delta_position_window": 1500}
    (block,) = stop_findings(recorded(plant={"kv": None}, written=both))
    assert block.notes == ["Z: the plant does not give gain, mass and stiffness"]
    (known,) = stop_findings(recorded())
    assert known.notes == []  # a criterion that is off is nothing to say
    (lost,) = stop_findings(recorded(run=replace(RUN, fixed_stop=replace(
        STOP, detected_ns=None, detected_by=None))))  # fmt: skip
    assert (lost.is_found, lost.decided_by, lost.main_axis) == (False, None, "Z")


def test_a_force_limit_has_the_sign_of_its_direction() -> None:
    (up,), (down,) = (stop_findings(recorded(side)) for side in (1.0, -1.0))
    assert up.limits["Z"].force_limit_n == FORCE_N
    assert down.limits["Z"].force_limit_n == -FORCE_N
    (open_,) = stop_findings(recorded(plant={"force_limit_motor": None}))
    assert open_.limits["Z"].force_limit_n is None


def test_a_mark_that_was_not_measured_is_in_no_band() -> None:
    """The closed form says when the stop had to be found; nothing has found it."""
    missed = replace(STOP, detected_ns=None, detected_by=None, beyond_ns={})
    (block,) = stop_findings(recorded(run=replace(RUN, fixed_stop=missed)))
    marks = {mark.key: mark for mark in block.marks}
    for key in ("beyond", "detected"):
        assert marks[key].measured_ns is None
        assert marks[key].oracle_ns is not None
        assert marks[key].is_inside is None
        assert not marks[key].says_nothing
    (found,) = stop_findings(recorded())
    inside = {mark.key: mark.is_inside for mark in found.marks}
    assert (inside["beyond"], inside["detected"], inside["contact"]) == (True, True, None)
