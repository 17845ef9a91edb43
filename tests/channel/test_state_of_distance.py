"""The state of distance control that a program is given for an axis (V.A., `MachineView`)."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.view import ChannelView
from axisrig.kernel.distance import DistanceState

ON, FROZEN = DistanceState.ACTIVE, DistanceState.FREEZE


def view(of_axis: DistanceState | None, of_channel: DistanceState | None) -> ChannelView:
    """Y may have a control of its own; 3D control moves X and Z."""
    axes: dict[str, Any] = {}
    if of_axis is not None:
        axes["Y"] = SimpleNamespace(control=SimpleNamespace(state=of_axis))
    channel = None
    if of_channel is not None:
        channel = SimpleNamespace(
            is_idle=of_channel is DistanceState.INACTIVE,
            may_move=lambda names: not {"X", "Z"}.isdisjoint(names),
            control=SimpleNamespace(state=of_channel),
        )
    found = ChannelView()
    distance: Any = SimpleNamespace(axes=axes, channel=channel)
    found.distance = distance
    return found


@pytest.mark.parametrize(
    ("of_axis", "of_channel", "states"),
    [
        (None, None, (None, None)),
        (FROZEN, None, ("FREEZE", None)),
        (None, ON, ("INACTIVE", ON.name)),
        (FROZEN, ON, ("FREEZE", ON.name)),
        (FROZEN, DistanceState.INACTIVE, ("FREEZE", "INACTIVE")),
    ],
)
def test_it_is_that_of_the_control_that_moves_the_axis(
    of_axis: DistanceState | None,
    of_channel: DistanceState | None,
    states: tuple[str | None, str | None],
) -> None:
    """Y by its own control, Z by that of the channel; INACTIVE where neither moves it."""
    found = view(of_axis, of_channel)
    assert (found.distance_state("Y"), found.distance_state("Z")) == states


@pytest.mark.parametrize(
    ("of_channel", "state"),
    [
        (DistanceState.INACTIVE, "ACTIVE"),  # its guide of before would move X and Z
        (None, "ACTIVE"),
        (FROZEN, "FREEZE"),
        (DistanceState.TURNING_OFF, "TURNING_OFF"),
    ],
)
def test_an_idle_control_of_the_channel_says_nothing_about_an_axis_with_its_own(
    of_channel: DistanceState | None, state: str
) -> None:
    found = view(ON, of_channel)
    axes: Any = found.distance.axes
    axes["Z"] = axes["Y"]
    assert (found.distance_state("Z"), found.distance_state("Y")) == (state, "ACTIVE")


def test_a_run_that_has_measured_0_has_measured() -> None:
    """V.A.MERF and V.A.MESS of a position at the zero of the axis."""
    found = ChannelView()
    measured = {"X": 0.0, "Y": -1.5}
    measurement: Any = SimpleNamespace(measured_acs_mm=measured.get)
    found.measurement = measurement
    assert [found.measurement_ok(axis) for axis in "XYZ"] == [True, True, False]
    assert [found.measured_acs_mm(axis) for axis in "XYZ"] == [0.0, -1.5, None]


def test_an_axis_is_found_by_its_own_logical_number() -> None:
    found = ChannelView()
    axes: Any = [SimpleNamespace(name=n, number=k) for n, k in (("X", 5), ("Y", 2), ("Z", 9))]
    found.axes = axes
    expected = {5: "X", 2: "Y", 9: "Z", 1: None, 3: None, 10: None}
    assert {number: found.axis_numbered(number) for number in expected} == expected
