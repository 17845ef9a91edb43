"""How distance controls end, with a program, an alarm, a reset; and how they are made."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.channel.distance.channel import ChannelDistance
from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings, ChannelDistanceSettings
from axisrig.kernel.channel.distance_controls import DistanceControls, make_controls
from axisrig.kernel.distance import (
    DistanceCommand,
    DistanceControl,
    DistanceSettings,
    DistanceState,
    Source,
)
from axisrig.kernel.distance.limiter import UNLIMITED
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.time.clock import MS

AXES = ("X", "Z")
NO_SET_VALUE = 70335
SETTINGS = DistanceSettings(a_max_mm_s2=1.0)
STATES = pytest.mark.parametrize("state", list(DistanceState))


class Bench:
    """Real controls of X and Z, and one of the channel, which notes its calls."""

    def __init__(self) -> None:
        self.calls: list[str] = []
        self.axes = {name: self._axis(name) for name in AXES}
        self.channel: Any = SimpleNamespace(
            control=DistanceControl("the channel", DistanceSettings(), MS),
            end_program=lambda: self.calls.append("end"),
            forget=lambda: self.calls.append("forget"),
            switch_off_kept=lambda: self.calls.append("off"), has_offset=False, is_moving=False,
            may_move=lambda axes: "X" in axes,
        )  # fmt: skip
        single: Any = SimpleNamespace(couplings=SimpleNamespace(slaves_of=lambda _axes: {}))
        plc: Any = SimpleNamespace(
            axis={name: SimpleNamespace(distance=SimpleNamespace(state_r=None)) for name in AXES},
            outlives_program=False,
        )  # fmt: skip
        settings: Any = [SimpleNamespace(name=name) for name in AXES]
        path: Any = SimpleNamespace(let_float=lambda _axes: None)
        offsets = Offsets(self.axes, self.channel, AXES)
        self.warned: list[tuple[int, object]] = []
        self.controls = DistanceControls(
            path, single, settings, offsets, plc,
            lambda alarm: self.warned.append((alarm.id, alarm.values.get("axis"))),
        )  # fmt: skip

    @staticmethod
    def _axis(name: str) -> Any:
        control = DistanceControl(f"axis {name}", DistanceSettings(), MS)
        control.set_surface(1.0)
        control.set_distance(2.0)
        return SimpleNamespace(
            name=name, control=control, has_offset=False, is_moving=False, show=lambda _unit: None
        )

    def lead_to(self, state: DistanceState) -> None:
        for control in (self.channel.control, *(axis.control for axis in self.axes.values())):
            control.state = state

    @property
    def states(self) -> list[str]:
        return [axis.control.state.name for axis in self.axes.values()]

    @property
    def has_set_values(self) -> bool:
        """Whether ON finds them; asked of a control that is off."""
        control = self.axes["Z"].control
        control.state = DistanceState.INACTIVE
        try:
            control.command(DistanceCommand.ON, Source.NC)
        except Alarm as alarm:
            return alarm.id != NO_SET_VALUE
        return True


@STATES
def test_a_program_that_ends_tells_of_what_is_on_and_forgets_its_set_values(
    state: DistanceState,
) -> None:
    bench = Bench()
    bench.lead_to(state)
    bench.controls.end_program("N50")
    is_off = state is DistanceState.INACTIVE
    assert bench.warned == ([] if is_off else [(70332, "X"), (70332, "Z")])
    assert (bench.calls, bench.states) == (["end"], [state.name] * 2)
    assert bench.axes["X"].control.set_pos_mm == (None if is_off else 1.0)
    assert not bench.has_set_values


@STATES
def test_an_alarm_switches_off_all_but_what_is_in_error(state: DistanceState) -> None:
    bench = Bench()
    bench.lead_to(state)
    bench.controls.end_by_error()
    left = state if state is DistanceState.ERROR else DistanceState.INACTIVE
    assert (bench.warned, bench.states) == ([], [left.name] * 2)
    assert bench.calls == ["off", "end"]
    assert not bench.has_set_values


@STATES
def test_a_reset_leads_out_of_an_error_too(state: DistanceState) -> None:
    bench = Bench()
    bench.lead_to(state)
    bench.controls.reset()
    assert bench.states == ["INACTIVE"] * 2
    assert (bench.channel.control.state, bench.calls) == (DistanceState.INACTIVE, ["forget"])
    assert not bench.has_set_values


@pytest.mark.parametrize(
    ("axes", "states", "calls"),
    [
        (("X",), ["INACTIVE", "ACTIVE"], ["off"]), (("Z",), ["ACTIVE", "INACTIVE"], []),
        (("W",), ["ACTIVE", "ACTIVE"], []), (("Z", "X"), ["INACTIVE", "INACTIVE"], ["off"]),
    ],
)  # fmt: skip
def test_an_error_of_some_axes_switches_their_controls_off(
    axes: tuple[str, ...], states: list[str], calls: list[str]
) -> None:
    bench = Bench()
    bench.lead_to(DistanceState.ACTIVE)
    bench.controls.switch_off(axes)
    assert (bench.states, bench.calls) == (states, calls)
    assert bench.has_set_values


@pytest.mark.parametrize("where", ["X", "Z", "channel", None])
def test_an_offset_still_runs_out_while_one_of_them_does(where: str | None) -> None:
    bench = Bench()
    if where is not None:
        found = bench.channel if where == "channel" else bench.axes[where]
        found.control.state = DistanceState.TURNING_OFF
    assert bench.controls.is_turning_off is (where is not None)


# Made


@pytest.mark.parametrize("has_channel", [True, False])
@pytest.mark.parametrize("has_own", [True, False])
def test_controls_are_made_where_the_lists_release_them(has_channel: bool, has_own: bool) -> None:
    """A program finds the tool at 0 where there is 3D control, and has no such variable else."""
    own = AxisDistanceSettings(SETTINGS) if has_own else None
    axes: Any = [
        SimpleNamespace(name=name, distance=own if name == "Z" else None, allowed=UNLIMITED)
        for name in AXES
    ]
    settings: Any = SimpleNamespace(
        distance=ChannelDistanceSettings(SETTINGS) if has_channel else None
    )
    links: Any = {
        name: SimpleNamespace(
            name=name,
            settings=SimpleNamespace(increments_per_mm=1000.0, sensor_age_limit_ms=None),
        )
        for name in AXES
    }
    clock: Any = SimpleNamespace(now_ns=0)
    plc = PlcInterface(clock, AXES)
    found = make_controls(axes, settings, links, plc, lambda: None, MS)
    assert list(found.axes) == (["Z"] if has_own else [])
    assert all(isinstance(axis, AxisDistance) for axis in found.axes.values())
    assert isinstance(found.channel, ChannelDistance) is has_channel
    assert found.is_used is (has_own or has_channel)
    assert plc.values == (dict.fromkeys(canon.SHOWN_OF_TOOL, 0.0) if has_channel else {})
    if found.channel is not None:
        assert found.channel.names == AXES
