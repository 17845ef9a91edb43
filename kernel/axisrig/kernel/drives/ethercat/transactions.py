"""Questions beside the cyclic frame: one frame each, known again by its index, begun anew if lost.

Nothing waits: `done` is called when the answer is there. While cyclic frames run a question leaves
behind one of them, so that it never keeps the next one from the wire.
"""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from axisrig.kernel.drives.ethercat.frames import (
    INDEX_PLACE,
    Answer,
    Datagram,
    Way,
    answers_of,
    frame_of,
)
from axisrig.kernel.drives.ethercat.port import EthercatPort
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

ATTEMPTS: Final = 3
TIMEOUT_NS: Final[TimeNs] = 2 * MS
INDICES: Final = range(1, 0x80)
"""Indices of these frames; the cyclic ones have the others."""

Taken = Callable[[list[Answer] | None], None]
"""Takes what came back of each datagram, None when no frame came back at all."""


@dataclass
class _Question:
    datagrams: Sequence[Datagram]
    done: Taken
    attempts_left: int
    number: int = 0


class Transactions:
    """Asks one question after the other.

    is_held: whether questions wait for `let_go`, which the cyclic frame calls when it is back or
    was lost. sent: how many frames have left. way: of all frames.
    """

    def __init__(self, port: EthercatPort, clock: Clock) -> None:
        self._port, self._clock = port, clock
        self._queue: deque[_Question] = deque()
        self._index, self._number = 0, 0
        self._is_under_way = False
        self.is_held = False
        self.sent = 0
        self.way = Way()
        self._sent_ns: TimeNs = 0

    def ask(self, datagrams: Sequence[Datagram], done: Taken, attempts: int = ATTEMPTS) -> None:
        """Ask; `done` gets the answers, one for each datagram."""
        self._queue.append(_Question(datagrams, done, attempts))
        if not self.is_held:
            self.let_go()

    def let_go(self) -> None:
        """Send the next question, if none is under way."""
        if self._queue and not self._is_under_way:
            self._send(self._queue[0])

    def _send(self, question: _Question) -> None:
        self._index = self._index % (len(INDICES) - 1) + INDICES[0]
        self._number += 1
        question.number, self._is_under_way = self._number, True
        question.attempts_left -= 1
        self.sent += 1
        number = self._number
        self._sent_ns = self._clock.now_ns
        self._port.send(bytes(frame_of(question.datagrams, self._index)))
        self._clock.call_at(
            self._clock.now_ns + TIMEOUT_NS, Phase.APPLICATION, lambda: self._time_out(number)
        )

    def _time_out(self, number: int) -> None:
        if not self._is_under_way or self._queue[0].number != number:
            return
        self._is_under_way = False
        if self._queue[0].attempts_left:
            self.let_go()
        else:
            self._end(None)

    def received(self, frame: bytes) -> None:
        """Take a frame that is back; one that is too late counts as lost."""
        if self._is_under_way and frame[INDEX_PLACE] == self._index:
            self.way.later_ns(self._sent_ns, self._clock.now_ns, len(frame))
            answers = answers_of(frame)
            self._is_under_way = False
            is_whole = len(answers) == len(self._queue[0].datagrams)
            self._end(answers if is_whole else None)

    def _end(self, answers: list[Answer] | None) -> None:
        question = self._queue.popleft()
        question.done(answers)
        if not self.is_held:
            self.let_go()
