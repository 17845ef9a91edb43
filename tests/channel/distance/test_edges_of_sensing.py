"""A control with its sensor by hand: what is refused when, how old a value is, who waits."""

from typing import Any

import pytest
from tests.channel.distance.conftest import command
from tests.channel.distance.test_offsets_by_hand import Controls, channel_control, stepped
from tests.channel.distance.test_sensing_by_hand import Bench, alarm_of
from tests.channel.program_by_hand import Program

from axisrig.kernel.channel import distance_controls
from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.distance import DistanceCommand, DistanceSettings, DistanceState, Source
from axisrig.kernel.errors import Alarm
from axisrig.kernel.plc.unit import AxisUnit, UnitState

ON, OFF, FREEZE = DistanceCommand.ON, DistanceCommand.OFF, DistanceCommand.FREEZE
SOURCE_CHANGED, SILENT = 310028, 900314


def far(**changes: Any) -> Bench:
    """On, 1 mm away from its surface; it has come nearer for three cycles."""
    bench = Bench(v_max_mm_s=10.0, **changes)
    bench.on()
    for _ in range(3):
        bench.cycle(10_000)
    assert bench.axis.control.offset_mm != 0.0
    return bench


@pytest.mark.parametrize("state", ["ACTIVE", "FREEZE", "TURNING_OFF", "ERROR", "INACTIVE"])
def test_another_sensor_is_refused_until_the_control_is_off(state: str) -> None:
    """In every state but INACTIVE, also with an offset that a reset has left."""
    bench = far()
    control = bench.axis.control
    if state in ("FREEZE", "TURNING_OFF"):
        control.command(FREEZE if state == "FREEZE" else OFF, Source.NC)
    elif state == "ERROR":
        alarm_of(control.fail, Alarm(SILENT, owner="axis Z", source="", age_ms="", limit_ms=""))
    elif state == "INACTIVE":
        control.switch_off_kept()
    assert control.state.name == state
    if state == "INACTIVE":
        bench.axis.choose("VARIABLE", "HEIGHT")
        return
    refused = alarm_of(bench.axis.choose, "VARIABLE", "HEIGHT")
    assert refused.id == SOURCE_CHANGED
    assert (refused.values["current"], refused.values["programmed"]) == (
        "SECOND_ENCODER", "VARIABLE V.E.HEIGHT",
    )  # fmt: skip
    bench.axis.choose("SECOND_ENCODER", None)


def test_ref_begins_to_be_refused_where_no_value_has_come_yet() -> None:
    """Nothing is waited for that may never come; with one value the filter is waited for."""
    bench = Bench(filter_type="MOVING_AVERAGE", n_cycles=4)
    assert bench.axis.may_reference()
    bench.cycle(7)
    assert not bench.axis.may_reference()
    for _ in range(3):
        bench.cycle(7)
    assert bench.axis.may_reference()


@pytest.mark.parametrize(("period_us", "age", "age_ms"), [(2000, 7, 14.0), (250, 13, 3.25)])
def test_the_age_of_a_value_is_in_ms_whatever_the_cycle(
    period_us: int, age: int, age_ms: float
) -> None:
    bench = Bench()
    period_ns = period_us * 1000
    bench.promised_ns = period_ns
    bench.link.second_increments, bench.link.second_age_cycles = 7, age
    settings = AxisDistanceSettings(control=DistanceSettings())
    silence = AxisDistance(bench.link, settings, {}, {}, period_ns).silence()
    assert silence is not None
    assert (silence.age_ms, silence.limit_ms) == (age_ms, 3 * period_us / 1000)


@pytest.mark.parametrize(("age", "is_silent"), [(3, False), (4, True)])
def test_a_sensor_that_falls_silent_ends_the_control_of_an_axis(age: int, is_silent: bool) -> None:
    bench = far()
    bench.link.second_age_cycles = age
    if not is_silent:
        bench.cycle(10_000)
        return
    assert alarm_of(bench.cycle, 10_000).id == SILENT
    assert bench.axis.control.state is DistanceState.ERROR


@pytest.mark.parametrize("override", [1.0, 0.5, 0.1])
@pytest.mark.parametrize("is_off", [False, True])
def test_the_override_of_an_axis_scales_the_speed_of_its_offset(
    override: float, is_off: bool
) -> None:
    """v_max 10 mm/s: 10 um in a cycle of 1 ms, also on the way back."""
    bench = far()
    if is_off:
        bench.axis.control.command(OFF, Source.NC)
    bench.axis.override = override
    before_mm = bench.axis.control.offset_mm
    bench.cycle(10_000)
    step_mm = abs(bench.axis.control.offset_mm - before_mm)
    assert step_mm == pytest.approx(0.01 * override)


def test_the_plc_is_shown_a_distance_of_0_too() -> None:
    bench, state = Bench(), UnitState()
    bench.axis.show(state)
    shown = state.surface_mm, state.distance_mm
    bench.link.actual_mm = 3.5
    bench.cycle(20_000)
    bench.axis.show(state)
    assert (state.surface_mm, state.distance_mm) == (5.5, -2.0)
    assert shown != (5.5, -2.0)
    bench.cycle(0)
    bench.axis.show(state)
    assert (state.surface_mm, state.distance_mm) == (3.5, 0.0)


# The controls of a channel


@pytest.mark.parametrize("axis", ["X", "Z"])
def test_the_plc_is_refused_where_no_axis_has_a_control(axis: str) -> None:
    made = Controls(None)
    made.controls.step()
    unit = made.plc.axis[axis].distance
    unit.enable_w = unit.command_semaphor_rw = True
    refused = alarm_of(made.controls.step)
    assert (refused.id, refused.values["owner"]) == (310015, f"axis {axis}")
    assert not unit.command_semaphor_rw
    made.controls.step()


@pytest.mark.parametrize(
    ("own_moves", "channel_moves", "floating"),
    [
        (False, False, set()),
        (True, False, {"Z"}),
        (False, True, {"X", "Y"}),
        (True, True, {"X", "Y", "Z"}),
    ],
)
def test_every_axis_that_an_offset_moves_floats_and_none_any_more(
    own_moves: bool, channel_moves: bool, floating: set[str]
) -> None:
    own = stepped(is_moving=own_moves)
    channel = channel_control(
        is_moving=channel_moves, moved=("X", "Y"), look=lambda: None, take=lambda: None,
        step=lambda: None,
    )  # fmt: skip
    made = Controls(own, channel)
    made.controls.step()
    assert made.floating == floating
    own.is_moving = channel.is_moving = False
    made.controls.step()
    assert made.floating == set()


@pytest.mark.parametrize("held", [(), ("Y",), ("Z",), ("Y", "Z"), ("X",)])
def test_3d_control_is_held_by_any_axis_that_it_moves(held: tuple[str, ...]) -> None:
    channel = channel_control(
        moved=("Y", "Z"), look=lambda: None, take=lambda: None, step=lambda: None
    )
    made = Controls(None, channel)
    for axis in held:
        made.plc.axis[axis] = hold(made.plc.axis[axis])
    made.controls.step()
    assert channel.is_held is bool({"Y", "Z"} & set(held))


def hold(unit: AxisUnit) -> AxisUnit:
    """Hold an axis by an override of 0."""
    unit.override_permille = 0
    assert unit.holds
    return unit


@pytest.mark.parametrize(
    ("state", "on_its_way", "waits"),
    [
        (DistanceState.TURNING_OFF, False, True),
        (DistanceState.INACTIVE, True, True),  # the last of its offset has still to leave
        (DistanceState.INACTIVE, False, False),
        (DistanceState.ERROR, False, False),
    ],
)
def test_wait_off_of_3d_control_waits_until_the_last_of_its_offset_has_left(
    state: DistanceState, on_its_way: bool, waits: bool
) -> None:
    channel = channel_control(is_on_its_way=on_its_way, is_idle=False)
    channel.control.state = state
    made = Controls(None, channel)
    made.controls._awaited[None] = OFF
    assert made.controls._is_waiting() is waits
    assert made.controls._is_waiting() is waits


def test_an_axis_that_is_waited_for_is_not_shown_as_the_wait_of_3d_control(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown: list[bool] = []
    monkeypatch.setattr(
        distance_controls, "diagnosis", lambda _found, *, is_awaited: shown.append(is_awaited) or ()
    )
    made = Controls(stepped(), channel_control())
    for awaited in ({}, {"Z": OFF}, {None: OFF}, {"Z": ON, None: OFF}):
        made.controls._awaited = dict(awaited)
        made.controls.diagnosis()
    assert shown == [False, False, True, True]
    assert Controls(stepped()).controls.diagnosis() == ()


def test_each_axis_is_shown_in_its_own_unit() -> None:
    own, shown = stepped(), []
    own.show = shown.append
    made = Controls(own)
    made.controls.step()
    assert shown == [made.plc.axis["Z"].distance.state_r]
    assert shown[0] is made.plc.axis["Z"].distance.state_r
    assert shown[0] is not made.plc.axis["X"].distance.state_r


@pytest.mark.parametrize("act", ["on", "off", "freeze", "ref", "check"])
def test_3d_control_that_is_not_released_is_refused_with_the_newer_id(act: str) -> None:
    """No older structure has it (P-CHAN-00500)."""
    made = Controls(stepped())
    refused = alarm_of(Program(made.controls).say, command(act, axis=None))  # type: ignore[arg-type]
    assert (refused.id, refused.values["owner"]) == (310015, "the channel")


@pytest.mark.parametrize("end", ["leave", "program", "error"])
def test_what_a_control_that_is_off_leaves_on_its_axes_is_named_with_all_of_them(end: str) -> None:
    """900560, with the offset as it was, and each axis with its slaves takes its own part."""
    channel = channel_control(has_offset=True, is_idle=False, may_move=lambda _axes: False)
    channel.control.offset_mm = 20.5

    def hand_over() -> dict[str, float]:
        channel.control.offset_mm = 0.0
        channel.has_offset = False
        return {"Y": 10.0, "Z": 20.0}

    channel.hand_over, channel.end_program = hand_over, lambda: None
    made = Controls(None, channel, slaves={"X": "Z"})
    warned: list[Alarm] = []
    made.controls._warn = warned.append
    if end == "leave":
        made.controls.leave()
    elif end == "program":
        made.controls.end_program("N10")
    else:
        made.controls.end_by_error()
    assert made.taken == [("Y", 10.0), ("Z", 20.0), ("X", 20.0)]
    (warning,) = warned
    assert (warning.id, warning.values["offset_mm"]) == (900560, "20.500")
    assert (warning.values["axes"], warning.values["owner"]) == ("Y Z", "the channel")
    made.controls.leave()
    assert len(made.taken) == 3


def test_off_without_a_motion_gives_every_axis_its_own_part() -> None:
    channel = channel_control(
        choose=lambda *_words: None, plan=lambda *_words: None, parameters=dict, is_idle=True,
        age_warning=lambda: None, hand_over=lambda: {"Y": 10.0, "Z": 20.0},
    )  # fmt: skip
    channel.control.command = lambda *_any, **_more: None
    made = Controls(None, channel)
    found: Any = made.controls
    found._command_channel(channel, OFF, no_move=True, dry_run=False)
    assert made.taken == [("Y", 10.0), ("Z", 20.0)]
