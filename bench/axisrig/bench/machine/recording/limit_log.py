"""What the torque limits of the drives were, and from when on."""

from collections.abc import Mapping

from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.record.axes import TorqueLimit
from axisrig.kernel.channel import Channel
from axisrig.kernel.time.clock import TimeNs

_Limits = tuple[int, int, int]  # 6072, 60E1, 60E0: per mille of the rated torque


class LimitLog:
    """Notes the objects of the torque limits of each drive when they change, in every NC cycle.

    A change by SDO acts at once and is noted up to one cycle later.
    """

    def __init__(self, nodes: Mapping[str, DriveNode]) -> None:
        self._images = {name: node.image for name, node in nodes.items()}
        self._changes: dict[str, list[tuple[TimeNs, _Limits]]] = {name: [] for name in nodes}

    def __call__(self, channel: Channel) -> None:
        """Look at the limits of this cycle (step 7 of the cycle)."""
        for name, image in self._images.items():
            now = (image.max_torque, image.negative_torque_limit, image.positive_torque_limit)
            changes = self._changes[name]
            if not changes or changes[-1][1] != now:
                changes.append((channel.sync_ns, now))

    def of(self, axis: str) -> tuple[TorqueLimit, ...]:
        """Return the limits of an axis, in order; none for a real drive."""
        return tuple(TorqueLimit(at, *limits) for at, limits in self._changes.get(axis, ()))
