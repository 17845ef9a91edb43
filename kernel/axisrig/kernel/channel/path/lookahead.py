"""The block queue between the decoder and the execution.

Blocks are decoded ahead until one needs the machine: a `Wait` closes the queue until everything
before it has been executed, a programmed stop until the program goes on. Nothing else closes it.
"""

from collections import deque
from collections.abc import Callable, Iterator
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Command, EndOfProgram, Message, ProgramStop, Wait

DEPTH: Final = 16
_CLOSES = (Wait, EndOfProgram, ProgramStop)


class Lookahead:
    """A queue of decoded commands.

    commands: the decoder's. put_out: takes messages that do not wait for the machine.
    failed: the alarm of a block that could not be decoded. It comes up after the blocks before it.
    """

    def __init__(self, commands: Iterator[Command], put_out: Callable[[Message], None]) -> None:
        self._commands = commands
        self._put_out = put_out
        self._queue: deque[Command] = deque()
        self._is_closed = False
        self._closed_for_cycle = False
        self.failed: Alarm | None = None

    def begin_cycle(self) -> None:
        """Let the decoder go on after a wait for the next cycle."""
        self._closed_for_cycle = False

    def refill(self) -> None:
        """Decode ahead as far as the queue is deep and no block waits for the machine.

        Raises the alarm of a block that cannot be decoded once everything before it has been
        carried out: what is decoded is executed (ISG kernel, error reaction class 2, 249161867).
        """
        while not self._is_closed and not self._closed_for_cycle and len(self._queue) < DEPTH:
            try:
                command = next(self._commands)
            except Alarm as alarm:
                self.failed, self._is_closed = alarm, True
                break
            if isinstance(command, Message) and not command.synchronous:
                self._put_out(command)
                continue
            self._queue.append(command)
            self._is_closed = isinstance(command, _CLOSES)
        if self.failed is not None and not self._queue:
            raise self.failed

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to execute in this cycle."""
        return not self._queue

    @property
    def head(self) -> Command:
        """The command to be executed next."""
        return self._queue[0]

    def pop(self) -> None:
        """Take the head off; taking off what has closed the queue lets the decoder go on."""
        command = self._queue.popleft()
        if isinstance(command, _CLOSES):
            self._is_closed = False
            self._closed_for_cycle = isinstance(command, Wait) and command.for_cycle
