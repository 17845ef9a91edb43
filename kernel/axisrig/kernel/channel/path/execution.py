"""Carries out the commands of the block queue, each as soon as what is before it allows.

Who can carry out a kind of command says so by `register`: when one of it may begin, and what
beginning means. A command that takes time makes its owner busy (`while_busy`), and nothing else
begins until it is not.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any

from axisrig.kernel.channel.path.lookahead import Lookahead
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Ready = Callable[[], bool]
Begin = Callable[[Any], None]


def at_once() -> bool:
    """Say that a command may begin as soon as it is at the head of the queue."""
    return True


class BlockEnd(Enum):
    """How a command came to its end: carried out, by an alarm, or by a reset of the PLC side."""

    DONE = "done"
    STOPPED = "stopped"
    RESET = "reset"


class BlockWatch:
    """Notes when commands begin and end, and changes nothing."""

    def waits(self, command: canon.Command) -> None:
        """Note a command that is the next one and may not begin yet; called once for each."""

    def begins(self, command: canon.Command) -> None:
        """Note a command that begins in this cycle."""

    def ends(self, how: BlockEnd) -> None:
        """Note that nothing of the last command keeps the next one waiting from this cycle on."""


@dataclass(frozen=True)
class _Step:
    ready: Ready
    begin: Begin
    is_block: bool


class Execution:
    """The queue of a channel and who carries out what.

    block: the block under execution, for the place of an alarm. begun: the last command begun.
    watches: note what begins and ends.
    """

    def __init__(self, put_out: Callable[[canon.Message], None]) -> None:
        self._put_out = put_out
        self._steps: dict[type, _Step] = {}
        self._busy: list[Ready] = []
        self._queue: Lookahead | None = None
        self.block: Block | None = None
        self.begun: canon.Command | None = None
        self.watches: list[BlockWatch] = []
        self._awaited: canon.Command | None = None
        self._is_under_way = False
        self.register(canon.Message, put_out, is_block=False)

    def register(
        self, kind: type, begin: Begin, *, ready: Ready = at_once, is_block: bool = True
    ) -> None:
        """Say who carries out a kind of command.

        ready: whether one may begin in this cycle. is_block: whether its block counts as the one
        under execution.
        """
        self._steps[kind] = _Step(ready, begin, is_block)

    def while_busy(self, is_busy: Ready) -> None:
        """Let no command begin while this holds."""
        self._busy.append(is_busy)

    def load(self, commands: Iterator[canon.Command]) -> None:
        """Take the command stream of an interpreter."""
        self.drop()
        self._queue = Lookahead(commands, self._put_out)

    def drop(self) -> None:
        """Forget the program: nothing of it is carried out any more."""
        self.close(BlockEnd.RESET)
        self._queue = self.block = self.begun = None

    def close(self, how: BlockEnd) -> None:
        """Report the end of the command under way, or of the one that has not begun."""
        if self._is_under_way or self._awaited is not None:
            self._is_under_way, self._awaited = False, None
            for watch in self.watches:
                watch.ends(how)

    @property
    def failed(self) -> Alarm | None:
        """The alarm of a block that could not be decoded."""
        return None if self._queue is None else self._queue.failed

    @property
    def head(self) -> canon.Command | None:
        """The command that is to begin next, None when none is decoded."""
        return None if self._queue is None or self._queue.is_empty else self._queue.head

    def is_busy(self) -> bool:
        """Return whether somebody still carries out a command that keeps the next one waiting."""
        for is_busy in self._busy:  # noqa: SIM110 - asked in every cycle, without a generator
            if is_busy():
                return True
        return False

    def step(self) -> None:
        """Begin what can begin in this cycle; returns at the end of the program."""
        assert self._queue is not None
        self._queue.begin_cycle()
        while not self.is_busy():
            if self._is_under_way:
                self.close(BlockEnd.DONE)
            self._queue.refill()
            if self._queue.is_empty:
                return
            command = self._queue.head
            step = self._steps[type(command)]
            if not step.ready():
                if self._awaited is not command:
                    self._awaited = command
                    for watch in self.watches:
                        watch.waits(command)
                return
            if step.is_block:
                self.block = command.block
            self.begun, self._awaited, self._is_under_way = command, None, True
            for watch in self.watches:
                watch.begins(command)
            step.begin(command)
            self._queue.pop()
            if isinstance(command, canon.EndOfProgram):
                self.close(BlockEnd.DONE)
                return
