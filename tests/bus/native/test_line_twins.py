"""The line of a bus and the scheduler in C do what their twins in Python do, event by event.

The same random traffic runs on both: ports with queues of both kinds, identifiers that collide,
remote and extended frames, answers from inside a delivery, faults that begin in the middle, ports
without power and bus-off. Whatever a participant, a record or the load can see is compared.
"""

import random
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import can
import pytest

from axisrig.bench.bus.can import frame_hash, line, load, logs
from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.faults import Alter, Delay, Drop, Duplicate, ErrorAtBit, Swap
from axisrig.bench.bus.can.frame import Frame, frame_bits
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.journal import Journal
from axisrig.kernel.time import scheduler as scheduler_module
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

SEEDS = range(120)
END_NS = 40 * MS


def _use(monkeypatch: pytest.MonkeyPatch, native: SimpleNamespace | None) -> None:
    """Let all that is made from now on be in C, or in Python."""
    monkeypatch.setattr(line, "native_line", native.line if native else None)
    for module in (frame_hash, load, logs):
        monkeypatch.setattr(module, "native_records", native.records if native else None)
    monkeypatch.setattr(scheduler_module, "native", native.scheduler if native else None)


class Traffic:
    """Random traffic on one segment; `seen` is what everyone has seen, in order."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.numbers = random.Random(seed)
        self.seen: list[Any] = []
        self.clock = new_scheduler()
        pick = self.numbers.random
        journal = Journal(self.numbers.choice([1, 7, 2048]))
        self.hash = FrameHash(journal)
        path = folder / "x.blf"
        log = logs.open_log(path, ["bus"])
        journal.add(log.take)
        with Segment(
            "bus",
            self.numbers.choice([1_000_000, 125_000, 83_333]),
            self.clock,
            automatic_recovery=pick() < 0.7,
            journal=journal,
        ) as segment:
            self.segment = segment
            for number in range(self.numbers.randint(2, 5)):
                self._add_port(number)
            if pick() < 0.3:
                segment.observe(lambda *what: self.seen.append(("observed", *what)))
            self._plan()
            error = self._run()
            journal.drain()
            figures = segment.load()
            bits = segment.busy_bits(MS)
            changes = list(segment.state_changes)
            heard = [[*port.direct.heard] for port in segment.ports if port.direct]
            counts = [(port.tec, port.rec, port.discarded) for port in segment.ports]
        log.stop()
        self.result = (
            self.seen, self.hash.hexdigest(), self.hash.frames, figures, bits, changes, counts,
            heard, error, self.clock.now_ns, path.read_bytes(),
        )  # fmt: skip

    def _run(self) -> str:
        try:
            self.clock.run_until(END_NS)
        except ArithmeticError as error:
            return str(error)
        return ""

    def _add_port(self, number: int) -> None:
        pick = self.numbers.random
        port = self.segment.port(
            f"p{number}",
            self.numbers.choice(["fifo", "mailbox"]),
            receive_own_messages=pick() < 0.2,
        )
        if pick() < 0.5:
            network = SimNetwork(port)
            network.connect()
            for can_id in self.numbers.sample(range(0x20), 8):
                network.subscribe(can_id, self._subscriber(f"p{number}"))
        elif pick() < 0.5:
            port.attach_data(self._subscriber(f"p{number}"))
        else:
            port.attach(self._listener(f"p{number}"))

    def _subscriber(self, name: str) -> Callable[[int, Any, float], None]:
        def take(can_id: int, data: bytes | bytearray, timestamp_s: float) -> None:
            self.seen.append((name, self.clock.now_ns, can_id, bytes(data), timestamp_s))
            self._react()

        return take

    def _listener(self, name: str) -> Callable[[can.Message], None]:
        def take(message: can.Message) -> None:
            self.seen.append((name, self.clock.now_ns, str(message), message.is_rx))
            self._react()

        return take

    def _react(self) -> None:
        """Answer, or plan something, from inside a delivery."""
        choice = self.numbers.random()
        if choice < 0.15:
            self._send()
        elif choice < 0.17:
            self._disturb()
        elif choice < 0.171:
            raise ArithmeticError(f"at {self.clock.now_ns}")

    def _send(self) -> None:
        numbers, port = self.numbers, self.numbers.choice(self.segment.ports)
        data = numbers.randbytes(numbers.randint(0, 8))
        if numbers.random() < 0.3:
            data = bytes(len(data))
        choice = numbers.random()
        if choice < 0.8:
            port.send_raw(numbers.randrange(0x20), data)
        elif choice < 0.9:
            port.send_raw(numbers.randrange(0x800, 1 << 29), list(data))
        else:
            is_extended = numbers.random() < 0.5
            port.send(
                can.Message(
                    arbitration_id=numbers.randrange(0x20),
                    is_extended_id=is_extended,
                    is_remote_frame=numbers.random() < 0.5,
                    data=data,
                )
            )

    def _disturb(self) -> None:
        numbers, port = self.numbers, self.numbers.choice(self.segment.ports)
        choice = numbers.randrange(7)
        if choice == 0:
            port.power_off()
        elif choice == 1:
            port.power_on()
        elif choice == 2:
            port.force_bus_off()
        elif choice == 3:
            port.recover()
        elif choice == 4:
            port.withdraw(range(0x10))
        elif choice == 5:  # a request that is gone when the line asks for it
            port.send_raw(numbers.randrange(0x20), b"")
            port.withdraw(range(0x20))
        else:
            self.segment.add_fault(self._fault)

    def _fault(self, _frame: Frame, _port: object, attempt: int) -> Any:
        numbers = self.numbers
        if attempt > 2 or numbers.random() < 0.8:
            return None
        names = frozenset({numbers.choice(self.segment.ports).port_name})
        return numbers.choice(
            [
                ErrorAtBit(numbers.randint(1, 140)),
                ErrorAtBit(numbers.randint(1, 140), seen_by=names),
                Drop(),
                Drop(at=names),
                Alter(numbers.randbytes(len(_frame.data))),
                Delay(numbers.randint(0, 3000) * US),
                Duplicate(numbers.randint(0, 3000) * US),
                Swap(),
            ]
        )

    def _plan(self) -> None:
        share = self.numbers.choice([0.0, 0.0, 0.02, 0.1])
        for _ in range(self.numbers.randint(20, 150)):
            time_ns = self.numbers.randrange(END_NS // US) * US
            action = self._disturb if self.numbers.random() < share else self._send
            self.clock.call_at(time_ns, Phase.APPLICATION, action)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_traffic_is_the_same(
    seed: int, native: SimpleNamespace, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    results = []
    for kind in (None, native):
        _use(monkeypatch, kind)
        traffic = Traffic(seed, tmp_path)
        assert isinstance(traffic.clock, Scheduler) is (kind is None)
        results.append(traffic.result)
    python, c = results
    assert len(python[0]) > 0
    for one, other in zip(python, c, strict=True):
        assert one == other


def test_the_length_of_a_frame_is_the_same(
    native: SimpleNamespace, naive_bits: Callable[[Frame], int]
) -> None:
    numbers = random.Random(3)
    for _ in range(3000):
        extended, remote = numbers.random() < 0.5, numbers.random() < 0.2
        size = numbers.randint(0, 8)
        data = b"" if remote else numbers.randbytes(size)
        if numbers.random() < 0.3:
            data = bytes([numbers.choice([0, 255])]) * len(data)
        can_id = numbers.randrange(1 << (29 if extended else 11))
        frame = Frame(can_id, data, extended, remote, size)
        assert native.line.frame_bits(frame) == frame_bits(frame) == naive_bits(frame)


class Plans:
    """Random events that plan and cancel others; `seen` says which ran, and when."""

    def __init__(self, clock: Any, seed: int) -> None:
        self.clock, self.numbers, self.seen = clock, random.Random(seed), list[Any]()
        self.events: list[Any] = []
        for number in range(30):
            self._add(number)
        for _ in range(20):
            try:
                self._advance()
            except (ArithmeticError, RuntimeError) as error:
                self.seen.append(str(error))
            self.seen.append((clock.now_ns, clock.running))

    def _add(self, number: int) -> None:
        time_ns = self.clock.now_ns + self.numbers.randrange(50)
        phase = self.numbers.randrange(4)
        self.events.append(self.clock.call_at(time_ns, phase, lambda: self._act(number)))

    def _act(self, number: int) -> None:
        self.seen.append((self.clock.now_ns, number))
        choice = self.numbers.random()
        if choice < 0.6:
            self._add(number + 100)
        elif choice < 0.75:
            self.clock.cancel(self.numbers.choice(self.events))
        elif choice < 0.78:
            raise ArithmeticError(f"event {number}")
        elif choice < 0.8:
            self.clock.run_until(self.clock.now_ns + 1)

    def _advance(self) -> None:
        if self.numbers.random() < 0.6:
            self.clock.run_until(self.clock.now_ns + self.numbers.randrange(30))
            return
        count = len(self.seen) + self.numbers.randrange(5)
        timeout_ns = self.numbers.choice([None, 0, 10, 40])
        held = self.clock.run_while(lambda: len(self.seen) < count, timeout_ns)
        self.seen.append(held)


@pytest.mark.parametrize("seed", range(60))
def test_the_schedulers_run_the_same_events(seed: int, native: SimpleNamespace) -> None:
    assert Plans(native.scheduler.Scheduler(), seed).seen == Plans(Scheduler(), seed).seen


def test_refusals_of_the_schedulers_read_the_same(native: SimpleNamespace) -> None:
    texts = []
    for clock in (native.scheduler.Scheduler(), Scheduler()):
        clock.run_until(5)
        with pytest.raises(ValueError, match="is before now") as caught:
            clock.run_until(4)
        texts.append(str(caught.value))
        with pytest.raises(ValueError, match="is before now") as caught:
            clock.call_at(4, 0, print)
        texts.append(str(caught.value))
        with pytest.raises(RuntimeError, match="no event is pending") as failed:
            clock.run_while(lambda: True, None)
        texts.append(str(failed.value))
    assert texts[:3] == texts[3:]


@pytest.mark.parametrize(
    "bad",
    [(), (1, 2), ("x", 0, print), (1, "x", print), (1.5, 0, print)],
)
def test_wrong_arguments_are_refused(native: SimpleNamespace, bad: tuple[Any, ...]) -> None:
    clock = native.scheduler.Scheduler()
    with pytest.raises(TypeError):
        clock.call_at(*bad)
    with pytest.raises(TypeError):
        clock.cancel("x")
    with pytest.raises(TypeError):
        clock.run_while()
    clock.run_until(1)


def test_the_functions_refuse_what_is_no_frame(native: SimpleNamespace) -> None:
    wrong: list[Any] = [None, (), (1, 2, 3, 4, 5), Frame(1, b"123456789", False, False, 9)]
    for frame in wrong:
        with pytest.raises(TypeError):
            native.line.frame_bits(frame)
        with pytest.raises(TypeError):
            native.records.hash_records([(0, "bus", frame, False)], {"bus": b"\x03bus"})
    entry = (0, "bus", Frame(1, b"", False, False, 0), False)
    with pytest.raises(KeyError):
        native.records.hash_records([entry], {})
    with pytest.raises(KeyError):
        native.records.blf_objects([entry], 0, {}, bytes(24))
    with pytest.raises(ValueError, match="head"):
        native.records.blf_objects([entry], 0, {"bus": 1}, b"")
