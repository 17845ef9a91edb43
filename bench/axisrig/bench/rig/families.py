"""What a rig asks of each family of drives, without knowing any (`reading/families.csv`)."""

from collections.abc import Sequence
from typing import NamedTuple

from axisrig.bench.rig.reading.families import FAMILIES, loaded
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import TimeNs


class TerminalGrid(NamedTuple):
    """When the inputs of a terminal are sampled: every period.

    offset_ns: after the begin of a cycle. late_ns: until the telegram is there, in the worst case
    of the cycle.
    """

    period_ns: TimeNs
    offset_ns: TimeNs
    late_ns: TimeNs


class SecondEncoder(NamedTuple):
    """How a second encoder comes. words: what carries it. every: with so many cycles.

    promised_ns: the longest time from one value to the next, None where nothing promises one.
    """

    words: str
    every: int
    promised_ns: TimeNs | None


class RigFamily:
    """What is on the segments of one carrier, with drives of any family that it carries.

    The module that `rig` of a row names has one as `FAMILY`. This base checks and describes
    nothing. fault_rooms: rooms of `faults.csv` whose kinds act on its segments and their drives.
    has_objects: columns and programs may write to them.
    """

    fault_rooms: tuple[str, ...] = ()
    has_objects = False

    def check_addresses(self, settings: Settings) -> None:
        """Check addresses. Raises UserError with file, line and key of the rig."""

    def check(self, settings: Settings) -> None:
        """Check what drives have against what is wanted of them, and the time on their segments.

        Raises UserError with file, line and key of the rig.
        """

    def describe(self, settings: Settings) -> Sequence[str]:
        """Say how measured values are proved, and how late they may be."""
        return ()

    def warn(self, settings: Settings) -> Sequence[str]:
        """Say what files of drives have against the rig."""
        return ()

    def second_encoder(self, settings: Settings, axis: str) -> SecondEncoder | None:
        """Return how the second encoder of an axis comes, None where it does not."""
        return None

    def late_cycles(self, settings: Settings, axis: str) -> int:
        """Return by how many cycles more than 2 an NC cycle sees what its set values do."""
        return 0

    def fresh_late_cycles(self, settings: Settings, axis: str) -> int:
        """Return the same of what the PLC reads as it was at the last SYNC of the drive."""
        return 0

    def terminal_grid(self, settings: Settings) -> TerminalGrid | None:
        """Return the instants of the terminal of the PLC, where it is on such a segment."""
        return None

    def tables(self, settings: Settings) -> Sequence[str]:
        """Show how the cycle fits on each segment."""
        return ()

    def outside(self, settings: Settings, axis: str) -> str:
        """Say where the real drive of an axis is, and what of its scaling nobody checks."""
        raise NotImplementedError


def rig_families() -> list[RigFamily]:
    """Return what each carrier of the registry has to say, in its order."""
    return [loaded(module).FAMILY for module in dict.fromkeys(row.rig for row in FAMILIES)]


def family_of(settings: Settings, axis: str) -> RigFamily:
    """Return who knows the drive of an axis on its segment."""
    return family_on(settings, settings.rig.axis[axis].segment)


def family_on(settings: Settings, segment: str) -> RigFamily:
    """Return who knows what is on a segment."""
    carrier = settings.segment[segment].carrier
    module = next(row.rig for row in FAMILIES if row.carrier == carrier)
    found: RigFamily = loaded(module).FAMILY
    return found
