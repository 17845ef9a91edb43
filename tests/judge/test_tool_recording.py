"""The tool of a head with C and A, judged from a recording made of formulas (`reports/tilted.py`).

Until 250 ms A goes to -35 and C to 20 degrees while the tool centre point rests, 180 mm below the
axes; from 300 ms on it moves along Y with 50 mm/s. Axes are two cycles later where they were sent.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, Step, block_trace, kept
from tests.reports import tilted
from tests.reports.tilted import (
    AXES,
    KINEMATIC,
    ON,
    ROWS,
    TILTED,
    direction,
    left,
    trace,
)

from axisrig.bench.judge.distance.tilting import tilts
from axisrig.bench.judge.latch.metrics import INSTANT_NS
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.tool import kinematic_at
from axisrig.bench.judge.topics import observe
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import Contact, ProbeRecord
from axisrig.bench.record.distance import PlcSensor
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.kinematics import GuideChange, KinematicRecord
from axisrig.bench.record.measuring import MeasurementRun

REACH_MM = tilted.LEVER_MM + tilted.TOOL_MM
LATE = 2
TURN = TILTED - KINEMATIC
HALF = 0.5e-4
"""Half of an increment, mm and degrees."""


def changed(table: pa.Table, changes: Mapping[str, Mapping[int | range, float]]) -> pa.Table:
    """Add something in some rows of some columns."""
    for name, rows in changes.items():
        values = table[name].to_numpy().copy()
        for row, more in rows.items():
            values[[*row] if isinstance(row, range) else row] += more
        table = table.set_column(table.column_names.index(name), name, pa.array(values))
    return table


def recorded(
    changes: Mapping[str, Mapping[int | range, float]] | None = None,
    steps: tuple[Step, ...] = (),
    c_deg: float = tilted.C_DEG,
    **of_facts: Any,
) -> Observed:
    table = changed(trace(c_deg=c_deg), changes or {})
    own = {"timing": Timing(MS, 600_000, 0), "blocks": block_trace(steps), **of_facts}
    return Observed(replace(left(), **own), kept(table))


def seen(observed: Observed, metric: str) -> Observation:
    return observe(observed, parse_check(metric, "> -1e9", ""))


# While the tool tilts


def test_the_tool_centre_point_rests_while_the_tool_tilts() -> None:
    """Rounding: all signs of half an increment of X, Y, Z, and of C and A at their levers."""
    found = tilts(recorded())
    assert found.cycles == TURN + 1
    assert found.error_mm == pytest.approx(0.0, abs=1e-12)
    a, c = np.linspace(0.0, tilted.A_DEG, TURN + 1), np.linspace(0.0, tilted.C_DEG, TURN + 1)
    by_a, by_c = (
        REACH_MM * (direction(c + dc, a + da) - direction(c - dc, a - da)) / 2e-4
        for dc, da in ((0.0, 1e-4), (1e-4, 0.0))
    )
    ways = [
        HALF * (np.array(signs[:3]) + signs[3] * by_a + signs[4] * by_c)
        for signs in product((1.0, -1.0), repeat=5)
    ]
    rounding_mm = np.max(np.linalg.norm(ways, axis=-1))
    assert found.rounding_mm == pytest.approx(rounding_mm, rel=1e-6)
    turned = [math.radians(deg / TURN) for deg in (tilted.A_DEG, tilted.C_DEG)]
    levers_mm = [REACH_MM, REACH_MM * math.sin(math.radians(abs(tilted.A_DEG)))]
    parts = [math.sqrt(mm) * abs(turn) for mm, turn in zip(levers_mm, turned, strict=True)]
    assert found.chord_mm == pytest.approx(sum(parts) ** 2 / 8.0, rel=1e-6)
    assert found.error_mm < found.between_mm <= found.chord_mm


def test_between_two_syncs_the_point_is_on_a_chord() -> None:
    """About A alone: R (1 - cos(d/2)), which is R d^2/8."""
    found = tilts(recorded(c_deg=0.0))
    turn = math.radians(abs(tilted.A_DEG) / TURN)
    assert found.between_mm == pytest.approx(REACH_MM * (1 - math.cos(turn / 2)), rel=1e-6)
    assert found.chord_mm == pytest.approx(REACH_MM * turn**2 / 8.0, rel=1e-6)


@pytest.mark.parametrize(
    ("row", "is_inside"),
    [
        (KINEMATIC + LATE - 1, False),
        (KINEMATIC + LATE, True),
        (TILTED + LATE, True),
        (TILTED + LATE + 1, False),
    ],
)
def test_axes_are_judged_where_they_are_what_was_sent(row: int, is_inside: bool) -> None:
    found = tilts(recorded({"Y.truth_mm": {row: 0.03}}))
    assert found.error_mm == pytest.approx(0.03 if is_inside else 0.0, abs=1e-9)
    assert found.between_mm == pytest.approx(0.015 if is_inside else 0.0, abs=3.5e-4)


def test_of_several_times_the_worst_counts() -> None:
    """An offset for a while parts the tilting in two; while it is there nothing is judged."""
    offset = {"Z.superposed_mm": {range(150, 160): 0.5}}
    for first_mm, second_mm in ((0.03, -0.02), (-0.02, 0.03)):
        truth = {100: first_mm, 154: 0.5, 200: second_mm}
        found = tilts(recorded({**offset, "X.truth_mm": truth}))
        assert found.error_mm == pytest.approx(0.03, abs=1e-9)
        # Rows 52 .. 151, and 161 .. 252: with the row before the first turn of each
        assert found.cycles == 100 + 92
    whole = recorded({"Z.superposed_mm": {range(KINEMATIC, TILTED + 1): 0.5}})
    with pytest.raises(NoClosedFormError, match="never at rest while the tool tilted"):
        tilts(whole)


def test_a_tool_that_moves_while_it_tilts_is_not_at_rest() -> None:
    """By 1 um from begin to end; what comes back on the way is an error of the program."""
    for way_mm, is_there in ((0.0011, False), (0.0009, True)):
        observed = recorded({"X.set_mm": {range(TILTED, ROWS): way_mm}})
        assert bool(seen(observed, "tcp_error_um").value is not None) is is_there
    away = recorded({"X.truth_mm": {150: 0.5}, "X.set_mm": {148: 0.5}})
    assert seen(away, "tcp_error_um").value == pytest.approx(500.0)


def test_metrics_of_tilting_are_um() -> None:
    observed = recorded({"Y.truth_mm": {150: 0.03}})
    found = tilts(observed)
    for metric, mm in (
        ("tcp_error_um", found.error_mm),
        ("tcp_error_expected_um", found.rounding_mm),
        ("tcp_error_between_um", found.between_mm),
        ("tcp_error_between_expected_um", found.rounding_mm + found.chord_mm),
    ):
        assert seen(observed, metric).value == pytest.approx(1e3 * mm), metric


# While it moves


def moves(kind: str = "feed", begin_ms: float = ON + 1, end_ms: float = ON + 91) -> Step:
    """A block of rows 300 .. 390, which axes carry out in 302 .. 392."""
    return Step("N50 G1 Y4.5", kind, begin_ms, begin_ms, end_ms)


@pytest.mark.parametrize(
    ("row", "is_inside"), [(ON + 1, False), (ON + 2, True), (ON + 92, True), (ON + 93, False)]
)
def test_the_tool_is_on_the_line_of_its_block(row: int, is_inside: bool) -> None:
    observed = recorded({"X.truth_mm": {row: -0.02}}, (moves(),))
    for metric in ("tcp_from_line_um_max", "tcp_between_um_max"):
        assert seen(observed, metric).value == pytest.approx(20.0 * is_inside, abs=1e-6)


@pytest.mark.parametrize("buffer", [0, 1, 4])
def test_the_axes_are_on_a_line_later_by_what_their_drives_buffer(buffer: int) -> None:
    """Off the line by 20 um in its first and last row, which are so many cycles later."""
    table = trace(c_deg=tilted.C_DEG)
    for name in [name for name in table.column_names if name.endswith(".truth_mm")]:
        values = table[name].to_numpy()
        later = np.concatenate([np.full(buffer, values[0]), values[: len(values) - buffer]])
        table = table.set_column(table.column_names.index(name), name, pa.array(later))
    own = replace(left(), timing=Timing(MS, 600_000, buffer), blocks=block_trace((moves(),)))
    for row, is_inside in ((1, False), (2, True), (92, True), (93, False)):
        away = changed(table, {"X.truth_mm": {ON + buffer + row: -0.02}})
        found = seen(Observed(own, kept(away)), "tcp_from_line_um_max")
        assert found.value == pytest.approx(20.0 * is_inside, abs=1e-6)


def test_beyond_its_end_a_line_goes_no_further() -> None:
    """Along Y by 0.03 mm at the last row: away from the end, and not from the middle."""
    for row, away_um in ((ON + 92, 30.0), (ON + 50, 0.0)):
        observed = recorded({"Y.truth_mm": {row: 0.03}}, (moves(),))
        assert seen(observed, "tcp_from_line_um_max").value == pytest.approx(away_um, abs=1e-6)


def test_of_several_blocks_the_worst_counts_and_only_straight_ones() -> None:
    away = {"X.truth_mm": {ON + 20: 0.01, ON + 60: 0.02, ON + 85: 0.03}}
    parts = ((ON + 1, ON + 41), (ON + 41, ON + 76), (ON + 76, ON + 91))
    for kinds, worst_um in (
        (("feed", "rapid", "measurement run"), 30.0),
        (("feed", "rapid", "arc"), 20.0),
        (("feed", "arc", "arc"), 10.0),
    ):
        steps = tuple(moves(kind, *part) for kind, part in zip(kinds, parts, strict=True))
        observed = recorded(away, steps)
        assert seen(observed, "tcp_from_line_um_max").value == pytest.approx(worst_um, abs=1e-6)
    note = seen(recorded(away, (moves("arc"),)), "tcp_from_line_um_max").note
    assert note == "no straight block was carried out while a kinematic was on"
    early = recorded(away, (moves("feed", KINEMATIC - 20, KINEMATIC - 10),))
    assert seen(early, "tcp_between_um_max").value is None
    none = recorded(away, (moves(),), kinematics=())
    assert seen(none, "tcp_from_line_um_max").note == "no kinematic was on (#TRAFO ON)"


@pytest.mark.parametrize("aways_mm", [(0.03, 0.02, 0.01), (0.01, 0.03, 0.02), (0.01, 0.02, 0.03)])
def test_the_worst_of_several_blocks_counts_wherever_it_is(aways_mm: tuple[float, ...]) -> None:
    """To either side; at the SYNCs and between them."""
    parts = ((ON + 1, ON + 31), (ON + 31, ON + 61), (ON + 61, ON + 91))
    for side in (1.0, -1.0):
        rows = dict(zip((ON + 17, ON + 47, ON + 77), (side * mm for mm in aways_mm), strict=True))
        observed = recorded({"X.truth_mm": rows}, tuple(moves("feed", *part) for part in parts))
        for metric in ("tcp_from_line_um_max", "tcp_between_um_max"):
            assert seen(observed, metric).value == pytest.approx(30.0, abs=1e-6)


def test_a_tool_that_rests_is_away_from_its_point_between_the_syncs() -> None:
    tilting = moves("feed", KINEMATIC + 1, TILTED + 1)
    observed = recorded(None, (tilting,), c_deg=0.0)
    turn = math.radians(abs(tilted.A_DEG) / TURN)
    assert seen(observed, "tcp_from_line_um_max").value == pytest.approx(0.0, abs=1e-9)
    sagitta_um = REACH_MM * (1 - math.cos(turn / 2)) * 1e3
    assert seen(observed, "tcp_between_um_max").value == pytest.approx(sagitta_um, rel=1e-6)


def test_the_speed_of_the_tool_is_from_sync_to_sync() -> None:
    observed = recorded({"Y.truth_mm": {ON + 50: 0.01}}, (moves(),))
    assert seen(observed, "tcp_velocity_mm_s_max").value == pytest.approx(60.0)
    for row in (ON, ON + 94):
        beside = recorded({"Y.truth_mm": {row: 0.01}}, (moves(),))
        assert seen(beside, "tcp_velocity_mm_s_max").value == pytest.approx(50.0)
    measured = seen(recorded(None, (moves("measurement run"),)), "tcp_velocity_mm_s_max")
    assert measured.value == pytest.approx(50.0)  # it has a feed too
    rapid = seen(recorded(None, (moves("rapid"),)), "tcp_velocity_mm_s_max")
    assert (rapid.value, "with a feed" in rapid.note) == (None, True)


def test_the_place_at_the_end_is_that_of_the_tool_and_not_of_the_axes() -> None:
    observed = recorded({"X.truth_mm": {-1: 0.25, -2: 9.0}, "Z.truth_mm": {-1: -0.5}})
    places = [seen(observed, f"tcp_mm:{axis}").value for axis in AXES[:3]]
    assert places == pytest.approx([0.25, (tilted.OFF - ON) * 0.05, -0.5])


# What was measured


def measured(
    latched: Mapping[str, float],
    contact_ms: float | None = ON + 50.5,
    **changes: Any,
) -> Observed:
    """A run from 301 ms to 391 ms; the contact is with the axes where the truth has them."""
    places = {"X": 5.0, "Y": 6.0, "Z": 7.0, "C": 20.0, "A": -35.0}
    axes = {
        name: replace(axis, plant=name.lower(), signals={"probe_1": "probe"})
        for name, axis in left().axes.items()
    }
    found = {name: places[name] + more for name, more in latched.items()}
    run = MeasurementRun(
        AXES[:3], inputs=dict.fromkeys(AXES[:3], 1), begin_ns=(ON + 1) * MS,
        end_ns=(ON + 91) * MS, latched_mm=found,
    )  # fmt: skip
    contact = {axis.lower(): value for axis, value in places.items()}
    contacts = () if contact_ms is None else (Contact(round(contact_ms * MS), contact),)
    probes = {"probe": ProbeRecord(True, 20.0, contacts)}
    return recorded(axes=axes, runs=(run,), probes=probes, **changes)


def test_a_measured_place_of_the_tool_is_compared_with_that_of_the_contact() -> None:
    """3, 4 and 12 um away; or C turned by 0.01 degrees at the lever R sin 35."""
    exact = dict.fromkeys(AXES, 0.0)
    observed = measured({**exact, "X": 0.003, "Y": -0.004, "Z": 0.012})
    found = seen(observed, "tcp_latch_error_um")
    assert found.value == pytest.approx(13.0)
    # 50 mm/s for the nanoseconds by which contact and latch are known
    assert found.uncertainty == pytest.approx(50e3 * (INSTANT_NS + 20.0) * 1e-9)
    assert "21 ns" in found.note
    lever_um = REACH_MM * math.sin(math.radians(35.0)) * 1e3
    turned = seen(measured({**exact, "C": 0.01}), "tcp_latch_error_um")
    assert turned.value == pytest.approx(lever_um * math.radians(0.01), rel=1e-6)


@pytest.mark.parametrize(("axis", "place_mm"), [("X", 5.0), ("Y", 6.0), ("Z", 7.0)])
def test_a_measured_place_may_be_zero(axis: str, place_mm: float) -> None:
    found = seen(measured({**dict.fromkeys(AXES, 0.0), axis: -place_mm}), "tcp_latch_error_um")
    assert found.value == pytest.approx(place_mm * 1e3)


def test_without_a_place_or_a_contact_there_is_no_error_of_it() -> None:
    exact = dict.fromkeys(AXES, 0.0)
    some = {name: 0.0 for name in AXES if name not in "YA"}
    nothing, met = "no measurement run was made while a kinematic was on", "the probe met nothing"
    before = (replace(left().kinematics[0], end_ns=ON * MS),)
    for observed, words in (
        (measured(some), "no measured value of axis Y A"),
        (measured(exact, None), met),
        (measured(exact, ON + 92.0), met),
        (measured(exact, kinematics=before), nothing),
        (recorded(), nothing),
    ):
        found = seen(observed, "tcp_latch_error_um")
        assert found.value is None
        assert found.note.startswith(words)


def test_a_measured_place_has_the_tool_that_was_on_as_its_run_began() -> None:
    """C off by 0.01 degrees at the lever of the tool: of 80 mm until 320 ms, of 20 mm after it."""
    latched = dict.fromkeys(AXES, 0.0) | {"C": 0.01}
    at_begin = KinematicRecord(KINEMATIC * MS, (ON + 20) * MS, AXES, (9, 98), tilted.TOOL_MM)
    later = KinematicRecord((ON + 20) * MS, None, AXES, (9, 98), 20.0)
    lever_um = REACH_MM * math.sin(math.radians(35.0)) * 1e3
    for on in ((at_begin, later), (at_begin,)):
        found = seen(measured(latched, kinematics=on), "tcp_latch_error_um")
        assert found.value == pytest.approx(lever_um * math.radians(0.01), rel=1e-6)
    assert seen(measured(latched, kinematics=(later,)), "tcp_latch_error_um").value is None


@pytest.mark.parametrize(
    ("row", "speed_mm_s"), [(ON + 48, 50.0), (ON + 49, 30.0), (ON + 50, 70.0), (ON + 51, 50.0)]
)
def test_a_contact_is_as_uncertain_as_the_tool_is_fast_in_the_step_before_it(
    row: int, speed_mm_s: float
) -> None:
    """Contact between rows 350 and 351; a row that is 0.02 mm farther along Y."""
    exact = dict.fromkeys(AXES, 0.0)
    facts_of = measured(exact).facts
    observed = Observed(facts_of, kept(changed(trace(), {"Y.truth_mm": {row: 0.02}})))
    found = seen(observed, "tcp_latch_error_um")
    assert found.uncertainty == pytest.approx(speed_mm_s * 1e3 * (INSTANT_NS + 20.0) * 1e-9)


# What the report shows


def test_a_kinematic_is_on_from_its_begin_and_off_at_its_end() -> None:
    first = KinematicRecord(10 * MS, 20 * MS, AXES, (9,), 80.0)
    second = KinematicRecord(20 * MS, None, AXES, (9, 98), 80.0)
    observed = recorded(kinematics=(first, second))
    for time_ns, on in (
        (10 * MS - 1, None), (10 * MS, first), (20 * MS - 1, first), (20 * MS, second),
        (10**12, second),
    ):  # fmt: skip
        assert kinematic_at(observed, time_ns) is on
    tool = tilted.tool(trace(), replace(left(), kinematics=(first, second)))
    # One that stays on ends after the last row
    assert [(one.record.begin_ns, one.end_ns) for one in tool.kinematics] == [
        (10 * MS, 20 * MS), (20 * MS, (ROWS - 1) * MS + 1),
    ]  # fmt: skip
    assert list(tool.axes) == list(AXES)
    assert list(tool.rotary) == [False, False, False, True, True]


def test_a_guide_is_used_where_the_control_was_on_meanwhile() -> None:
    """On from row 300 to 690: a guide that ends or begins there is not."""
    rows = (0, KINEMATIC, ON, ON + 100, tilted.OFF)
    of = left()
    assert of.distance_3d is not None
    guides = tuple(GuideChange(row * MS, "MCS") for row in rows)
    tool = tilted.tool(trace(), replace(of, distance_3d=replace(of.distance_3d, guides=guides)))
    assert [guide.is_used for guide in tool.guides] == [False, False, True, True, False]
    assert [guide.change.time_ns for guide in tool.guides] == [row * MS for row in rows]
    # One that begins before the control and lasts into it, and one that it is switched off in
    guides = tuple(GuideChange(row * MS, "MCS") for row in (0, ON + 1, tilted.OFF - 1))
    tool = tilted.tool(trace(), replace(of, distance_3d=replace(of.distance_3d, guides=guides)))
    assert [guide.is_used for guide in tool.guides] == [True, True, True]
    without = tilted.tool(trace(), replace(of, distance_3d=None))
    assert ([*without.guides], [*without.diagnosis]) == ([], [])


@pytest.mark.parametrize(
    ("sensors", "variable", "chosen"),
    [
        ({"V.E.SENSOR": "gap"}, "V.E.SENSOR", "gap"),
        ({"V.E.SENSOR": "other"}, "V.E.SENSOR", "other"),
        ({"V.E.SENSOR": "other"}, "V.E.ELSE", "gap"),  # any that sees the tool: the first
        ({"V.E.SENSOR": "none"}, "V.E.SENSOR", "gap"),  # it does not see the tool
        ({"": "other"}, None, "other"),
        ({}, None, "gap"),
    ],
)
def test_the_plant_that_sees_the_tool_is_that_of_the_control(
    sensors: dict[str, str], variable: str | None, chosen: str
) -> None:
    table = trace()
    for k in "xyz":
        table = table.append_column(f"other.tcp_{k}_mm", table[f"gap.tcp_{k}_mm"])
    of = left()
    assert of.distance_3d is not None
    control = None if variable is None else replace(of.distance_3d, variable=variable)
    plc = {name: PlcSensor(plant, 1, 0) for name, plant in sensors.items()}
    assert tilted.tool(table, replace(of, distance_3d=control, plc_sensors=plc)).sensor == chosen
    bare = trace(has_sensor=False)
    assert tilted.tool(bare, replace(of, distance_3d=control, plc_sensors=plc)).sensor is None


@pytest.mark.parametrize(
    ("angles", "limits"),
    [
        ((50, 70, 85), {"HD2": 50.0, "HD3": 70.0, "HD4": 85.0}),
        ((0, 0, 85), {"HD2": 0.0, "HD4": 85.0}),  # longer from the begin on, up to HD4
        ((89, 0, 0), {"HD2": 89.0}),
        ((90, 95, 85), {"HD4": 85.0}),  # never extended
    ],
)
def test_the_angles_of_an_extended_tool_are_those_that_act(
    angles: tuple[int, int, int], limits: dict[str, float]
) -> None:
    written = {
        f"kin_step[1].trafo[0].param[{k}]": 10_000 * deg for k, deg in enumerate(angles, start=1)
    }
    of = replace(left(), channel={**tilted.WRITTEN, **written})
    (one,) = tilted.tool(trace(), of).kinematics
    assert dict(one.limits) == pytest.approx(limits)
    (head,) = (replace(on, ids=on.ids[:1]) for on in of.kinematics)
    (bare,) = tilted.tool(trace(), replace(of, kinematics=(head,))).kinematics
    assert dict(bare.limits) == {}


@pytest.mark.parametrize(("x_mm", "speed_mm_s"), [(0.0, 70.0), (0.024, 74.0), (-0.24, 250.0)])
def test_a_contact_is_as_uncertain_as_the_tool_is_fast_in_all_its_coordinates(
    x_mm: float, speed_mm_s: float
) -> None:
    """0.07 mm along Y in the step before it, and something along X: sqrt(x^2 + y^2) in 1 ms."""
    row = ON + 50
    of = measured(dict.fromkeys(AXES, 0.0)).facts
    table = changed(trace(), {"Y.truth_mm": {row: 0.02}, "X.truth_mm": {row: x_mm}})
    found = seen(Observed(of, kept(table)), "tcp_latch_error_um")
    assert found.uncertainty == pytest.approx(speed_mm_s * 1e3 * (INSTANT_NS + 20.0) * 1e-9)
