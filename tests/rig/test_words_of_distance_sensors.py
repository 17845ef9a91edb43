"""What the check says of sensors of distance control: their sign, their way, their promise."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS
from axisrig.bench.rig.distance import sensors
from axisrig.bench.rig.distance.channel import channel_warnings, describe_channel, largest_tilt_deg
from axisrig.bench.rig.distance.check import describe_distance, distance_warnings
from axisrig.bench.rig.distance.loops import clamp_words, kp_lines, listed_for, unstable
from axisrig.bench.rig.distance.sensors import sensors_of
from axisrig.bench.rig.settings import Settings

Read = Callable[..., Settings]
OFF = "set:Z.lr_param.distance_control_on=0"
SCALE = """[axis.Z]
encoder_2 = "scale"
[plant.scale]
fmu = "AxisRig.Sensors.SecondEncoder"
wire = { z = "z" }"""
VARIABLE = '[plc]\n"V.E.SENSOR" = { %s }'


# --- of an axis --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("base", "changes", "words", "by"),
    [
        ("distance-z.toml", ("set:Z.lr_hw[1].vz_istw=0",), "gap on 60E4:1", "P-AXIS-00230"),
        ("distance-z-variable-gap.toml", (), "gap in V.E.SENSOR", "the sign of [plc]"),
    ],
)
def test_a_wrong_sign_is_that_of_the_list_or_of_the_variable(
    rig_above: Read, base: str, changes: tuple[str, ...], words: str, by: str
) -> None:
    """P-AXIS-00230 turns the second encoder round and no variable."""
    (warning,) = distance_warnings(rig_above(base, "", *changes))
    assert warning.startswith(f"axis Z: {words}")
    assert f"counts with the motor: with {by} as it is the offset feeds back" in warning


@pytest.mark.parametrize(
    ("table", "is_named"),
    [("", True), ('[axis.Z]\nencoder_2 = "load"', False), (SCALE, True)],
)
def test_a_second_encoder_is_named_where_nothing_takes_its_distance(
    rig_above: Read, table: str, is_named: bool
) -> None:
    """The load itself is no part of the rig that could be a sensor."""
    found = describe_distance(rig_above("distance-z.toml", table, OFF), {})
    name = "scale" if "scale" in table else "gap"
    words = f"axis Z: {name} is its second encoder, and distance control is not released"
    assert [text.startswith(words) for text in found] == [True] * is_named


@pytest.mark.parametrize(
    ("table", "name"), [('[axis.Z]\nencoder_2 = "load"', "load"), (SCALE, "scale")]
)
def test_a_scale_gives_no_distance(rig_above: Read, table: str, name: str) -> None:
    settings = rig_above("distance-z.toml", table)
    assert sensors_of(settings, "Z") == []
    (warning,) = distance_warnings(settings)
    assert warning.endswith(f"encoder_2 = {name} is a scale: it gives the position of the axis")


def test_a_scale_with_a_variable_beside_it_is_no_trouble(rig_above: Read) -> None:
    variable = VARIABLE % 'sensor = "gap", sign = -1, period_ms = 1'
    settings = rig_above("distance-z.toml", f"{SCALE}\n{variable}")
    assert [sensor.words for sensor in sensors_of(settings, "Z")] == ["gap in V.E.SENSOR"]
    assert distance_warnings(settings) == []


def test_the_second_encoder_comes_first_and_the_variables_after_it(rig_above: Read) -> None:
    entry = '{ sensor = "gap", sign = -1 }'
    table = f'[plc]\n"V.E.B" = {entry}\n"V.E.A" = {entry}'
    found = sensors_of(rig_above("distance-z.toml", table), "Z")
    assert [sensor.words.partition(",")[0] for sensor in found] == [
        "gap on 60E4:1", "gap in V.E.B", "gap in V.E.A",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("period_ms", "every"),
    [(0.5, 1), (1.0, 1), (1.9, 1), (2.0, 2), (3.0, 3), (3.99, 3), (20.0, 20)],
)
def test_a_variable_comes_as_often_as_whole_cycles_allow(
    rig_above: Read, period_ms: float, every: int
) -> None:
    """Not less often than promised; in every cycle there is no warning."""
    table = VARIABLE % f"period_ms = {period_ms}"
    _, sensor = sensors_of(rig_above("distance-z-variable.toml", table), "Z")
    assert (sensor.every, sensor.promised_ns) == (every, round(period_ms * 1e6))
    ending = "" if every == 1 else f" every {every} cycles"
    assert sensor.words == f"gap in V.E.SENSOR{ending}"


@pytest.mark.parametrize("delay", [0, 1, 5])
@pytest.mark.parametrize(
    ("base", "fresher"), [("distance-z-variable.toml", 0), ("distance-z-ethercat.toml", None)]
)
def test_a_variable_is_as_old_as_the_plc_is_late_less_what_6064_is(
    rig_above: Read, base: str, fresher: int | None, delay: int
) -> None:
    """On CAN 6064 is of the SYNC that the PLC reads at; elsewhere the drive shows it later."""
    entry = f'sensor = "gap", sign = -1, delay_cycles = {delay}'
    settings = rig_above(base, VARIABLE % entry)
    none_late = rig_above(base, VARIABLE % 'sensor = "gap", sign = -1')
    sensor, now = sensors_of(settings, "Z")[-1], sensors_of(none_late, "Z")[-1]
    assert sensor.age - now.age == delay
    assert now.age <= 0
    if fresher is not None:
        assert now.age == -fresher


# --- signs -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("map_", "of_axis", "of_channel"),
    [
        ("", -1, 1),
        ('distance = { variable = "distance", sign = -1 }', 1, -1),
        # Of all axes of a kinematic the way up is no matter of the sign of one of them
        ('z_position = { variable = "z", sign = -1 }', 1, 1),
        ('x_position = { variable = "x", sign = -1 }', -1, 1),
    ],
)
def test_a_sign_in_a_map_turns_the_sensor_round(
    rig_above: Read, map_: str, of_axis: int, of_channel: int
) -> None:
    """A sensor over Z: with a gap as it is an axis wants the other sign, 3D control this one."""
    settings = rig_above("distance-5axis.toml", f"[plant.gap.map]\n{map_}")
    (own,), (common,) = sensors_of(settings, "Z"), sensors_of(settings, CHANNEL)
    assert (own.sign, common.sign) == (of_axis, of_channel)
    (turned,) = sensors_of(
        rig_above("distance-5axis.toml", f"[plant.gap.map]\n{map_}\n{VARIABLE % 'sign = -1'}"),
        CHANNEL,
    )
    assert turned.sign == -of_channel


# --- of the channel ----------------------------------------------------------------------------


@pytest.mark.parametrize(("axes", "warned"), [((), True), (("Z",), False), (("X", "Z"), False)])
def test_where_any_axis_has_a_control_the_variable_may_be_for_it(
    rig_above: Read, axes: tuple[str, ...], warned: bool
) -> None:
    """With the sign of an axis, which 3D control would run away with."""
    released = [f"set:{axis}.lr_param.distance_control_on=1" for axis in axes]
    settings = rig_above("distance-5axis-sign.toml", "", *released)
    found = [text for text in channel_warnings(settings) if "falls when the tool lifts" in text]
    assert len(found) == warned


@pytest.mark.parametrize(("steps", "chosen"), [((9, 98), "9, 98"), ((9, 0), "9"), ((0, 0), None)])
def test_the_mode_without_a_word_is_by_the_kinematic_that_the_list_chooses(
    rig_above: Read, steps: tuple[int, int], chosen: str | None
) -> None:
    changes = [
        f"set:channel.default_id_of_kin_step[{step}]={number}" for step, number in enumerate(steps)
    ]
    (text,) = describe_channel(rig_above("distance-5axis.toml", "", *changes))
    if chosen is None:
        assert "no kinematic is listed (P-CHAN-00264), MCS and ECS need one" in text
    else:
        assert f"MCS while a kinematic is on (#TRAFO ON: {chosen} by P-CHAN-00264)" in text


@pytest.mark.parametrize(
    ("hd4_deg", "second", "largest"),
    [(85.0, 98, 85.0), (60.0, 98, 60.0), (90.0, 98, 85.0), (0.0, 98, 85.0), (60.0, 0, 85.0)],
)
def test_the_steepest_tilt_is_that_of_the_list_and_never_above_that_of_ecs(
    rig_above: Read, hd4_deg: float, second: int, largest: float
) -> None:
    """HD4 of kinematic 98 in 0.0001 degrees; ECS ends at 85 degrees."""
    settings = rig_above(
        "distance-5axis.toml",
        "",
        f"set:channel.kin_step[1].trafo[0].param[3]={round(hd4_deg * 1e4)}",
        f"set:channel.default_id_of_kin_step[1]={second}",
    )
    assert largest_tilt_deg(settings) == largest


# --- loops -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("base", "name", "whose", "parameter"),
    [
        ("distance-z.toml", "Z", "axis Z", "P-AXIS-00759"),
        ("distance-5axis.toml", CHANNEL, "3D control of the channel", "P-CHAN-00821"),
    ],
)
def test_an_unstable_control_is_named_with_the_parameter_of_its_gain(
    rig_above: Read, base: str, name: str, whose: str, parameter: str
) -> None:
    settings = rig_above(base)
    (sensor,) = sensors_of(settings, name)
    control = replace(listed_for(settings, name).control, kp=0.75)
    found = unstable(settings, name, sensor, CONST_DIST, control)
    assert found is not None
    assert found.startswith(f"{whose}: CONST_DIST by {sensor.words} is unstable with kp 0.75 ")
    assert f"({parameter})" in found


@pytest.mark.parametrize(("every", "is_stable"), [(1, True), (2, True), (20, False)])
def test_a_value_that_comes_seldom_makes_a_stable_gain_unstable(
    rig_above: Read, every: int, is_stable: bool
) -> None:
    """Held for 20 cycles a deviation is added 20 times: stable below 2/20 at most."""
    settings = rig_above("distance-z.toml")
    (sensor,) = sensors_of(settings, "Z")
    control = replace(listed_for(settings, "Z").control, kp=0.3, count=1)
    found = unstable(settings, "Z", replace(sensor, every=every), CONST_DIST, control)
    assert (found is None) is is_stable


@pytest.mark.parametrize(
    ("age", "has_loops", "known"),
    [(0, False, (True, True)), (0, True, (True, False)), (1, True, (False, False)),
     (-1, True, (False, False)), (1, False, (True, True))],
)  # fmt: skip
def test_a_drive_with_a_loop_leaves_open_what_an_older_value_sees(
    rig_above: Read, age: int, has_loops: bool, known: tuple[bool, bool]
) -> None:
    """SET_POS compares sensor and actual position of one instant, unless one is older."""
    settings = rig_above("distance-z.toml")
    (sensor,) = sensors_of(settings, "Z")
    lines = kp_lines(settings, "Z", replace(sensor, age=age), 0.0, has_loops=has_loops)
    for mode, is_known in zip((SET_POS, CONST_DIST), known, strict=True):
        (line,) = [text for text in lines if f" {mode}: " in text]
        assert line.endswith("stable as listed" if is_known else "not known as listed")
        assert ("at best below kp" in line) is not is_known


@pytest.mark.parametrize(("kp", "a_max"), [(0.0, 100.0), (0.3, 0.0), (0.0, 0.0)])
def test_clamps_of_a_control_that_does_not_move_make_nothing_ring(
    rig_above: Read, kp: float, a_max: float
) -> None:
    """A program may set kp to 0."""
    listed = listed_for(rig_above("distance-5axis.toml"), CHANNEL)
    limits = replace(listed.limits, a_mm_s2=a_max)
    still = replace(listed, control=replace(listed.control, kp=kp), limits=limits)
    assert clamp_words(still, 1000) == "a control without kp or a_max does not move by them"


@pytest.mark.parametrize(("v_max_um_s", "rings"), [(2500, False), (2501, True), (2499, False)])
def test_a_speed_at_what_the_acceleration_brakes_in_time_does_not_ring(
    rig_above: Read, v_max_um_s: int, rings: bool
) -> None:
    """a_max T/kp = 500 mm/s2 x 1 ms/0.2 = 2.5 mm/s."""
    changes = (
        f"set:channel.dist_ctrl[0].v_max={v_max_um_s}", "set:channel.dist_ctrl[0].a_max=500",
        "set:channel.dist_ctrl[0].kp=0.2",
    )  # fmt: skip
    settings = rig_above("distance-5axis.toml", "", *changes)
    found = clamp_words(listed_for(settings, CHANNEL), 1000)
    assert "a_max T/kp = 2.5 mm/s" in found
    assert ("they may make it ring" in found) is rings
    assert ("the law brakes in time" in found) is not rings


@pytest.mark.parametrize(
    ("late", "fresh", "age"), [(0, 0, 2), (1, 0, 1), (1, 1, 2), (3, 1, 0), (4, 0, -2)]
)
def test_a_variable_is_as_old_as_the_plc_makes_it_against_what_6064_is_late(
    rig_above: Read, monkeypatch: pytest.MonkeyPatch, late: int, fresh: int, age: int
) -> None:
    """It comes 2 cycles late from the PLC, which reads at the last SYNC what is `fresh` old."""
    monkeypatch.setattr(sensors, "late_of", lambda *_: (late, fresh))
    *_, found = sensors_of(rig_above("distance-z-variable-late.toml"), "Z")
    assert found.words == "gap in V.E.SENSOR"
    assert (found.age, found.late) == (age, late)
