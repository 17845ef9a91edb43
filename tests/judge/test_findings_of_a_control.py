"""What the report shows of a distance control: marks, stretches, laws, errors, limits.

Recordings made of formulas (`controls.py`): 1 ms, kp 0.2, no filter, on from row 100 on.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import INVERTS, ON, ROWS, SET_DIST_MM, K, recorded
from tests.recordings import kept

from axisrig.bench.judge.distance.control_findings import ControlFindings
from axisrig.bench.judge.distance.findings import control_findings, distance_events
from axisrig.bench.judge.distance.truth import (
    ACTIVE,
    ACTIVE_CONST_DIST,
    FREEZE,
    INACTIVE,
    TURNING_OFF,
)
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.cycles import predicted
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS
from axisrig.bench.record.axes import PlantRecord, PlantValue, Telegram
from axisrig.bench.record.distance import (
    ChannelDistanceRecord,
    Controller,
    DistanceChange,
    DistanceOrder,
    PlcSensor,
)
from axisrig.kernel.parameters.table import Kind, table
from axisrig.kernel.time.clock import MS

CONTROLLER = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, False)


def change(row: int, state: str, by: str = "NC", is_dry: bool = False) -> DistanceChange:
    return DistanceChange(row * MS, state, by, "60E4", is_dry, CONTROLLER)


CONST = change(ON, "ACTIVE_CONST_DIST")


def found(*given: Any, **changed: Any) -> ControlFindings:
    (block,) = control_findings(recorded(*given, **{"changes": (CONST,), **changed}))
    return block


# Marks


def test_what_the_program_commands_is_a_mark_and_what_comes_by_itself_is_none() -> None:
    changes = (
        change(0, "INACTIVE"),  # as it was
        change(100, "ACTIVE_CONST_DIST"),
        change(150, "ACTIVE_CONST_DIST"),  # other values
        change(200, "FREEZE"),
        change(300, "ACTIVE", "PLC"),
        change(350, "ACTIVE", is_dry=True),
        change(370, "ACTIVE"),
        change(400, "TURNING_OFF"),
        change(420, "INACTIVE"),  # the offset has run out
        change(500, "ACTIVE"),
        change(600, "INACTIVE"),
        change(700, "ACTIVE"),
        change(750, "ERROR"),
        change(800, "TURNING_OFF", "PLC"),
        change(810, "INACTIVE"),
    )
    observed = recorded(changes=changes)
    words = [
        (100, "ON_CONST_DIST"), (200, "FREEZE"), (350, "ON (dry run)"), (370, "ON"),
        (400, "OFF"), (500, "ON"), (600, "OFF"), (700, "ON"),
    ]  # fmt: skip
    marks = distance_events(observed)
    assert [(mark.time_ns // MS, mark.label) for mark in marks] == [
        (row, f"Z: {word} by NC") for row, word in words
    ]
    assert {(mark.kind, mark.axis) for mark in marks} == {("mark", "Z")}
    both = replace(observed.facts, distance_3d=ChannelDistanceRecord(changes=changes[:2]))
    marks = distance_events(Observed(both, observed.series))
    assert [mark.label for mark in marks[len(words) :]] == ["channel: ON_CONST_DIST by NC"]


@pytest.mark.parametrize("first", ["NC", "PLC"])
def test_a_mark_names_who_has_commanded_its_own_change(first: str) -> None:
    """The PLC has marks of its own, whoever was the first."""
    changes = (
        change(0, "INACTIVE", first), change(100, "ACTIVE", "PLC"), change(200, "FREEZE"),
        change(300, "ACTIVE", "PLC"), change(400, "TURNING_OFF"),
    )  # fmt: skip
    marks = [
        (mark.time_ns // MS, mark.label) for mark in distance_events(recorded(changes=changes))
    ]
    assert marks == [(200, "Z: FREEZE by NC"), (400, "Z: OFF by NC")]


# Stretches and their laws


def test_a_stretch_lasts_until_the_next_change_and_has_its_set_values_while_it_follows() -> None:
    changes = (
        change(0, "INACTIVE"), change(100, "ACTIVE_CONST_DIST"), change(400, "FREEZE", "PLC"),
        change(600, "ACTIVE", is_dry=True), change(800, "TURNING_OFF", is_dry=True),
    )  # fmt: skip
    orders = (
        DistanceOrder(99 * MS, "NC", "ON_CONST_DIST"), DistanceOrder(400 * MS, "PLC", "FREEZE"),
        DistanceOrder(599 * MS, "NC", "ON", is_dry_run=True), DistanceOrder(799 * MS, "NC", "OFF"),
    )  # fmt: skip
    state = np.select(
        [K < 100, K < 400, K < 600, K < 800], [INACTIVE, ACTIVE_CONST_DIST, FREEZE, ACTIVE],
        TURNING_OFF,
    )  # fmt: skip
    columns = {
        "distance_state": state.astype(float),
        "set_dist_mm": np.where(K < 103, np.nan, np.where(K < 300, 2.0, 2.5)),
        "set_pos_mm": np.where(K < 700, -3.0, -4.0),
    }
    block = found(changes=changes, orders=orders, columns=columns)
    rows = [(s.begin_ns // MS, s.end_ns // MS, s.state, s.by) for s in block.stretches]
    assert rows == [
        (0, 100, "INACTIVE", "NC"), (100, 400, "ACTIVE_CONST_DIST", "NC"),
        (400, 600, "FREEZE", "PLC"), (600, 800, "ACTIVE", "NC"),
        (800, ROWS - 1, "TURNING_OFF", "NC"),
    ]  # fmt: skip
    values = [(s.set_mm, s.set_end_mm) for s in block.stretches]
    assert values == [(None, None), (2.0, 2.5), (None, None), (-3.0, -4.0), (None, None)]
    assert [s.is_dry_run for s in block.stretches] == [False, False, False, True, False]
    modes = [None if s.law is None else s.law.mode for s in block.stretches]
    assert modes == [None, CONST_DIST, None, SET_POS, None]
    assert [law.mode for law in block.laws] == [CONST_DIST, SET_POS]


def test_equal_laws_are_shown_once() -> None:
    changes = (CONST, change(400, "FREEZE"), change(500, "ACTIVE_CONST_DIST"))
    orders = tuple(
        DistanceOrder((one.time_ns // MS - 1) * MS, "NC", word)
        for one, word in zip(changes, ("ON_CONST_DIST", "FREEZE", "ON_CONST_DIST"), strict=True)
    )
    state = np.select([K < ON, K < 400, K < 500], [INACTIVE, ACTIVE_CONST_DIST, FREEZE],
                      ACTIVE_CONST_DIST).astype(float)  # fmt: skip
    block = found(changes=changes, orders=orders, columns={"distance_state": state})
    assert sum(stretch.law is not None for stretch in block.stretches) == 2
    assert len(block.laws) == 1


@pytest.mark.parametrize(
    ("state", "words", "controller", "formula"),
    [
        (ACTIVE, {}, {}, "o += {}(kp (filter(Z + s − SET_POS) − o))"),
        (ACTIVE_CONST_DIST, {}, {}, "o += {}(kp (SET_DIST − filter(d)))"),
        (ACTIVE_CONST_DIST, {"mode_dist_use_both_encoder": 1}, {},
         "o += {}(kp (SET_DIST − filter(d − (Z − Z_com))))"),
        (ACTIVE_CONST_DIST, {"i_tn": 0.5}, {}, "o += {}(PID(SET_DIST − filter(d)))"),
        (ACTIVE_CONST_DIST, {"d_tv": 0.25}, {"derivative_of": "error"},
         "o += {}(PID(SET_DIST − filter(d))); D: Tv/T times the change of the error"),
        (ACTIVE_CONST_DIST, {"d_tv": 0.25},
         {"derivative": "per_cycle", "derivative_of": "feedback"},
         "o += {}(PID(SET_DIST − filter(d))); D: Tv times the change of the feedback"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("limiter", ["slope", "clamp"])
def test_a_law_is_that_of_its_mode_with_what_the_rig_has_chosen(
    state: int, words: Mapping[str, Any], controller: Mapping[str, Any], formula: str, limiter: str
) -> None:
    """docs/distance-control.md, The law."""
    name = "ACTIVE" if state == ACTIVE else "ACTIVE_CONST_DIST"
    chosen = replace(CONTROLLER, limiter=limiter, **controller)
    on = DistanceChange(ON * MS, name, "NC", "60E4", False, chosen)
    order = DistanceOrder((ON - 1) * MS, "NC", "ON" if state == ACTIVE else "ON_CONST_DIST")
    block = found(0.0, 0.0, state, (order,), words, changes=(on,))
    (law,) = block.laws
    assert law.formula == formula.format(limiter)
    assert (law.kp, law.tn_s, law.tv_s) == (0.2, words.get("i_tn", 0.0), words.get("d_tv", 0.0))
    assert block.limits[0].acts == f"{limiter}s"


def test_theory_of_a_law_is_that_of_its_loop() -> None:
    """A mean of N = 5: delay (N - 1)/2 = 2 cycles, noise 1/sqrt(5), kp 2 N sin2(w/2)/sin(N w/2).

    w = pi/(N + 2n); with optimized scheduling the loop is dead for one cycle less than n = 2.
    """
    for optimized, dead in ((0, 2), (1, 1)):
        block = found(words={"n_cycles": 5, "optimized_scheduling": optimized})
        (law,) = block.laws
        w = math.pi / (5 + 2 * dead)
        assert law.kp_limit == pytest.approx(10.0 * math.sin(w / 2) ** 2 / math.sin(5 * w / 2))
        assert (law.delay_cycles, law.noise_gain) == pytest.approx((2.0, 5**-0.5))
        assert (law.dead_cycles, law.age_cycles, law.drive_lag_ms) == (dead, 0, 0.0)
        assert (block.late_cycles, block.dead.predicted) == (1 - optimized, dead)
        assert law.growth < 1.0
        assert law.kp_limit_unknown == ""


def test_a_law_is_that_of_the_step_after_its_first_row() -> None:
    """What the program gives with its command acts in the next cycle; its state is there."""
    order = DistanceOrder(ON * MS, "NC", "ON_CONST_DIST", words={"kp": 0.1})
    (law,) = found(orders=(order,)).laws
    assert law.kp == 0.1


def test_what_no_closed_form_knows_of_a_law_is_named() -> None:
    """60E4 with every second SYNC, or the loops of a drive: its lag is (1 - f)/Kv = 15 ms."""
    seldom = found(telegrams=(Telegram("TPDO2", 2, ("second",)),))
    (law,) = seldom.laws
    assert (law.kp_limit, law.kp_limit_unknown) == (None, "60E4 does not come with every SYNC")
    observed = recorded(changes=(CONST,))
    drive = {"kv": PlantValue(50.0), "feed_forward": PlantValue(0.25)}
    lagging = replace(observed.facts, plants={"z": PlantRecord(drive)})
    (block,) = control_findings(Observed(lagging, observed.series))
    assert block.laws[0].kp_limit is None
    assert "the loops of the drive are part of it" in block.laws[0].kp_limit_unknown
    assert block.laws[0].drive_lag_ms == pytest.approx(15.0)


# The error at the end of a stretch

RAMP = np.clip((K - 300) * 0.01, 0.0, 4.0)
"""10 mm/s from row 300 to row 700."""
LAG_MM = np.where((K > 300) & (K <= 700), 0.05, 0.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("end", "speed", "mean", "expected"),
    [(600, 10.0, 0.05, 0.05), (772, 0.0, 0.0, 0.0), (900, 0.0, 0.0, 0.0)],
)
def test_the_error_at_the_end_of_a_stretch_is_beside_its_closed_form(
    end: int, speed: float, mean: float, expected: float, side: float
) -> None:
    """In the last fifth since the surface moves as at its end: v T/kp on the ramp, 0 at rest."""
    swing = 0.002 * (-1.0) ** K
    block = found(
        side * LAG_MM + swing, side * RAMP, changes=(CONST, change(end, "FREEZE")),
        columns={"distance_state": np.where(K < ON, INACTIVE, np.where(
            end > K, ACTIVE_CONST_DIST, FREEZE)).astype(float)},
    )  # fmt: skip
    (error,) = block.errors
    assert (error.begin_ns, error.mode) == (ON * MS, CONST_DIST)
    assert error.speed_mm_s == pytest.approx(side * speed)
    assert (error.measured_mm, error.spread_mm) == pytest.approx((side * mean, 0.002), abs=1e-4)
    assert (error.expected_mm, error.note) == (pytest.approx(side * expected), "")


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({"words": {"i_tn": 0.02}}, "closed form of P and PD control only"),
        ({"words": {"kp": 1.5}}, "the loop is not stable"),
        ({"columns": {"step_mm": np.full(ROWS, 0.02), "delta_mm": np.full(ROWS, 0.01)}},
         "the offset is limited"),
    ],
)  # fmt: skip
def test_an_error_without_a_closed_form_says_why(changes: dict[str, Any], note: str) -> None:
    (error,) = found(LAG_MM, np.where(K < 300, 0.0, (K - 300) * 0.01), **changes).errors
    assert error.expected_mm is None
    assert error.note.startswith(note)


def test_only_stretches_that_move_the_tool_have_an_error() -> None:
    """None of a dry run, of fewer than three rows, or without a plant that gives the distance."""
    assert len(found().errors) == 1
    dry = DistanceOrder((ON - 1) * MS, "NC", "ON_CONST_DIST", is_dry_run=True)
    assert found(orders=(dry,), changes=(replace(CONST, is_dry_run=True),)).errors == []
    for rows, count in ((2, 0), (3, 1)):
        short = np.where((K >= ON) & (ON + rows > K), ACTIVE_CONST_DIST, INACTIVE).astype(float)
        block = found(changes=(CONST, change(ON + rows, "INACTIVE")),
                      columns={"distance_state": short})  # fmt: skip
        assert len(block.errors) == count
    assert found(has_plant=False).errors == []


def test_another_set_value_begins_what_is_judged_anew() -> None:
    """0.3 mm off until row 950, where SET_DIST changes; then 0.1 mm, and at rest."""
    columns = {"set_dist_mm": np.where(K < 950, 2.0, 2.2)}
    (error,) = found(np.where(K < 950, 0.3, -0.1), columns=columns).errors
    assert error.measured_mm == pytest.approx(0.1)


def test_a_surface_that_gets_faster_bit_by_bit_is_even_in_its_last_rows_alone() -> None:
    """0.1 nm more in each cycle: only the last three rows differ by no more than 0.2 nm."""
    (error,) = found(0.001 * K, 0.5e-7 * (K - 100.0) ** 2 * (K > 100)).errors
    assert error.measured_mm == pytest.approx(0.001 * (ROWS - 1), abs=3e-3)
    assert error.speed_mm_s == pytest.approx(0.09, abs=1e-3)


# Limits

ALARM = re.compile(r"above it (\d+) \(older (\d+)\)")


def test_a_limit_is_named_by_its_parameter_with_what_it_does() -> None:
    """The parameter of this name of axis and channel, whose row names its alarms."""
    observed = recorded(changes=(CONST,))
    tool = ChannelDistanceRecord(changes=(CONST,))
    columns = observed.series.table()
    names = ("offset_mm", "distance_state", "sensor_mm", "set_dist_mm", "set_pos_mm", "step_mm",
             "delta_mm", "distance_held", "distance_override_pct")  # fmt: skip
    for name in names:
        columns = columns.append_column(f"channel.{name}", columns[f"Z.{name}"])
    columns = columns.append_column("Z.superposed_mm", columns["Z.offset_mm"])
    both = Observed(replace(observed.facts, distance_3d=tool), kept(columns))
    of_axis, of_channel = control_findings(both)
    assert (of_axis.axis, of_channel.axis) == ("Z", "channel")
    kinds: tuple[tuple[ControlFindings, Kind, str], ...] = (
        (of_axis, "axis", "kenngr.dist_ctrl[i]."),
        (of_channel, "channel", "dist_ctrl[i]."),
    )
    checked: dict[str, set[int]] = {"axis": set(), "channel": set()}
    for block, kind, stem in kinds:
        for limit in block.limits:
            row = table(kind).numbered(limit.parameter)
            assert row is not None
            assert row.path == stem + limit.key
            ids = ALARM.search(row.meaning)
            for alarm in () if ids is None else ids.groups()[: 1 + (kind == "axis")]:
                assert alarm in limit.acts
                checked[kind].add(int(alarm))
            assert ("clamps" in limit.acts) is (limit.key in ("v_max", "a_max", "max_deviation"))
        acts = {limit.key: limit.acts for limit in block.limits}
        older = {"max_pos": "70330 or ", "min_pos": "70576 or "} if kind == "axis" else {}
        for key, newer in (("max_pos", 310019), ("min_pos", 310020)):
            assert acts[key] == f"alarm {older.get(key, '')}{newer}"
    newer = {310017, 310018}  # max_deviation, max_act_value_change
    assert checked == {"axis": newer | {70329, 70331}, "channel": newer}


@pytest.mark.parametrize("used", [0.4, -0.4])
def test_of_limits_that_acted_one_after_the_other_the_one_used_most_is_shown(used: float) -> None:
    """max_deviation 2 mm until row 500, then 1 mm: 0.5 mm of 2 are less than 0.4 mm of 1."""
    words = {"max_deviation": 20_000}
    orders = (
        DistanceOrder((ON - 1) * MS, "NC", "ON_CONST_DIST"),
        DistanceOrder(499 * MS, "NC", words={"max_deviation": 10_000}),
    )
    for early, limit_mm, used_mm in ((0.5, 1.0, 0.4), (0.9, 2.0, 0.9), (-0.9, 2.0, 0.9)):
        offset = np.where(K < 200, 0.0, np.where(K < 500, early, used))
        block = found(words=words, orders=orders, columns={"offset_mm": offset})
        shown = next(one for one in block.limits if one.key == "max_deviation")
        assert (shown.value, shown.used) == (limit_mm, used_mm)


# What is beside it

ZERO = "The sensor value is 0 at a gap of"


@pytest.mark.parametrize(
    ("changed", "notes"),
    [
        ({}, []),
        ({"words": {"ref_offset": 5000}}, [f"{ZERO} -0.5 mm (ref_offset)."]),
        ({"words": {"ref_offset": -2500}}, [f"{ZERO} 0.25 mm (ref_offset)."]),
    ],
)
def test_the_zero_of_the_sensor_is_named_where_it_is_not_the_surface(
    changed: dict[str, Any], notes: Sequence[str]
) -> None:
    block = found(**changed)
    assert list(block.notes) == notes
    assert block.zero_mm == pytest.approx(float(notes[0].split()[-3]) if notes else 0.0)


def test_a_zero_that_the_program_has_set_is_the_gap_of_the_plant() -> None:
    """REF with the tool 2 mm above the workpiece: the sensor value was 0 there."""
    observed = recorded(changes=(CONST,), columns={"sensor_mm": np.zeros(ROWS)})
    record = replace(observed.facts.distance["Z"], is_referenced=True)
    facts = replace(observed.facts, distance={"Z": record})
    (block,) = control_findings(Observed(facts, observed.series))
    assert list(block.notes) == [f"{ZERO} 2 mm (REF)."]
    assert block.zero_mm == SET_DIST_MM


def test_a_sensor_that_counts_the_wrong_way_round_is_named() -> None:
    observed = recorded(changes=(CONST,))
    axis = observed.facts.axes["Z"]
    turned = replace(axis, written={**axis.written, INVERTS: 0})
    facts = replace(observed.facts, axes={"Z": turned})
    (block,) = control_findings(Observed(facts, observed.series))
    assert "the offset feeds back with the wrong sign" in block.notes[0]
    assert block.laws[0].growth > 1.0
    for sign, words in ((-1, []), (1, ["wrong way round"])):
        of_plc = replace(
            observed.facts, plc_sensors={"V.E.GAP": PlcSensor("gap", sign, 0)},
            distance={"Z": replace(observed.facts.distance["Z"], changes=(
                replace(CONST, sensor="VARIABLE V.E.GAP"),))},
        )  # fmt: skip
        (block,) = control_findings(Observed(of_plc, observed.series))
        assert [any(word in note for note in block.notes) for word in words] == [True] * len(words)
        assert len(block.notes) == len(words)


@pytest.mark.parametrize("late", [0, 1, 3])
def test_dead_cycles_are_those_of_the_rig_and_those_that_the_frames_show(late: int) -> None:
    """Nothing moves here: the frames show none."""
    block = found(late_cycles=late)
    assert block.dead.predicted == predicted(is_optimized=False, late_cycles=late).dead == 2 + late
    assert block.dead.measured is None
    assert block.dead.note
    assert (block.sensor, block.period_ms, block.unit) == ("gap", 1.0, "mm")
    assert found(has_plant=False).sensor == "gap"
