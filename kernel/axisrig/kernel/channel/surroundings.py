"""What a channel works with besides its axes and buses."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from axisrig.kernel.channel.path.monitor import Monitor
from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import TimeNs


class Mechanics(Protocol):
    """The axes and sensors at the drives. The channel learns no value of them.

    goes_on: they are looked at also after a program that has ended well: cycles go on until
    `has_come_to_rest`.
    """

    goes_on: bool

    def advance_to(self, sync_ns: TimeNs) -> None:
        """Be at the instant of the last SYNC: observers look at the mechanics of this cycle."""

    def has_come_to_rest(self) -> bool:
        """Return whether the axes are at rest; asked in every cycle from the end of a run on."""


class NoMechanics:
    """Nothing is simulated here: nothing is waited for."""

    def __init__(self) -> None:
        self.goes_on = False

    def advance_to(self, sync_ns: TimeNs) -> None:
        """Do nothing."""

    def has_come_to_rest(self) -> bool:
        """Always at rest: nothing moves."""
        return True


@dataclass(frozen=True)
class Surroundings:
    """The collaborators of a channel.

    put_out: takes every message as soon as it is due. monitor: the watch over drives and buses.
    functions: what #DRIVE and #IDENT act on.
    mechanics: what the drives move; after an alarm SYNC and cycles go on until it is at rest.
    """

    put_out: Callable[[canon.Message], None]
    monitor: Monitor
    functions: DriveAccesses = field(default_factory=DriveAccesses)
    mechanics: Mechanics = field(default_factory=NoMechanics)
