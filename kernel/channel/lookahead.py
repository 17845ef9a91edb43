"""The block queue between the interpreter and the execution.

Blocks are decoded ahead until one needs the machine: a `Wait` closes the queue until everything
before it has been executed.
"""

from collections import deque
from collections.abc import Callable, Iterator

from kernel.nc.canon import Command, EndOfProgram, Message, Wait

DEPTH = 16


class Lookahead:
    """A queue of decoded commands.

    commands: the interpreter's. put_out: takes messages that do not wait for the machine.
    """

    def __init__(self, commands: Iterator[Command], put_out: Callable[[Message], None]) -> None:
        self._commands = commands
        self._put_out = put_out
        self._queue: deque[Command] = deque()
        self._is_closed = False

    def refill(self) -> None:
        """Decode ahead as far as the queue is deep and no block waits for the machine."""
        while not self._is_closed and len(self._queue) < DEPTH:
            command = next(self._commands)
            if isinstance(command, Message) and not command.synchronous:
                self._put_out(command)
                continue
            self._queue.append(command)
            self._is_closed = isinstance(command, Wait | EndOfProgram)

    @property
    def head(self) -> Command:
        """The command to be executed next."""
        return self._queue[0]

    def pop(self) -> None:
        """Take the head off; taking a `Wait` off lets the interpreter go on."""
        if isinstance(self._queue.popleft(), Wait):
            self._is_closed = False
