"""What distance control superposes on the set positions, for who plans them.

Path and measurement runs ask here; the controls (`kernel.channel.distance_controls`) ask these two
in turn, so that neither needs the other one.
"""

from collections.abc import Callable, Mapping
from functools import partial

from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.errors import Alarm

CONTROL_IS_ON = 310000


class Offsets:
    """The offsets of the axes of a channel, in mm; axes: those with a distance control."""

    def __init__(self, axes: Mapping[str, AxisDistance]) -> None:
        self.axes = axes

    def check_measuring(self, axis: str) -> None:
        """Raise Alarm 310000 for an axis that cannot measure while its control is on."""
        found = self.axes.get(axis)
        if found is not None and found.is_moving and not found.control.is_dry_run:
            word = f"{found.control.state.name}"
            raise Alarm(CONTROL_IS_ON, axis=axis, master=axis, controlword=word)

    def superposed_mm(self, axis: str) -> float:
        """Return the offset of an axis that is sent in this cycle."""
        found = self.axes.get(axis)
        return 0.0 if found is None else found.pending_mm

    def counted_mm(self, axis: str) -> float:
        """Return the offset of an axis as far as it counts for the software limit switches."""
        found = self.axes.get(axis)
        counts = found is not None and found.settings.checks_limits
        return found.control.offset_mm if found is not None and counts else 0.0

    def uncounted_mm(self) -> dict[str, Callable[[], float]]:
        """Return, by axis, what gives the part of a position that does not count for the switches.

        That is the offset where P-AXIS-00428 is 0.
        """
        return {
            name: partial(getattr, axis, "output_mm")
            for name, axis in self.axes.items()
            if not axis.settings.checks_limits
        }
