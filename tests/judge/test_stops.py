"""Runs to a fixed stop, judged from a recording of an axis that stops without bouncing.

Z goes with v = 10 mm/s from row 20 on, 0.2 mm behind its demand (v/Kv), meets its stop at 140.3 ms
and goes on for 10 ms into it: F/k = 1000 N/(10 kN/mm) = 0.1 mm. The demand goes on until 220 ms.
The CNC sees e0 = v/Kv + (2 - d) v T = 0.18 mm of lag with d = 4, so its limit of 0.5 mm is passed
t_c + (L - e0 + F/k)/v = 182.3 ms, for 20 ms at 202.3 ms; the cycle of SYNC 203 finds the stop.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.fixed_stop.findings import stop_blocks, stop_events
from axisrig.bench.judge.fixed_stop.run import StopRun, stop_runs
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.oracles.fixed_stop.lists import Limits
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


RELAX_ROW = 250
OVERTRAVEL_MM = float(DEMAND[-1]) - LATCHED_MM
DOUBT_N = FORCE_N * 1e-7 / DEEP_MM
"""The plant knows its positions to 0.1 nm: dF = F dp/p."""


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("metric", "value", "uncertainty"),
    [
        ("contact_to_detection_ms", 203.6 - CONTACT_MS, 1e-6),
        ("detection_error_ms", 203.6 - 202.3, 1e-6),
        ("detection_followed_error_ms", 0.0, 0.0),
        ("found_without_contact", 0, 0.0),
        ("relax_ms", 20.0, 0.0),
        ("latch_force_error_um", 0.4, 0.5),  # half an increment of 1 um
        ("stop_force_n", FORCE_N, DOUBT_N),
        ("stop_force_n_max", 1.5 * FORCE_N, 1.5 * FORCE_N * 1e-7 / (1.5 * DEEP_MM)),
        ("stop_force_end_n", FORCE_N, DOUBT_N),
        ("command_overtravel_mm", OVERTRAVEL_MM, 0.0005 + 1e-7),
        ("relax_lag_mm", DEMAND[RELAX_ROW] - LOAD[RELAX_ROW], 1e-7),
        ("after_run_motion_um", 0.0, 1e-4),
        ("after_run_force_n_max", 1.5 * FORCE_N, 1.5 * FORCE_N * 1e-7 / (1.5 * DEEP_MM)),
    ],
)
def test_a_stop_is_judged_by_its_closed_form(
    metric: str, value: float, uncertainty: float, side: float
) -> None:
    found = seen(recorded(side), metric)
    if metric in ("latch_force_error_um", "relax_lag_mm"):
        value *= side
    assert found.value == pytest.approx(value, abs=1e-6)
    assert found.uncertainty == pytest.approx(uncertainty, rel=1e-4, abs=1e-9)


def test_which_criterion_has_decided() -> None:
    assert seen(recorded(), "detection_criterion").value == "lag"
    lost = replace(RUN, fixed_stop=replace(STOP, detected_ns=None, detected_by=None))
    assert seen(recorded(run=lost), "detection_criterion").value == "none"


@pytest.mark.parametrize(
    ("limits", "beyond_ms", "window_ms", "word"),
    [
        (Limits(0.5, None, 20 * MS), 10, 99, "lag"),
        (Limits(None, 0.5, 20 * MS), 99, 10, "window"),
        (Limits(0.5, 0.5, 20 * MS), 10, 31, "window"),
        (Limits(0.5, 0.5, 20 * MS), 10, 30, "lag"),  # both in the same cycle
        (Limits(0.5, 0.5, 20 * MS - 1), 10, 30, "lag"),  # 20 whole cycles
        (Limits(0.5, 0.5, 20 * MS + 1), 10, 31, "lag"),
        (Limits(0.5, 0.5, 0), 10, 11, "window"),
    ],
)
def test_the_criterion_that_came_true_last_decides(
    limits: Limits, beyond_ms: int, window_ms: int, word: str
) -> None:
    cycles = SimpleNamespace(period_ns=MS, up=lambda time_ns: -(-time_ns // MS))
    stop = SimpleNamespace(
        detected_by="Z", detected_ns=1, beyond_ns={"Z": beyond_ms * MS},
        window_ns={"Z": window_ms * MS},
    )  # fmt: skip
    run: Any = SimpleNamespace(stop=stop, limits={"Z": limits}, cycles=cycles)
    assert StopRun.deciding_criterion(run) == word
    for other in ({"detected_by": "X"}, {"detected_ns": None}):
        run.stop = SimpleNamespace(**{**vars(stop), **other})
        assert StopRun.deciding_criterion(run) is None


NO_FORCE = {"columns": {"stop_force_n": None, "stop_force_peak_n": None}}
NOT_FOUND = {"run": replace(RUN, fixed_stop=replace(STOP, detected_ns=None, detected_by=None),
                            latched_mm={})}  # fmt: skip
NOWHERE = {"stop_force_n": 0.0 * PRESSED_N, "stop_force_peak_n": 0.0 * PRESSED_N}
FREE: Mapping[str, Any] = {"plant": {"stop_position": 0.5}, "columns": NOWHERE}
UNRELAXED = {"run": replace(RUN, fixed_stop=replace(STOP, relax_end_ns=None))}
UNTOUCHED = {"columns": {"stop_force_n": 0.0 * PRESSED_N}}
PLAIN = {"run": replace(RUN, fixed_stop=None)}
UNSAID = {"plant": {"stop_direction": None}}


@pytest.mark.parametrize(
    ("metric", "changes", "words"),
    [
        ("contact_to_detection_ms", NOT_FOUND, "no stop was found"),
        ("contact_to_detection_ms", FREE, "axis Z had no contact before"),
        ("contact_to_detection_ms", UNSAID, "the plant of axis Z gives a force at its"),
        ("contact_to_detection_ms:X", {}, "axis X had no contact before"),
        ("detection_error_ms", NOT_FOUND, "no stop was found"),
        ("detection_error_ms", FREE, "no closed form: axis Z meets no stop in the run"),
        ("detection_followed_error_ms", NOT_FOUND, "no stop was found"),
        ("found_without_contact", UNSAID, "the plant of axis Z gives a force at its"),
        ("relax_ms", UNRELAXED, "the run made no relaxing motion"),
        ("relax_lag_mm", UNRELAXED, "the run made no relaxing motion"),
        ("latch_force_error_um", NOT_FOUND, "no measured value of axis Z"),
        ("latch_force_error_um", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("latch_force_error_um", UNSAID, "the plant gives no stop of axis Z"),
        ("latch_force_error_um", UNTOUCHED, "axis Z does not touch its stop then"),
        ("latch_force_error_um:X", {}, "no truth of axis X in this run"),
        ("stop_force_n", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("stop_force_n", NOT_FOUND, "no stop was found"),
        ("stop_force_n_max", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("stop_force_end_n", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("command_overtravel_mm", NOT_FOUND, "no measured value of axis Z"),
        ("stop_force_n_max:X", {}, "the program made no measurement run of axis X to a fixed"),
        ("stop_force_n", PLAIN, "the last measurement run did not go to a fixed stop"),
        ("stop_force_n_max", PLAIN, "the program made no measurement run to a fixed stop"),
    ],
)  # fmt: skip
def test_a_value_that_a_stop_does_not_have_says_why(
    metric: str, changes: Mapping[str, Any], words: str
) -> None:
    found = seen(recorded(**changes), metric)
    assert found.value is None
    assert found.note.startswith(words)


def test_without_a_found_stop_nothing_was_found_without_contact() -> None:
    found = seen(recorded(**NOT_FOUND), "found_without_contact")  # type: ignore[arg-type]
    assert (found.value, found.note) == (0, "no stop was found")
    assert seen(recorded(**FREE), "found_without_contact").value == 1


@pytest.mark.parametrize("turn", [1, -1])
def test_of_several_runs_the_worst_counts_where_it_would_hide(turn: int) -> None:
    """The first one ends before the contact and finds a stop in free motion."""
    early = replace(
        RUN, begin_ns=2 * MS, start_ns=3 * MS, end_ns=100 * MS, block="N10",
        fixed_stop=replace(STOP, detected_ns=90 * MS),
    )  # fmt: skip
    runs = (early, RUN)[::turn]
    observed = recorded(run=runs[1], before=runs[:1])
    free = seen(observed, "found_without_contact")
    number = 1 if turn > 0 else 2
    assert free.value == 1
    assert free.note == f"fixed stop {number} of 2, axis Z"
    force = seen(observed, "stop_force_n_max")
    assert force.value == pytest.approx(1.5 * FORCE_N)
    assert force.note == f"fixed stop {3 - number} of 2, axis Z"
    assert [run.number for run in stop_runs(observed)] == [1, 2]


# A contact that is lost


def _pushed(lost: slice) -> dict[str, Any]:
    """Rows in which the axis is away from its stop by 0.2 mm."""
    load = LOAD.copy()
    load[lost] = STOP_MM - 0.2
    force = np.maximum(load - STOP_MM, 0.0) * 1e-3 * K_N_M
    return {
        "actual_mm": load, "truth_mm": load, "stop_force_n": force, "stop_force_peak_n": force,
        "drive_lag_mm": DEMAND - load,
    }  # fmt: skip


LATE = replace(RUN, fixed_stop=replace(STOP, detected_ns=280 * MS + 600 * US))


@pytest.mark.parametrize(
    ("lost", "value_ms", "words"),
    [
        (slice(160, 208), 280.6 - CONTACT_MS, ""),  # 49 ms from row to row: it bounces
        (slice(160, 209), 280.6 - CONTACT_MS, ""),  # 50 ms
        (slice(160, 210), 280.6 - 209.5, "lost for 51 ms"),
        (slice(230, ROWS), None, "lost for 52 ms"),
        (slice(232, ROWS), 280.6 - CONTACT_MS, ""),
    ],
)
def test_the_contact_that_lasts_is_the_one_that_counts(
    lost: slice, value_ms: float | None, words: str
) -> None:
    """The axis comes back somewhere in a step: half of it is in doubt."""
    found = seen(recorded(run=LATE, columns=_pushed(lost)), "contact_to_detection_ms")
    if value_ms is None:
        assert found.value is None
        assert found.note.startswith("axis Z had lost its contact: first contact 140.3 ms before")
    else:
        assert found.value == pytest.approx(value_ms, abs=0.6 if words else 1e-6)
    assert (words in found.note) or not words
    free = seen(recorded(run=LATE, columns=_pushed(lost)), "found_without_contact")
    assert free.value == int(value_ms is None)
    (block,) = stop_blocks(recorded(run=LATE, columns=_pushed(lost)))
    broken = block["broken_contacts"]
    assert set(broken) == ({"Z"} if words else set())
    if words:
        assert broken["Z"]["first_ns"] == pytest.approx(CONTACT_MS * MS, abs=2)
        assert broken["Z"]["lost_ns"] == pytest.approx(51.3 * MS, abs=0.7 * MS)
        assert (broken["Z"]["since_ns"] is None) == (value_ms is None)


# What has no closed form


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"columns": {"stop_mm": STOP_MM + 1e-6 * K}}, "the stop moves"),
        ({"plant": {"kv": None}}, "the plant does not give gain, mass and stiffness"),
        ({"plant": {"effective_mass": None}}, "the plant does not give gain, mass and stiffness"),
        ({"plant": {"weight": 1000.0}}, "the force limit does not overcome weight and friction"),
        ({"plant": {"coulomb_friction": 1001.0}}, "the force limit does not overcome weight and"),
        ({"plant": {"kv": 60.0}}, "the lag had not settled before the contact: 0.2 mm"),
        ({"run": replace(RUN, begin_ns=131 * MS)}, "the contact came before the feed was steady"),
        ({"written": {DETECT + "pos_lag_limit": 1800}}, "the lag limit 0.18 mm is not above"),
        ({"written": {DETECT + "start_distance_per_mille": 999}}, "the arming path was not"),
        (
            {"written": {DETECT + "start_distance_per_mille": 100},
             "run": replace(RUN, target_mm=None)},
            "the arming path depends on the length of the block",
        ),
    ],
)  # fmt: skip
def test_what_the_closed_form_cannot_say_is_said(changes: Mapping[str, Any], words: str) -> None:
    found = seen(recorded(**changes), "detection_error_ms")
    assert found.value is None
    assert found.note.startswith(f"no closed form: {words}")


def test_an_uneven_feed_has_no_closed_form() -> None:
    """Within 1 % of the feed over ten rows it is steady."""
    for share, is_known in ((0.995, True), (0.98, False)):
        slower = DEMAND.copy()
        step = V_MM_S * 1e-3 * share
        slower[:141] = DEMAND[140] - (140 - K[:141]) * step
        slower[:136] -= 5 * (V_MM_S * 1e-3 - step)
        slower[136:141] = DEMAND[136:141]
        found = seen(recorded(columns={"drive_lag_mm": slower - LOAD}), "detection_error_ms")
        assert ("not steady" in found.note) is not is_known


def test_the_arming_path_makes_the_detection_later() -> None:
    """30 % of the block of 5 mm are gone at 170 ms, 1.9 mm of start distance at 210 ms."""
    far = {DETECT + "start_distance": 19_000}
    observed = recorded(written=far)
    (run,) = stop_runs(observed)
    assert run.arming_mm == pytest.approx(1.9)
    assert run.block_mm == pytest.approx(5.0)
    assert run.armed_ns == pytest.approx((FIRST + 190 - 1) * MS, abs=1.01 * MS)
    assert "arming path gone after the criterion came true" in run.beyond("Z").note
    both = {DETECT + "start_distance": 19_000, DETECT + "start_distance_per_mille": 300}
    (run,) = stop_runs(recorded(written=both))
    assert run.arming_mm == pytest.approx(1.5)
    (run,) = stop_runs(recorded(-1.0, written=far))
    assert run.block_mm == pytest.approx(5.0)


# What the report shows


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
