"""What a start-up waits for, as values that its generator yields; and how it goes on.

A start-up is a generator: it yields a question and gets the answer back in the event in which that
is there. Nothing waits.
"""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

from axisrig.kernel.drives.cia402.objects import ObjectAccess
from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, at_station
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.profiles.ethercat.tables import Command, address_of
from axisrig.kernel.time.clock import Clock, Phase, TimeNs


@dataclass(frozen=True)
class Ask:
    """Datagrams in one frame; the answer: what came back of each, None when no frame did."""

    datagrams: Sequence[Datagram]


@dataclass(frozen=True)
class Pause:
    """So long, ns; the answer is None."""

    time_ns: TimeNs


@dataclass(frozen=True)
class ReadObject:
    """An object; the answer: its bytes or an SdoError."""

    access: ObjectAccess
    index: int
    sub: int


@dataclass(frozen=True)
class WriteObject:
    """An object to be written; the answer: b"" or an SdoError."""

    access: ObjectAccess
    index: int
    sub: int
    data: bytes


@dataclass(frozen=True)
class Call:
    """What is begun with a function that gets the answer; the answer: what that was called with."""

    begin: Callable[[Callable[[Any], None]], None]


Step = Ask | Pause | ReadObject | WriteObject | Call
Steps = Generator[Step, Any, Any]


class DriveSteps:
    """What the family of a drive adds to the start-up of its slave; this base adds nothing."""

    def in_preop(self) -> Steps:
        """Set up what may be set up in PREOP only. Raises Alarm."""
        yield from ()

    def before_safeop(self) -> Steps:
        """Do what comes between the set-up of the process data and SAFEOP. Raises Alarm."""
        yield from ()

    def before_op(self) -> Steps:
        """Do what comes between SAFEOP and OP. Raises Alarm."""
        yield from ()

    def not_in_op(self) -> None:
        """Take note that the slave has not reached OP."""

    def in_op(self) -> Steps:
        """Do what needs OP. Raises Alarm."""
        yield from ()


class Stepper:
    """Runs one generator; `transactions` carry its questions."""

    def __init__(self, transactions: Transactions, clock: Clock) -> None:
        self._transactions, self._clock = transactions, clock
        self._steps: Steps | None = None

    def run(self, steps: Steps) -> None:
        """Begin a generator; what it was at before is dropped."""
        self._steps = steps
        self._go_on(steps, None)

    def _go_on(self, steps: Steps, answer: Any) -> None:
        if steps is not self._steps:
            return
        try:
            step = steps.send(answer)
        except StopIteration:
            self._steps = None
            return

        def done(found: Any) -> None:
            self._go_on(steps, found)

        match step:
            case Ask(datagrams):
                self._transactions.ask(datagrams, done)
            case Pause(time_ns):
                due_ns = self._clock.now_ns + time_ns
                self._clock.call_at(due_ns, Phase.APPLICATION, lambda: done(None))
            case ReadObject(access, index, sub):
                access.read(index, sub, done)
            case WriteObject(access, index, sub, data):
                access.write(index, sub, data, done)
            case Call(begin):
                begin(done)


def read_register(station: int, name: str, size: int) -> Ask:
    """Ask for a register of a slave by its name in `registers.csv`."""
    return Ask([Datagram(Command.FPRD, at_station(station, address_of(name)), bytes(size))])


def write_register(station: int, name: str, data: bytes, offset: int = 0) -> Ask:
    """Write a register of a slave."""
    address = at_station(station, address_of(name) + offset)
    return Ask([Datagram(Command.FPWR, address, data)])


def write_all(name: str, data: bytes) -> Ask:
    """Write a register of all slaves."""
    return Ask([Datagram(Command.BWR, address_of(name) << 16, data)])


def value_of(answers: list[Answer] | None, counter: int = 1) -> int | None:
    """Return what the first datagram has read, None where its slave did not answer."""
    if not answers or answers[0].counter != counter:
        return None
    return int.from_bytes(answers[0].data, "little")
