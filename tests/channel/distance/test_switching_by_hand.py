"""When distance control may be switched on, and when a command of it may begin, by hand."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.distance.conftest import command
from tests.channel.distance.test_offsets_by_hand import Controls
from tests.channel.distance.test_orders_of_controls import ACTIONS, controls
from tests.channel.program_by_hand import Program

from axisrig.kernel.distance import DistanceCommand, DistanceSettings, DistanceState
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon

ON_WORDS = ("on", "on_const")
WORDS = [word for word, _ in ACTIONS]
EVERY_WORD = pytest.mark.parametrize("word", WORDS)


def measuring(made: Controls, **states: str) -> None:
    """Let runs of axes be under way."""
    single: Any = made.controls._single
    single.measuring_state = states.get


def of_axis(monkeypatch: pytest.MonkeyPatch, *, is_newer: bool = True) -> tuple[Controls, Any]:
    made, own = controls(monkeypatch)
    own.control.settings = DistanceSettings(is_newer=is_newer)
    return made, own


def of_channel(monkeypatch: pytest.MonkeyPatch, *axes: str) -> tuple[Controls, Any]:
    made, own = controls(monkeypatch, of_channel=True)
    own.guide = SimpleNamespace(axes=axes)
    return made, own


def say(made: Controls, word: str, axis: str | None, **more: Any) -> Alarm | None:
    try:
        Program(made.controls).say(command(word, axis=axis, **more))  # type: ignore[arg-type]
    except Alarm as alarm:
        return alarm
    return None


# Beside a measurement


@pytest.mark.parametrize("dry_run", [True, False])
@pytest.mark.parametrize(("is_newer", "alarm_id"), [(True, 310005), (False, 70521)])
@EVERY_WORD
def test_an_axis_that_measures_is_switched_on_for_a_dry_run_only(
    monkeypatch: pytest.MonkeyPatch, word: str, is_newer: bool, alarm_id: int, dry_run: bool
) -> None:
    made, own = of_axis(monkeypatch, is_newer=is_newer)
    measuring(made, Z="ARMING")
    alarm = say(made, word, "Z", dry_run=dry_run)
    if word in ON_WORDS and not dry_run:
        assert alarm is not None
        assert (alarm.id, alarm.values["state"], alarm.values["owner"]) == (
            alarm_id, "ARMING", "axis Z",
        )  # fmt: skip
        assert own.control.taken == []
    else:
        assert (alarm, len(own.control.taken)) == (None, 1)


@pytest.mark.parametrize("dry_run", [True, False])
@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@EVERY_WORD
def test_no_axis_of_the_channel_may_measure_but_beside_a_dry_run(
    monkeypatch: pytest.MonkeyPatch, word: str, axis: str, dry_run: bool
) -> None:
    """X and Z are moved by it; Y may do what it likes."""
    made, own = of_channel(monkeypatch, "X", "Z")
    measuring(made, **{axis: "MOVING"})
    alarm = say(made, word, None, dry_run=dry_run)
    if word in ON_WORDS and not dry_run and axis != "Y":
        assert alarm is not None
        assert (alarm.id, alarm.values["state"]) == (310005, "MOVING")
    else:
        assert alarm is None
    commands = [each for each in own.control.taken if isinstance(each, DistanceCommand)]
    assert len(commands) == (alarm is None)


def test_an_axis_that_measures_keeps_no_other_one(monkeypatch: pytest.MonkeyPatch) -> None:
    made, own = of_axis(monkeypatch)
    measuring(made, X="MOVING", Y="ARMING")
    assert say(made, "on", "Z") is None
    assert own.control.taken == [DistanceCommand.ON]


# Two controls


@pytest.mark.parametrize("dry_run", [True, False])
@pytest.mark.parametrize("is_idle", [True, False])
@pytest.mark.parametrize("moves", [("X", "Z"), ("X", "Y")])
@EVERY_WORD
def test_an_axis_that_the_channel_moves_has_no_control_of_its_own_besides(
    monkeypatch: pytest.MonkeyPatch, word: str, moves: tuple[str, ...], is_idle: bool, dry_run: bool
) -> None:
    made, own = of_axis(monkeypatch)
    other: Any = SimpleNamespace(
        is_idle=is_idle, may_move=lambda axes: not set(axes).isdisjoint(moves), is_moving=False
    )
    made.controls.channel = other
    alarm = say(made, word, "Z", dry_run=dry_run)
    if word in ON_WORDS and not is_idle and "Z" in moves:
        assert alarm is not None
        assert (alarm.id, alarm.values) == (900466, {"owner": "axis Z", "other": "the channel"})
    else:
        assert alarm is None
    assert len(own.control.taken) == (alarm is None)


@pytest.mark.parametrize("is_idle", [True, False])
@pytest.mark.parametrize("moves", [("X", "Z"), ("X", "Y")])
@EVERY_WORD
def test_the_channel_moves_no_axis_whose_own_control_is_on(
    monkeypatch: pytest.MonkeyPatch, word: str, moves: tuple[str, ...], is_idle: bool
) -> None:
    made, _ = of_channel(monkeypatch, *moves)
    own: Any = SimpleNamespace(
        is_idle=is_idle, is_moving=False, control=SimpleNamespace(state=DistanceState.FREEZE),
        show=lambda _state: None,
    )  # fmt: skip
    axes: Any = made.controls.axes
    axes["Z"] = own
    alarm = say(made, word, None)
    if word in ON_WORDS and not is_idle and "Z" in moves:
        assert alarm is not None
        assert (alarm.id, alarm.values) == (900466, {"owner": "the channel", "other": "axis Z"})
    else:
        assert alarm is None


# Warnings


@EVERY_WORD
@pytest.mark.parametrize("has_channel", [True, False])
def test_the_age_of_a_sensor_is_warned_of_where_it_is_switched_on(
    monkeypatch: pytest.MonkeyPatch, word: str, has_channel: bool
) -> None:
    made, own = of_channel(monkeypatch, "X") if has_channel else of_axis(monkeypatch)
    own.age_warning = lambda: Alarm(900315, owner="axis Z", source="VARIABLE V.E.A")
    assert say(made, word, None if has_channel else "Z") is None
    assert made.warned == ([900315] if word in ON_WORDS else [])


@pytest.mark.parametrize(("word", "warned"), [("on_const", [900464]), ("off", [])])
def test_the_length_of_a_tool_is_warned_of_after_the_command(
    monkeypatch: pytest.MonkeyPatch, word: str, warned: list[int]
) -> None:
    made, own = of_channel(monkeypatch, "X")
    own.prepare = lambda _wanted: Alarm(
        900464, owner="the channel", set_dist_mm="1", length_mm="80"
    )
    assert say(made, word, None) is None
    assert made.warned == warned


# OFF NO_MOVE


@pytest.mark.parametrize("state", [DistanceState.INACTIVE, DistanceState.TURNING_OFF])
@pytest.mark.parametrize("no_move", [True, False])
def test_an_axis_and_its_slaves_take_over_what_is_sent_when_nothing_is_to_move(
    monkeypatch: pytest.MonkeyPatch, state: DistanceState, no_move: bool
) -> None:
    made, own = of_axis(monkeypatch)
    made.controls._slaves_of = lambda axes: {"X": "Z"} if "Z" in axes else {}
    own.control.state, own.pending_mm = state, 3.0
    single: Any = made.controls._single
    single.independent = SimpleNamespace(are_moving=lambda _axes: False)
    own.forget_offset = lambda: made.taken.append(("forgotten", 0.0))
    assert say(made, "off", "Z", no_move=no_move) is None
    is_taken = no_move and state is DistanceState.INACTIVE
    assert made.taken == ([("Z", 3.0), ("X", 3.0), ("forgotten", 0.0)] if is_taken else [])


# When a command may begin


def ready(made: Controls, word: str | None, axis: str | None, **more: Any) -> bool:
    program = Program(made.controls)
    program.head = command(word, axis=axis, **more)  # type: ignore[arg-type]
    found = program._ready[canon.DistanceCommand]
    return bool(found())


@pytest.mark.parametrize("axis", ["Z", None])
def test_ref_waits_for_what_its_control_knows_and_nothing_else_does(
    monkeypatch: pytest.MonkeyPatch, axis: str | None
) -> None:
    made, own = of_axis(monkeypatch) if axis else of_channel(monkeypatch, "X")
    for knows in (True, False):
        own.may_reference = lambda knows=knows: knows
        assert ready(made, "ref", axis) is knows
        assert all(ready(made, word, axis) for word in (None, "check", *WORDS))


def test_ref_without_a_control_begins_to_be_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    made, _ = of_axis(monkeypatch)
    assert ready(made, "ref", "X")
    assert ready(made, "ref", None)


@pytest.mark.parametrize(
    ("axis", "beside", "is_settled", "begins"),
    [
        ("Z", (), True, True), ("Z", ("Z",), True, False), ("Z", ("X",), True, True),
        ("Z", (), False, True), (None, (), True, True), (None, (), False, False),
        (None, ("Z",), True, True),
    ],
)  # fmt: skip
def test_off_no_move_waits_for_what_moves_its_axes(
    monkeypatch: pytest.MonkeyPatch, axis: str | None, beside: tuple[str, ...], is_settled: bool,
    begins: bool,
) -> None:  # fmt: skip
    """An axis for its own motion beside the path, the channel for the path."""
    made, _ = of_axis(monkeypatch) if axis else of_channel(monkeypatch, "X", "Z")
    single: Any = made.controls._single
    single.independent = SimpleNamespace(are_moving=lambda axes: not set(axes).isdisjoint(beside))
    path: Any = made.controls._path
    path.is_settled = is_settled
    assert ready(made, "off", axis, no_move=True) is begins
    assert ready(made, "off", axis)
