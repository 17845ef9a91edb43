"""Which kinematic the channel had when."""

from collections.abc import Iterator

from axisrig.bench.record.kinematics import KinematicChange
from axisrig.kernel.channel import Channel
from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.nc.canon import Command, KinematicChoice


class KinematicLog:
    """Notes what kinematics are made of as the program chooses them, and when they act.

    Looked at in every NC cycle (step 7 of the cycle).
    """

    def __init__(self) -> None:
        self._choices: list[KinematicChoice] = []
        self._acting: Kinematic | None = None
        self._changes: list[KinematicChange] = []

    def take(self, command: Command) -> None:
        """Take a command of the program; only a chosen kinematic is of interest."""
        if isinstance(command, KinematicChoice) and command.kinematic is not None:
            self._choices.append(command)

    def __call__(self, channel: Channel) -> None:
        """Look at the kinematic of this cycle."""
        kinematic = channel.path.kinematic
        if kinematic is not self._acting:
            self._acting = kinematic
            self._changes.append(self._change(kinematic, channel.sync_ns))

    def _change(self, kinematic: Kinematic | None, time_ns: int) -> KinematicChange:
        for choice in reversed(self._choices):
            if choice.kinematic is kinematic:
                program = tuple(_entries(choice))
                return KinematicChange(time_ns, choice.ids, program, choice.tool_mm)
        return KinematicChange(time_ns)

    @property
    def changes(self) -> tuple[KinematicChange, ...]:
        """The changes in their order."""
        return tuple(self._changes)


def _entries(choice: KinematicChoice) -> Iterator[tuple[int, int, int, float]]:
    for (step, number, index), value in choice.written.items():
        yield (step, number, index, value)
