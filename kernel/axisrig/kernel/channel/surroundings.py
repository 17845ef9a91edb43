"""What a channel works with besides its axes and buses."""

from collections.abc import Callable
from dataclasses import dataclass, field

from axisrig.kernel.channel.mechanics import Mechanics, NoMechanics
from axisrig.kernel.channel.path.monitor import Monitor
from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.nc import canon


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
