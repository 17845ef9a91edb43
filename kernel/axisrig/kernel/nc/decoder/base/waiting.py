"""Finds loops that wait for the PLC side where nothing can change what they wait for.

A turn that writes nothing and gives the machine nothing but time begins the next one with the same
values: with a PLC side that does not change they go on for ever.
"""

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.syntax import Assign, Command, Declare, EndFor, For, Statement, Words

# They pass time or report something, and change no value
_HARMLESS = ("MSG", "TIME", "FLUSH", "FLUSH WAIT", "FLUSH CONTINUE", "WAIT FOR")


class Waiting:
    """What the decoding has changed and asked; a topic state of the context.

    is_constant: nothing but the program changes V.E. variables in this run. changes: counts what
    may have changed a value. asked: V.E. variables that were read since the last turn of a loop.
    """

    def __init__(self) -> None:
        self.is_constant = False
        self.changes = 0
        self.asked: dict[str, None] = {}

    def note(self, statement: Statement, waits: str) -> None:
        """Count a block that may change a value or reads one of the machine."""
        if waits == "machine" or may_change(statement):
            self.changes += 1

    def turn(self, context: Context, block: Block) -> None:
        """Look at a loop that has just been jumped back to; raises Alarm 900126."""
        frame = context.flow.frame
        place, frame.turned = frame.turned, None
        assert place is not None
        if self.is_constant and self.asked and frame.seen.get(place) == self.changes:
            raise self.alarm(context, block, frame.part(place).block)
        frame.seen[place] = self.changes
        self.asked.clear()

    def alarm(self, context: Context, block: Block, begin: Block) -> Alarm:
        """Make the alarm of a loop, or of a block that waits by itself."""
        waits = f"line {begin.line} ({begin.text})"
        return context.alarm(900126, block, loop=waits, names=", ".join(sorted(self.asked)))


def may_change(statement: Statement) -> bool:
    """Return whether a block may change a value or move something."""
    if isinstance(statement, Words):
        is_dwell = statement.g == ("G4",) and not (statement.m or statement.axis_commands)
        return not is_dwell
    if isinstance(statement, Command):
        return statement.name not in _HARMLESS
    return isinstance(statement, Assign | Declare | For | EndFor)
