"""What a program chooses of the dynamics of the path: its acceleration profile and weights.

Both hold until the program ends. Sources: TF5200 programming manual 207190411 (#SLOPE),
206590731 and 206596619 (G130 to G134: feed blocks only, always a share of what the lists have).
"""

from axisrig.kernel.channel.path.execution import Execution
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings
from axisrig.kernel.motion.course import NO_WEIGHTS, Weights
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.nc import canon


class ProgrammedDynamics:
    """Gives the dynamics of an axis with what the program has chosen; settings: of the channel.

    default_slope: the acceleration profile of everything that chooses none, P-CHAN-00071.
    """

    def __init__(self, settings: ChannelSettings) -> None:
        self._settings = settings
        self.default_slope = settings.slope
        self._slope = settings.slope
        self._shares: dict[str, dict[str, float]] = {}  # by what is weighted, then by axis
        self._weights: dict[str, Weights] = {}

    def assign(self, execution: Execution) -> None:
        """Say what is carried out here."""
        execution.register(canon.SlopeChoice, self.choose)
        execution.register(canon.DynamicWeights, self.weigh)

    def begin(self) -> None:
        """Forget what a program has chosen."""
        self._slope = self.default_slope
        self._shares.clear()
        self._weights.clear()

    def choose(self, command: canon.SlopeChoice) -> None:
        """Move with another acceleration profile from the next path on."""
        self._slope = command.profile or self.default_slope

    def weigh(self, command: canon.DynamicWeights) -> None:
        """Weigh accelerations or ramp times of axes from the next path on; others stay."""
        self._shares.setdefault(command.what, {}).update(command.shares)
        for axis in command.shares:
            self._weights[axis] = self._of_axis(axis)

    def forget_times(self, axis: str) -> None:
        """Take the weight of ramp times from an axis that leaves the channel."""
        if self._shares.get("ramp_time", {}).pop(axis, None) is not None:
            self._weights[axis] = self._of_axis(axis)

    def _of_axis(self, axis: str) -> Weights:
        """Put the shares on what P-CHAN-00001 and P-CHAN-00073 say; 0 there is everything."""
        a, time, contour = (
            self._shares.get(what, {}).get(axis, 1.0)
            for what in ("acceleration", "ramp_time", "contour_time")
        )
        up, down = (_put(a, self._settings.weighted_acceleration, number) for number in (1, 2))
        weighted = self._settings.weighted_time
        rise, fall, brake_rise, brake_fall = (
            _put(time, weighted, number) for number in (1, 2, 3, 4)
        )
        return Weights(up, down, rise, fall, brake_rise, brake_fall, contour)

    def most_mm_s2(self, axis: AxisSettings) -> float:
        """Return the largest acceleration that the weights make of those of feed blocks and runs.

        0 without weights.
        """
        weights = self._weights.get(axis.name)
        if weights is None:
            return 0.0
        every = [axis.dynamics, *axis.jerk_limited.values()]
        found = (kinds[motion] for kinds in every for motion in (Motion.FEED, Motion.MEASURING))
        return max(dynamics.weighted(weights).most_mm_s2 for dynamics in found)

    def dynamics(self, axis: AxisSettings, motion: Motion) -> Dynamics:
        """Return what an axis may do on the path in a kind of motion.

        Raises Alarm 900100 for the profile HSC.
        """
        dynamics = axis.dynamics_of(motion, self._slope)
        if self._weights and self._weighs(motion):
            return dynamics.weighted(self._weights.get(axis.name, NO_WEIGHTS))
        return dynamics

    def _weighs(self, motion: Motion) -> bool:
        measures = motion is Motion.MEASURING and self._settings.weighs_measuring
        return measures or motion is Motion.FEED


def _put(share: float, weighted: int, number: int) -> float:
    return share if weighted in (0, number) else 1.0
