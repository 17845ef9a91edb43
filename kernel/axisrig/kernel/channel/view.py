"""What a program may ask of its channel while it is decoded (`MachineView` of the interpreter)."""

from collections.abc import Sequence

from axisrig.kernel.channel.distance_controls import DistanceControls
from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.distance import DistanceState
from axisrig.kernel.drives.interface import Drive, DriveAccesses
from axisrig.kernel.nc.decoder.base.context import ChannelControl


class ChannelView:
    """The part of a channel that answers its interpreter; lengths in mm."""

    path: Path
    measurement: Measurement
    distance: DistanceControls
    functions: DriveAccesses
    axes: Sequence[AxisSettings]
    links: Sequence[Drive]

    def position_acs_mm(self, axis: str) -> float:
        """Return the set position of the interpolation, axis coordinates."""
        return self.path.position_acs_mm(axis)

    def measured_acs_mm(self, axis: str) -> float | None:
        """Return the measured position of the axis' last run, None without a valid one."""
        return self.measurement.measured_acs_mm(axis)

    def measurement_ok(self, axis: str) -> bool:
        """Return whether the axis' last run had a signal (V.A.MERF)."""
        return self.measurement.measured_acs_mm(axis) is not None

    def actual_acs_mm(self, axis: str) -> float:
        """Return the actual position of an axis."""
        return next(link.actual_mm for link in self.links if link.name == axis)

    def may_measure(self, axis: str) -> bool:
        """Return whether an axis is a measuring axis (P-AXIS-00118)."""
        return self.path.settings(axis).may_measure

    def is_sercos(self, axis: str) -> bool:
        """Return whether the drive of an axis speaks SERCOS."""
        return next(link.is_sercos for link in self.links if link.name == axis)

    def distance_state(self, axis: str) -> str | None:
        """Give the state of the distance control of an axis (ACTIVE, ..); None without one.

        That of 3D control while it may move the axis; INACTIVE where it does not.
        """
        found, channel = self.distance.axes.get(axis), self.distance.channel
        if channel is not None:
            if not channel.is_idle and channel.may_move((axis,)):
                return channel.control.state.name
            return DistanceState.INACTIVE.name if found is None else found.control.state.name
        return None if found is None else found.control.state.name

    def channel_distance(self) -> ChannelControl | None:
        """Give the 3D distance control of the channel; None where P-CHAN-00500 is without it."""
        channel = self.distance.channel
        return None if channel is None else ChannelControl(channel.plane, channel.is_licensed)

    def axis_numbered(self, number: int) -> str | None:
        """Return the axis with a logical number (P-AXIS-00016), None when there is none."""
        return next((axis.name for axis in self.axes if axis.number == number), None)

    def drive_value(self, axis: str, key: str) -> float:
        """Return what the last #DRIVE RD of this function returned."""
        return self.functions.value(axis, key)
