"""What the decoder remembers of single axes: who is under way, who follows whom, who is away."""

from dataclasses import dataclass, field

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import AxisPair
from axisrig.kernel.nc.decoder.base.context import Context


@dataclass
class AxisStates:
    """under_way: axes that move beside the program (INDP_ASYN), in the order of their commands.

    groups: coupling groups as defined. active: groups that are on, in the order of switching on.
    away: axes that have been given away. offsets_mm: of coupled slaves to their masters.
    """

    under_way: dict[str, None] = field(default_factory=dict)
    groups: dict[int, tuple[AxisPair, ...]] = field(default_factory=dict)
    active: list[int] = field(default_factory=list)
    away: set[str] = field(default_factory=set)
    offsets_mm: dict[str, float] = field(default_factory=dict)

    @property
    def is_plain(self) -> bool:
        """Whether nothing forbids or delays the use of any axis."""
        return not (self.under_way or self.active or self.away)

    def pairs(self) -> list[tuple[int, AxisPair]]:
        """Every pair that is coupled, with its group."""
        return [(group, pair) for group in self.active for pair in self.groups[group]]

    def group_of(self, axis: str) -> int | None:
        """The active group in which an axis is master or slave."""
        for group, pair in self.pairs():
            if axis in (pair.master, pair.slave):
                return group
        return None


def states(context: Context) -> AxisStates:
    """Give the states of the axes."""
    return context.part(AxisStates)


def forbidden(context: Context, block: Block, axis: str) -> Alarm | None:
    """Give the alarm of a block that programs an axis which is away or follows another."""
    known = states(context)
    if axis in known.away:
        return context.alarm(900195, block, axis=axis)
    for group, pair in known.pairs():
        if pair.slave == axis:
            return context.alarm(900196, block, axis=axis, master=pair.master, group=group)
    return None
