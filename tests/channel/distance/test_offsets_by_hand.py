"""What the offsets of an axis and of the channel give together, and what is commanded by hand."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.program_by_hand import Program

from axisrig.kernel.channel import distance_controls
from axisrig.kernel.channel.distance.guide import (
    ECS,
    LEAST_COSINE,
    MCS,
    StayingGuide,
    ToolGuide,
)
from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.distance_controls import DistanceControls
from axisrig.kernel.distance import DistanceCommand, DistanceState, Source
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.plc.unit import AxisUnit

AXES = ("X", "Y", "Z")


def axis_control(*, checks_limits: bool = False, **found: Any) -> Any:
    """The control of an axis that computes 2 mm, sends 3 mm and has sent 5 mm before."""
    control = SimpleNamespace(
        state=DistanceState.INACTIVE, offset_mm=2.0, owner="axis Z", forgotten=0
    )
    settings = SimpleNamespace(checks_limits=checks_limits)
    wanted: dict[str, Any] = {"pending_mm": 3.0, "output_mm": 5.0, "is_moving": False}
    return SimpleNamespace(control=control, settings=settings, name="Z", **wanted | found)


def channel_control(*, checks_limits: bool = False, **found: Any) -> Any:
    """3D control that has superposed 10 mm on Y and 20 mm on Z."""
    control = SimpleNamespace(state=DistanceState.INACTIVE, offset_mm=20.0, owner="the channel")
    wanted: dict[str, Any] = {
        "deltas_mm": {"Y": 10.0, "Z": 20.0}, "is_moving": False,
        "guide": SimpleNamespace(axes=("Y", "Z")), "moved": ("Z",),
    }  # fmt: skip
    settings = SimpleNamespace(checks_limits=checks_limits)
    return SimpleNamespace(control=control, settings=settings, **wanted | found)


# Sums


@pytest.mark.parametrize(
    ("has_own", "has_channel", "superposed_mm"),
    [(False, False, [0.0, 0.0, 0.0]), (True, False, [0.0, 0.0, 3.0]),
     (False, True, [0.0, 10.0, 20.0]), (True, True, [0.0, 10.0, 23.0])],
)  # fmt: skip
def test_what_is_superposed_in_this_cycle(
    has_own: bool, has_channel: bool, superposed_mm: list[float]
) -> None:
    own = {"Z": axis_control()} if has_own else {}
    offsets = Offsets(own, channel_control() if has_channel else None, AXES)
    assert [offsets.superposed_mm(axis) for axis in AXES] == superposed_mm
    assert offsets.is_used is (has_own or has_channel)


@pytest.mark.parametrize(
    ("own_counts", "channel_counts", "counted_mm", "uncounted_mm"),
    [
        (False, False, [0.0, 0.0, 0.0], {"X": 0.0, "Y": 10.0, "Z": 25.0}),
        (True, False, [0.0, 0.0, 2.0], {"X": 0.0, "Y": 10.0, "Z": 20.0}),
        (False, True, [0.0, 10.0, 20.0], {"Z": 5.0}),
        (True, True, [0.0, 10.0, 22.0], {}),
    ],
)
def test_what_counts_for_the_software_limit_switches_and_what_does_not(
    own_counts: bool,
    channel_counts: bool,
    counted_mm: list[float],
    uncounted_mm: dict[str, float],
) -> None:
    """What a control computes counts, what has been sent is taken off: each control for itself."""
    channel = channel_control(checks_limits=channel_counts)
    offsets = Offsets({"Z": axis_control(checks_limits=own_counts)}, channel, AXES)
    assert [offsets.counted_mm(axis) for axis in AXES] == counted_mm
    assert {axis: found() for axis, found in offsets.uncounted_mm().items()} == uncounted_mm


@pytest.mark.parametrize(
    ("own_moves", "channel_moves", "owners"),
    [
        (False, False, [None, None, None]),
        (True, False, [None, None, "900521 Z axis Z"]),
        (False, True, [None, "900521 Y the channel", "900521 Z the channel"]),
        (True, True, [None, "900521 Y the channel", "900521 Z axis Z"]),
    ],
)
def test_an_axis_does_not_measure_while_a_control_of_it_is_on(
    own_moves: bool, channel_moves: bool, owners: list[str | None]
) -> None:
    own, channel = axis_control(is_moving=own_moves), channel_control(is_moving=channel_moves)
    offsets = Offsets({"Z": own}, channel, AXES)
    found: list[str | None] = []
    for axis in AXES:
        try:
            offsets.check_measuring(axis)
            found.append(None)
        except Alarm as alarm:
            found.append(f"{alarm.id} {alarm.values['axis']} {alarm.values['owner']}")
    assert found == owners
    channel.guide = None
    offsets.check_measuring("Y")


# The controls


class Controls:
    """The controls of X, Y and Z over a path that notes its calls; Z has its own one."""

    def __init__(self, own: Any, channel: Any = None, slaves: dict[str, str] | None = None) -> None:
        self.floating: set[str] = set()
        self.taken: list[tuple[str, float]] = []
        path: Any = SimpleNamespace(
            let_float=self._float, take_offset=lambda axis, mm: self.taken.append((axis, mm))
        )
        couplings = SimpleNamespace(
            slaves_of=lambda axes: {s: m for s, m in (slaves or {}).items() if m in axes}
        )
        single: Any = SimpleNamespace(couplings=couplings, measuring_state=lambda _axis: None)
        self.plc: Any = SimpleNamespace(
            axis={axis: AxisUnit() for axis in AXES}, outlives_program=True
        )
        settings: Any = [SimpleNamespace(name=axis, tells_newer_ids=True) for axis in AXES]
        self.warned: list[int] = []
        self.controls = DistanceControls(
            path, single, settings, Offsets({} if own is None else {"Z": own}, channel, AXES),
            self.plc, lambda alarm: self.warned.append(alarm.id),
        )  # fmt: skip

    def _float(self, axes: set[str]) -> None:
        self.floating = set(axes)


def stepped(*, raises: int | None = None, **found: Any) -> Any:
    """A control of Z that notes its cycles, and ends them with an alarm if wished."""
    noted: list[str] = []

    def step() -> None:
        noted.append("step")
        if raises is not None:
            raise Alarm(raises, owner="axis Z", axis="Z", what="", allowed="")

    return axis_control(
        take=lambda: noted.append("take"), step=step, show=lambda _state: noted.append("show"),
        noted=noted, put_out=lambda: 5.0, is_held=False, override=0.0, **found,
    )  # fmt: skip


def test_slaves_follow_the_offset_of_their_master_and_that_of_the_channel() -> None:
    own = stepped()
    channel = channel_control(deltas_mm={"Z": 20.0}, superpose=lambda at: (*at[:2], at[2] + 20.0))
    found = Controls(own, slaves={"X": "Z", "Y": "X"})
    assert found.controls.superpose((100.0, 200.0, 300.0)) == (105.0, 200.0, 305.0)
    both = Controls(own, channel, slaves={"X": "Z"})
    assert both.controls.superpose((100.0, 200.0, 300.0)) == (125.0, 200.0, 325.0)
    alone = Controls(None, channel, slaves={"Y": "Z"})
    assert alone.controls.superpose((100.0, 200.0, 300.0)) == (100.0, 220.0, 320.0)


def test_what_holds_an_axis_and_its_override_act_on_its_control() -> None:
    own = stepped()
    found = Controls(own)
    unit = found.plc.axis["Z"]
    unit.override_permille = 250
    found.controls.step()
    assert (own.is_held, own.override) == (unit.holds, 250 / FULL)
    assert own.noted == ["take", "step", "show"]
    assert found.controls.has_stepped
    found.controls.superpose((0.0, 0.0, 0.0))
    assert not found.controls.has_stepped


def test_the_first_alarm_of_a_cycle_is_raised_and_the_others_wait() -> None:
    channel = channel_control(
        look=lambda: None, take=lambda: None, moved=("Y", "Z"), step=lambda: None
    )
    found = Controls(stepped(raises=900501), channel)
    found.plc.axis["Y"].override_permille = 300
    found.plc.axis["Z"].override_permille = 700
    found.plc.axis["X"].distance.enable_w = True
    found.plc.axis["X"].distance.command_semaphor_rw = True
    with pytest.raises(Alarm) as caught:
        found.controls.step()
    assert (caught.value.id, [a.id for a in found.controls.further]) == (310015, [900501])
    assert channel.override == 300 / FULL


@pytest.mark.parametrize(
    ("is_enabled", "is_stopping", "is_taken"),
    [(True, False, True), (False, False, False), (True, True, False)],
)
def test_a_command_of_the_plc_is_taken_where_it_is_enabled_and_no_alarm_has_ended_the_program(
    is_enabled: bool, is_stopping: bool, is_taken: bool
) -> None:
    own = stepped()
    given: list[Any] = []
    own.control.command = lambda wanted, source, **_more: given.append((wanted, source))
    own.control.set_surface = own.control.set_distance = given.append
    found = Controls(own)
    unit = found.plc.axis["Z"].distance
    unit.enable_w, unit.command_semaphor_rw = is_enabled, True
    unit.command_w.set_pos_mm, unit.command_w.set_dist_mm = 1.5, None
    unit.command_w.transition = DistanceCommand.FREEZE
    found.controls.step(is_stopping=is_stopping)
    assert given == ([1.5, (DistanceCommand.FREEZE, Source.PLC)] if is_taken else [])
    assert unit.command_semaphor_rw is not is_taken
    assert [order.axis for order in found.controls.orders] == (["Z"] * 2 if is_taken else [])


@pytest.mark.parametrize(("set_pos_mm", "set_dist_mm"), [(0.0, None), (None, 0.0), (0.0, 0.0)])
def test_zero_from_the_plc_is_taken_and_recorded_as_any_other_value(
    set_pos_mm: float | None, set_dist_mm: float | None
) -> None:
    own = stepped()
    taken: list[tuple[str, float]] = []
    own.control.set_surface = lambda value_mm: taken.append(("position", value_mm))
    own.control.set_distance = lambda value_mm: taken.append(("distance", value_mm))
    found = Controls(own)
    unit = found.plc.axis["Z"].distance
    unit.enable_w, unit.command_semaphor_rw = True, True
    unit.command_w.set_pos_mm, unit.command_w.set_dist_mm = set_pos_mm, set_dist_mm
    found.controls.step()
    both = (("position", set_pos_mm), ("distance", set_dist_mm))
    assert taken == [one for one in both if one[1] is not None]
    (order,) = found.controls.orders
    assert (order.axis, order.by, order.action) == ("Z", "PLC", "")
    assert (order.set_pos_mm, order.set_dist_mm) == (set_pos_mm, set_dist_mm)


def test_a_control_that_moves_an_axis_lets_it_float() -> None:
    own = stepped(is_moving=True)
    found = Controls(own)
    found.controls.step()
    assert found.floating == {"Z"}
    own.is_moving = False
    found.controls.step()
    assert found.floating == set()


@pytest.mark.parametrize(("held", "is_held"), [((), False), (("X",), False), (("Z",), True)])
def test_an_axis_that_is_held_holds_the_control_of_the_channel_that_moves_it(
    held: tuple[str, ...], is_held: bool
) -> None:
    channel = channel_control(
        look=lambda: None, take=lambda: None, moved=("Y", "Z"), step=lambda: None
    )
    found = Controls(None, channel)
    for axis in held:
        found.plc.axis[axis].feedhold = True
    found.controls.step()
    assert (channel.is_held, channel.override) == (is_held, 1.0)


@pytest.mark.parametrize(
    ("state", "has_offset", "outlives", "offset_mm", "taken", "warned"),
    [
        (DistanceState.INACTIVE, True, True, 2.0, [("Z", 3.0), ("X", 3.0)], [900560]),
        (DistanceState.INACTIVE, True, True, -2.0, [("Z", 3.0), ("X", 3.0)], [900560]),
        (DistanceState.INACTIVE, True, True, 0.0004, [("Z", 3.0), ("X", 3.0)], []),
        (DistanceState.INACTIVE, True, True, 0.0, [("Z", 3.0), ("X", 3.0)], []),
        (DistanceState.INACTIVE, True, False, 2.0, [], []),
        (DistanceState.INACTIVE, False, True, 2.0, [], []),
        (DistanceState.ERROR, True, True, 2.0, [], []),
    ],
)
def test_axes_at_rest_keep_the_offset_of_a_control_that_is_off(
    state: DistanceState, has_offset: bool, outlives: bool, offset_mm: float,
    taken: list[tuple[str, float]], warned: list[int],
) -> None:  # fmt: skip
    """Slaves too; what was computed and has not been sent is warned of and not taken over."""
    own = stepped(has_offset=has_offset, hand_over=lambda: {"Z": 3.0})
    own.control.state, own.control.offset_mm = state, offset_mm
    found = Controls(own, slaves={"X": "Z"})
    found.plc.outlives_program = outlives
    found.controls.leave()
    assert (found.taken, found.warned) == (taken, warned)


def test_a_program_waits_for_an_offset_that_runs_out_and_not_behind_a_reset(
    say: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(distance_controls, "AxisDistance", SimpleNamespace)
    own = stepped(choose=lambda _source, _variable: None)
    own.control.command = lambda *_any, **_more: None
    own.control.switch_off_kept = own.control.forget_set_values = lambda: None
    found = Controls(own)
    program = Program(found.controls)
    own.control.state = DistanceState.TURNING_OFF
    program.say(say.command("off"))
    assert not program.is_busy()
    program.say(say.command("off", wait=True))
    assert program.is_busy()
    own.control.state = DistanceState.INACTIVE
    assert not program.is_busy()
    own.control.state = DistanceState.TURNING_OFF
    assert not program.is_busy()
    program.say(say.command("off", wait=True))
    found.controls.reset()
    assert not program.is_busy()


# Where the offset of the channel acts


@pytest.mark.parametrize(
    ("mode", "leaning", "way_mm"),
    [
        (MCS, (0.0, 0.0, 1.0), (0.0, 0.0, 2.0)),
        (MCS, (0.6, 0.0, 0.8), (0.0, 0.0, 2.0)),
        (ECS, (0.6, 0.0, 0.8), (1.5, 0.0, 2.0)),
        (ECS, (0.0, 0.6, -0.8), (0.0, 1.2 / LEAST_COSINE, -1.6 / LEAST_COSINE)),
    ],
)
def test_an_offset_moves_the_tool_and_an_axis_that_does_not_move_keeps_its_bits(
    mode: str, leaning: tuple[float, float, float], way_mm: tuple[float, float, float]
) -> None:
    """The way through this kinematic leaves 2e-12 of each axis; the fourth is none of its own."""
    kinematic: Any = SimpleNamespace(
        count=3,
        forward=lambda at: tuple(mm + 1e-12 for mm in at),
        inverse=lambda tool, _near: tuple(mm + 1e-12 for mm in tool),
        direction=lambda _tool: leaning,
    )
    guide = ToolGuide(mode, kinematic, (*AXES, "W"), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    base = (0.1, 0.2, 0.3, 0.4)
    moved = guide.superposed(base, 2.0)
    assert (len(moved), moved[3]) == (4, 0.4)
    for before, after, way in zip(base, moved, way_mm, strict=False):
        assert after == (pytest.approx(before + way, abs=1e-9) if way else before)
    assert guide.rates(base) == pytest.approx([way / 2.0 for way in way_mm])


def test_an_offset_that_stays_moves_each_axis_by_its_share() -> None:
    kinematic: Any = SimpleNamespace(count=3)
    left = ToolGuide(ECS, kinematic, AXES, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    guide = StayingGuide(left, 2.0, AXES, {"X": 1.0, "Z": 2.0})
    assert guide.superposed((10.0, 20.0, 30.0), 0.5) == (10.25, 20.0, 30.5)
    assert (guide.is_same(guide), guide.is_same(left), guide.cosine((0.0,))) == (True, False, 1.0)
    none = StayingGuide(left, 0.0, AXES, {"X": 1.0})
    assert none.superposed((10.0, 20.0, 30.0), 0.5) == (10.0, 20.0, 30.0)
