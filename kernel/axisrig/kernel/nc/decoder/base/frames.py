"""The place of the decoding: the calls that are open and the place in each."""

from collections.abc import Callable
from dataclasses import dataclass, field

from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.cells import Store
from axisrig.kernel.nc.decoder.base.structure import Link
from axisrig.kernel.nc.decoder.base.subprograms import Routine
from axisrig.kernel.nc.expressions import Value
from axisrig.kernel.nc.syntax import ProgramBlock

# How deep subprograms may call each other. The manual has a fixed limit and leaves it open.
CALLS_MAX = 50


@dataclass(eq=False)
class Frame:
    """One call of a routine.

    following: place of the block that comes next. testing: a condition did not hold and the next
    branch is to be asked. choosing: the value of a $SWITCH whose case is being looked for. loops:
    last value and step of the $FOR loops that run, by place. turns: how often each place was
    jumped back to. turning: the loop that has just been jumped back to. turned: the same for any
    jump back, until somebody has looked. seen: what had been changed at the last turn, by place.
    local: the V.L variables that were made in this call. cycle: its parameters @P and @S where this
    is the call of a cycle. at_end: what is to be done when the call ends. decoded: the places that
    have come since the machine last got something to do. again: the block under decoding has come
    before since then. called_again: the call of this frame has.
    """

    routine: Routine
    following: int = 0
    testing: bool = False
    choosing: Value | None = None
    loops: dict[int, tuple[float, float]] = field(default_factory=dict)
    turns: dict[int, int] = field(default_factory=dict)
    turning: int | None = None
    turned: int | None = None
    seen: dict[int, int] = field(default_factory=dict)
    local: Store = field(default_factory=dict)
    cycle: Store | None = None
    at_end: Callable[[], None] | None = None
    decoded: set[int] = field(default_factory=set)
    again: bool = False
    called_again: bool = False

    @property
    def place(self) -> int:
        """The place of the block under decoding."""
        return self.following - 1

    @property
    def link(self) -> Link:
        """Where the control statement under decoding leads."""
        return self.routine.structure.links[self.place]

    def part(self, place: int) -> ProgramBlock:
        """Give the block of a place."""
        return self.routine.blocks[place]

    def jump(self, place: int) -> None:
        """Go on with the block of another place of the routine."""
        self.testing, self.choosing = False, None
        self.following = place

    def turn_back(self, place: int) -> None:
        """Jump back in a loop and count its turn."""
        self.turns[place] = self.turns.get(place, 0) + 1
        self.turning = self.turned = place
        self.jump(place)


class Flow:
    """The open calls, the main program first.

    idle_blocks: how many blocks have come again since the machine last got something to do; those
    of a straight program come once.
    """

    def __init__(self, main: Routine) -> None:
        self.frames = [Frame(main)]
        self.idle_blocks = 0

    @property
    def frame(self) -> Frame:
        """The call under decoding."""
        return self.frames[-1]

    @property
    def file(self) -> str | None:
        """The file of the block under decoding."""
        return self.frame.routine.file

    def advance(self) -> ProgramBlock | None:
        """Give the next block; None after the last one of the main program."""
        while True:
            frame = self.frames[-1]
            if frame.following < len(frame.routine.blocks):
                place = frame.following
                frame.following += 1
                frame.again = frame.called_again or place in frame.decoded
                if frame.again:
                    self.idle_blocks += 1
                else:
                    frame.decoded.add(place)
                return frame.part(place)
            if not self.leave():
                return None

    def give_work(self) -> None:
        """Take note that the machine has something to do: what comes from here on comes first."""
        self.idle_blocks = 0
        for frame in self.frames:
            frame.decoded.clear()
            frame.again = frame.called_again = False

    def jump(self, label: str) -> None:
        """Jump to a label of the routine under decoding."""
        frame = self.frame
        target = frame.routine.structure.targets[label]
        if target < frame.place:
            frame.turn_back(target)
            frame.turning = None
        else:
            frame.jump(target)

    def call(
        self,
        routine: Routine,
        cycle: Store | None = None,
        at_end: Callable[[], None] | None = None,
    ) -> None:
        """Go on with the first block of a subprogram; cycle: its parameters, where it is one.

        at_end: called when the call ends, before the next block of the caller.
        """
        self.frames.append(
            Frame(routine, cycle=cycle, at_end=at_end, called_again=self.frame.again)
        )

    def leave(self) -> bool:
        """Go back after the call; False in the main program, which was not called."""
        if len(self.frames) == 1:
            return False
        ended = self.frames.pop()
        if ended.at_end is not None:
            ended.at_end()
        return True

    def busiest_loop(self) -> tuple[Block, int] | None:
        """Give the loop with the most turns among the open calls: its block and the turns."""
        counted = [
            (turns, frame, place) for frame in self.frames for place, turns in frame.turns.items()
        ]
        if not counted:
            return None
        turns, frame, place = max(counted, key=lambda entry: entry[0])
        return frame.part(place).block, turns
