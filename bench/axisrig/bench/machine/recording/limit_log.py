"""What the torque limits of the drives were, and from when on."""

from collections.abc import Mapping

from axisrig.bench.drive.axis.drive import VirtualDrive
from axisrig.bench.record.axes import TorqueLimit
from axisrig.kernel.channel import Channel
from axisrig.kernel.time.clock import TimeNs

_Limits = tuple[int, int, int]  # largest, negative, positive: per mille of the rated torque


class LimitLog:
    """Notes the torque limits of each virtual drive when they change, in every NC cycle.

    A change beside the cycle acts at once and is noted up to one cycle later.
    """

    def __init__(self, drives: Mapping[str, VirtualDrive]) -> None:
        self._drives = dict(drives)
        self._changes: dict[str, list[tuple[TimeNs, _Limits]]] = {name: [] for name in drives}

    def __call__(self, channel: Channel) -> None:
        """Look at the limits of this cycle (step 7 of the cycle)."""
        for name, drive in self._drives.items():
            now = drive.torque_limits
            changes = self._changes[name]
            if now is not None and (not changes or changes[-1][1] != now):
                changes.append((channel.sync_ns, now))

    def of(self, axis: str) -> tuple[TorqueLimit, ...]:
        """Return the limits of an axis, in order; none for a real drive."""
        return tuple(TorqueLimit(at, *limits) for at, limits in self._changes.get(axis, ()))
