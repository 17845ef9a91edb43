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
    ("of_axis", "of_channel", "seen"),
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
    seen: tuple[str | None, str | None],
) -> None:
    """Y by its own control, Z by that of the channel; INACTIVE where neither moves it."""
    found = view(of_axis, of_channel)
    assert (found.distance_state("Y"), found.distance_state("Z")) == seen
