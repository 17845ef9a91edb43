"""What the torque limits of the drives were, and from when on."""

from collections.abc import Mapping

from axisrig.bench.drive.application.servo import Servo
from axisrig.bench.record.axes import ForceLimit
from axisrig.kernel.channel import Channel
from axisrig.kernel.time.clock import TimeNs

PER_MILLE = 1000
_Limits = tuple[int, int]  # negative and positive direction, per mille of the rated torque


class LimitLog:
    """Notes the torque limits of each drive, looked at in every NC cycle, when they change.

    A change by SDO acts at once and is noted up to one cycle later.
    """

    def __init__(self, servos: Mapping[str, Servo]) -> None:
        self._servos = servos
        self._changes: dict[str, list[tuple[TimeNs, _Limits]]] = {name: [] for name in servos}

    def __call__(self, channel: Channel) -> None:
        """Look at the limits of this cycle (step 7 of the cycle)."""
        for name, servo in self._servos.items():
            now = (servo.limits.negative, servo.limits.positive)
            changes = self._changes[name]
            if not changes or changes[-1][1] != now:
                changes.append((channel.sync_ns, now))

    def of(self, axis: str) -> tuple[ForceLimit, ...]:
        """Return the limits of an axis in N, in order; none for a drive outside.

        Without a limit it is far above every motor.
        """
        if axis not in self._servos:
            return ()
        rated_n = self._servos[axis].limits.rated_n
        return tuple(
            ForceLimit(at, negative * rated_n / PER_MILLE, positive * rated_n / PER_MILLE)
            for at, (negative, positive) in self._changes[axis]
        )
