"""What program, PLC side and objects ask of a control is kept in order; what is refused is not."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.distance.conftest import command
from tests.channel.distance.test_offsets_by_hand import Controls, channel_control, stepped
from tests.channel.program_by_hand import Program

from axisrig.kernel.channel import distance_controls
from axisrig.kernel.channel.distance.orders import Order
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.distance.objects import objects
from axisrig.kernel.errors import Alarm, UserError

# Object, its value; its name after `kenngr.dist_ctrl[0].` of a list, and what the control takes
OBJECTS = [
    ("kp", 0.3, "kp", ("kp", 0.3)),
    ("i_tn", 5.0, "i_tn", ("tn_s", 5.0)),
    ("d_tv", 0.01, "d_tv", ("tv_s", 0.01)),
    ("filter_type", "KALMAN_MA", "filter_type", ("kind", "KALMAN_MA")),
    ("n_cycles", 30, "n_cycles", ("n_cycles", 30)),
    ("smooth_fact", 0.5, "smoothing_factor", ("smoothing_factor", 0.5)),
    ("sigma", 2000.0, "kalman_sigma", ("kalman_sigma", 2000.0)),
    ("fg_f0", 50.0, "low_pass_filter_fg_f0", ("low_pass_filter_fg_f0", 50.0)),
    ("order", 3, "low_pass_filter_order", ("low_pass_filter_order", 3)),
    ("max_dist_change", 2500, "max_act_value_change", ("max_change_mm_s", 2.5)),
    ("v_max", 1500, "v_max", ("v_max_mm_s", 1.5)),
    ("a_max", 700, "a_max", ("a_max_mm_s2", 700)),
]
OF_CONTROL = "DIST_CTRL::"


def controls(monkeypatch: pytest.MonkeyPatch, *, of_channel: bool = False) -> tuple[Controls, Any]:
    """Controls of Z or of the channel that take everything; the control's own part."""
    found = {"choose": lambda *_words: None, "require_sensor": lambda: 0.0,
             "age_warning": lambda: None, "set_distance": lambda _mm: None}  # fmt: skip
    if of_channel:
        kind, own = "ChannelDistance", channel_control(**found)
        own.plan = lambda *_words: None
        own.parameters = lambda given: {"n_cycles": 4, **given}
        own.prepare = lambda _wanted: None
        own.guide = SimpleNamespace(axes=())
        made = Controls(None, own)
    else:
        kind, own = "AxisDistance", stepped(is_idle=True, **found)
        made = Controls(own)
    monkeypatch.setattr(distance_controls, kind, SimpleNamespace)
    own.control.taken = []
    for call in ("set_surface", "set_distance", "check_position", "reference"):
        setattr(own.control, call, lambda _value: None)
    own.control.program = lambda **given: own.control.taken.append(given)
    own.control.command = lambda wanted, *_source, **_more: own.control.taken.append(wanted)
    return made, own


def test_every_object_that_can_be_written_is_in_the_table() -> None:
    writable = {item.name for item in objects().values() if item.is_writable}
    assert {OF_CONTROL + name for name, *_ in OBJECTS} == writable


@pytest.mark.parametrize(("name", "value", "listed", "taken"), OBJECTS)
def test_a_written_object_is_an_order_by_its_name_and_unit_in_the_list(
    name: str, value: Any, listed: str, taken: tuple[str, Any]
) -> None:
    """The control has it by the name of its setting, in mm and s."""
    own = stepped()
    requested: list[Any] = []
    own.control.request = lambda setting, value: requested.append((setting, value))
    found = Controls(own).controls
    found.write_object("Z", OF_CONTROL + name, value)
    assert requested == [taken]
    assert found.orders == [Order("Z", "OBJECT", parameters={listed: value})]


@pytest.mark.parametrize("name", ["kq", "m_actual_offset"])
def test_an_object_that_cannot_be_written_leaves_no_order(name: str) -> None:
    found = Controls(stepped()).controls
    with pytest.raises((KeyError, UserError)):
        found.write_object("Z", OF_CONTROL + name, 1.0)
    with pytest.raises(KeyError):
        found.write_object("X", "DIST_CTRL::kp", 0.5)
    assert found.orders == []


ACTIONS = [
    ("on", DistanceCommand.ON),
    ("on_const", DistanceCommand.ON_CONST_DIST),
    ("off", DistanceCommand.OFF),
    ("freeze", DistanceCommand.FREEZE),
]


@pytest.mark.parametrize("of_channel", [False, True])
@pytest.mark.parametrize("dry_run", [False, True])
@pytest.mark.parametrize(("word", "wanted"), ACTIONS)
def test_values_of_a_word_come_before_its_command(
    monkeypatch: pytest.MonkeyPatch, word: str, wanted: DistanceCommand, dry_run: bool,
    of_channel: bool,
) -> None:  # fmt: skip
    """Each with the parameters as programmed; without any the command is alone."""
    made, own = controls(monkeypatch, of_channel=of_channel)
    axis = None if of_channel else "Z"
    program = Program(made.controls)
    program.say(command(word, axis=axis, dry_run=dry_run))  # type: ignore[arg-type]
    alone = Order(axis, "NC", wanted.name, dry_run)
    assert made.controls.orders == [alone]
    given = {"kp": 0.4}
    words: dict[str, Any] = {"set_pos_mm": 0.0, "set_dist_mm": -2.0, "parameters": given}
    program.say(command(word, axis=axis, dry_run=dry_run, **words))  # type: ignore[arg-type]
    values = Order(axis, "NC", "", False, 0.0, -2.0, {"kp": 0.4})
    assert made.controls.orders == [alone, values, alone]
    more = {"n_cycles": 4} if of_channel else {}
    first = [more] if of_channel else []
    assert own.control.taken == [*first, wanted, {**more, "kp": 0.4}, wanted]


@pytest.mark.parametrize("word", [None, "check", "ref"])
def test_words_that_command_nothing_leave_their_values_alone(
    monkeypatch: pytest.MonkeyPatch, word: str | None
) -> None:
    made, own = controls(monkeypatch)
    own.may_reference = lambda: True
    program = Program(made.controls)
    done: list[tuple[str, float]] = []
    own.control.check_position = lambda sensor_mm: done.append(("check", sensor_mm))
    own.control.reference = lambda sensor_mm: done.append(("ref", sensor_mm))
    own.require_sensor = lambda: 0.75
    program.say(command(word))
    assert made.controls.orders == []
    assert done == ([] if word is None else [(word, 0.75)])
    program.say(command(word, set_dist_mm=1.5))
    assert made.controls.orders == [Order("Z", "NC", set_dist_mm=1.5)]


@pytest.mark.parametrize("of_channel", [False, True])
def test_a_command_that_is_refused_leaves_the_values_that_were_taken(
    monkeypatch: pytest.MonkeyPatch, of_channel: bool
) -> None:
    made, own = controls(monkeypatch, of_channel=of_channel)
    axis = None if of_channel else "Z"

    def refuse(*_any: Any, **_more: Any) -> None:
        raise Alarm(310015, owner="Z")

    own.control.command = refuse
    word = command("freeze", axis=axis, set_pos_mm=1.0, wait=True)  # type: ignore[arg-type]
    program = Program(made.controls)
    with pytest.raises(Alarm, match="310015"):
        program.say(word)
    assert made.controls.orders == [Order(axis, "NC", set_pos_mm=1.0)]
    own.control.program = refuse
    with pytest.raises(Alarm, match="310015"):
        program.say(command("off", axis=axis, parameters={"kp": 3.0}))  # type: ignore[arg-type]
    assert len(made.controls.orders) == 1
    assert not program.is_busy()


@pytest.mark.parametrize("wanted", [None, *DistanceCommand])
@pytest.mark.parametrize(
    "values",
    [(None, None), (1.5, None), (None, 2.5), (1.5, 2.5)],
    ids=["none", "pos", "dist", "both"],
)
def test_a_command_of_the_plc_is_kept_as_one_of_the_program(
    monkeypatch: pytest.MonkeyPatch, wanted: DistanceCommand | None, values: Any
) -> None:
    made, own = controls(monkeypatch)
    unit = made.plc.axis["Z"].distance
    unit.enable_w = unit.command_semaphor_rw = True
    unit.command_w.set_pos_mm, unit.command_w.set_dist_mm = values
    unit.command_w.transition = wanted
    made.controls.step()
    first = [] if values == (None, None) else [Order("Z", "PLC", "", False, *values)]
    assert made.controls.orders == first + (
        [] if wanted is None else [Order("Z", "PLC", wanted.name)]
    )
    assert own.control.taken == ([] if wanted is None else [wanted])


def test_a_command_of_the_plc_that_is_refused_leaves_its_values_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made, own = controls(monkeypatch)
    unit = made.plc.axis["Z"].distance
    unit.enable_w = unit.command_semaphor_rw = True
    unit.command_w.set_pos_mm, unit.command_w.transition = 1.5, DistanceCommand.ON

    def refuse(*_any: Any, **_more: Any) -> None:
        raise Alarm(310015, owner="Z")

    own.control.command = refuse
    with pytest.raises(Alarm, match="310015"):
        made.controls.step()
    assert made.controls.orders == [Order("Z", "PLC", set_pos_mm=1.5)]
    assert not unit.command_semaphor_rw
