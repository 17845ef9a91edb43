"""The kinematic transformation of a channel: which one is on, and the way from axes to tool."""

from collections.abc import Sequence

from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.motion.curves import Curve, Positions
from axisrig.kernel.motion.tool_path import ToolCurve
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import Clock, TimeNs


class Transformation:
    """The kinematic of a channel; positions are those of all its axes, in their order.

    kinematic: None while none is on. choices: cycles in which one was switched on, and off (None).
    """

    def __init__(self, clock: Clock, links: Sequence[Drive]) -> None:
        self._clock, self._links = clock, tuple(links)
        self.kinematic: Kinematic | None = None
        self.choices: list[tuple[TimeNs, canon.KinematicChoice | None]] = []

    def choose(self, command: canon.KinematicChoice) -> None:
        """Take targets in tool coordinates from here on, or in axis coordinates again.

        To be called while the axes are at rest; nothing moves.
        """
        if command.kinematic is None:
            self.end()
        else:
            self.choices.append((self._clock.now_ns, command))
            self.kinematic = command.kinematic

    def end(self) -> None:
        """Take targets in axis coordinates from here on."""
        if self.kinematic is not None:
            self.choices.append((self._clock.now_ns, None))
        self.kinematic = None

    def coordinates(self, axes: Positions) -> Positions:
        """Give axis positions in the coordinates of targets; axes beside the kinematic are both."""
        kinematic = self.kinematic
        if kinematic is None:
            return axes
        return (*kinematic.forward(axes[: kinematic.count]), *axes[kinematic.count :])

    def curve(self, path: Curve, near: Positions) -> ToolCurve:
        """See a path of tool coordinates from the axes, which are at `near`."""
        assert self.kinematic is not None
        return ToolCurve(path, self.kinematic, near)

    def state(self) -> tuple[float | None, float | None]:
        """Return tilt (degrees) and length (mm) of the tool at the actual positions.

        None without a kinematic.
        """
        kinematic = self.kinematic
        if kinematic is None:
            return None, None
        at = kinematic.forward(tuple(link.actual_mm for link in self._links[: kinematic.count]))
        return kinematic.tilt_deg(at), kinematic.length_mm(at)
