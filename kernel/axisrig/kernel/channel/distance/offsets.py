"""What distance control superposes on the set positions, for who plans them.

Path and measurement runs ask here; the controls (`kernel.channel.distance_controls`) ask these two
in turn, so that neither needs the other one.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Final

from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.channel.distance.channel import ChannelDistance
from axisrig.kernel.errors import Alarm

CONTROL_IS_ON: Final = 900521


class Offsets:
    """The offsets of the axes of a channel, in mm; axes: those with a distance control.

    channel: 3D control, None without one; names: of all axes.
    """

    def __init__(
        self,
        axes: Mapping[str, AxisDistance],
        channel: ChannelDistance | None = None,
        names: Sequence[str] = (),
    ) -> None:
        self.axes, self.channel, self._names = axes, channel, tuple(names)

    @property
    def is_used(self) -> bool:
        """Whether there is any control."""
        return bool(self.axes) or self.channel is not None

    def check_measuring(self, axis: str) -> None:
        """Raise Alarm 900521 for an axis that cannot measure while a control of it is on."""
        for found in (self.axes.get(axis), self._channel_of(axis)):
            if found is not None and found.is_moving:
                word = found.control.state.name
                owner = found.control.owner
                raise Alarm(CONTROL_IS_ON, axis=axis, owner=owner, controlword=word)

    def _channel_of(self, axis: str) -> ChannelDistance | None:
        channel = self.channel
        is_led = channel is not None and channel.guide is not None and axis in channel.guide.axes
        return channel if is_led else None

    def superposed_mm(self, axis: str) -> float:
        """Return the offset of an axis that is sent in this cycle."""
        found, channel = self.axes.get(axis), self.channel
        of_channel_mm = 0.0 if channel is None else channel.deltas_mm.get(axis, 0.0)
        return of_channel_mm if found is None else found.pending_mm + of_channel_mm

    def counted_mm(self, axis: str) -> float:
        """Return the offset of an axis as far as it counts for the software limit switches."""
        found, channel = self.axes.get(axis), self.channel
        counted_mm = 0.0
        if channel is not None and channel.settings.checks_limits:
            counted_mm = channel.deltas_mm.get(axis, 0.0)
        if found is not None and found.settings.checks_limits:
            counted_mm += found.control.offset_mm
        return counted_mm

    def uncounted_mm(self) -> dict[str, Callable[[], float]]:
        """Return, by axis, what gives the part of a position that does not count for the switches.

        That is the offset where P-AXIS-00428 is 0, and P-CHAN-00809 for 3D control.
        """
        channel = self.channel
        if channel is not None and not channel.settings.checks_limits:
            return {name: partial(self._uncounted_mm, channel, name) for name in self._names}
        return {
            name: partial(getattr, axis, "output_mm")
            for name, axis in self.axes.items()
            if not axis.settings.checks_limits
        }

    def _uncounted_mm(self, channel: ChannelDistance, name: str) -> float:
        axis = self.axes.get(name)
        own_mm = 0.0 if axis is None or axis.settings.checks_limits else axis.output_mm
        return own_mm + channel.deltas_mm.get(name, 0.0)
