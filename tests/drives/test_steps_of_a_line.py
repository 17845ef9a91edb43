"""The start-up of an EtherCAT line step by step: what is written to each slave, and what stops it.

The slaves answer by hand. Registers and layouts are those of ETG.1000.4: a SyncManager is start,
length, control, status, activation (0800 and following), an FMMU logical start, length, bits 0 to
7, physical start, bit, kind (1 read, 2 write), activation (0600 and following).
"""

import struct
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.eeprom import Described
from axisrig.kernel.drives.ethercat.frames import Answer
from axisrig.kernel.drives.ethercat.image import Place
from axisrig.kernel.drives.ethercat.line_start import LineStart, Starting
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPlaces
from axisrig.kernel.drives.ethercat.settings import LineSettings, RegisterInputs, SlaveSettings
from axisrig.kernel.drives.ethercat.steps import DriveSteps, Pause, Steps
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.ethercat.tables import AlState, address_of
from axisrig.kernel.time.clock import MS

FPRD, FPWR, BRD, BWR, APWR = 4, 5, 7, 8, 2
AL_CONTROL, AL_STATUS, FMMU, SYNC_MANAGER, STATION = 0x120, 0x130, 0x600, 0x800, 0x10
INIT, PREOP, SAFEOP, OP, ERROR = 1, 2, 4, 8, 0x10
TIMEOUT_NS = 20 * MS
SILENT = None
BOX = MailboxPlaces(0x1000, 128, 0x1080, 192)
MANAGERS = ((0x1000, 0x26), (0x1080, 0x22), (0x1100, 0x64), (0x1180, 0x20))


class Drive(DriveSteps):
    """Notes what the line asks of the family."""

    def __init__(self, bench: "Bench", name: str) -> None:
        self._log, self._name = bench.log, name

    def _note(self, what: str) -> Steps:
        self._log.append((self._name, what))
        yield from ()

    def in_preop(self) -> Steps:
        yield from self._note("in_preop")

    def before_safeop(self) -> Steps:
        yield from self._note("before_safeop")

    def before_op(self) -> Steps:
        yield from self._note("before_op")

    def not_in_op(self) -> None:
        self._log.append((self._name, "not_in_op"))

    def in_op(self) -> Steps:
        yield from self._note("in_op")


class Bench:
    """A line with the drives X and Y and a terminal T behind them.

    shows(station, look): AL status and code, or SILENT. log: what happens, in its order.
    """

    def __init__(self) -> None:
        self.clock: Any = SimpleNamespace(now_ns=0)
        self.log: list[tuple[Any, ...]] = []
        self.ended: dict[str, Alarm | None] = {}
        self.state: dict[int, int] = {}
        self.shows: Callable[[int, int], tuple[int, int] | None] | None = None
        self.looks = self.found = 0
        line = LineSettings(name="ec1", period_ns=MS, state_timeout_ns=TIMEOUT_NS)
        image = SimpleNamespace(
            places=[Place(0, 6, 12, 8, 28), Place(6, 6, 20, 8, 29)], registers=[30]
        )
        self.master: Any = SimpleNamespace(
            line=line, image=image, transactions=None, stop=lambda: self.log.append(("stop",))
        )
        self.slaves = [self._slave("X", 1), self._slave("Y", 2), self._slave("T", 3)]
        self.start = LineStart(self.master, self.clock, self.slaves)

    def _slave(self, axis: str, node: int) -> Starting:
        if axis == "T":
            settings = RegisterInputs(
                axis=axis, node_id=node, first=0x9A0, size=16, writes=(("ACTIVATION", b"\1"),)
            )
            return Starting(settings, None, None)
        box: Any = SimpleNamespace(places=None)
        end = lambda alarm: self.ended.update({axis: alarm})  # noqa: E731
        slave = SlaveSettings(axis=axis, increments_per_mm=1000.0, node_id=node)
        return Starting(slave, box, Drive(self, axis), end)

    def run(self, steps: Steps) -> Any:
        """Run a generator to its end, with the answers of the slaves."""
        answer = None
        while True:
            try:
                step: Any = steps.send(answer)
            except StopIteration as end:
                return end.value
            if isinstance(step, Pause):
                self.clock.now_ns += step.time_ns
                answer = None
            else:
                answer = self._answer(step.datagrams[0])

    def _answer(self, asked: Any) -> list[Answer] | None:
        command, low, register = int(asked.command), asked.address & 0xFFFF, asked.address >> 16
        if command in (FPWR, BWR, APWR):
            self.log.append((command, low, register, asked.data))
            if register == AL_CONTROL:
                self.state[low] = asked.data[0]
            return [Answer(b"", 1)]
        if command == BRD:
            return None if not self.found else [Answer(bytes(1), self.found)]
        assert (command, register, len(asked.data)) == (FPRD, AL_STATUS, 6)
        self.looks += 1
        shown = self.shows(low, self.looks) if self.shows else (self.state[low], 0)
        if shown is SILENT:
            return [Answer(bytes(6), 0)]
        return [Answer(bytes((shown[0], 0, 0, 0)) + shown[1].to_bytes(2, "little"), 1)]

    def refused(self, steps: Steps) -> Alarm:
        with pytest.raises(Alarm) as caught:
            self.run(steps)
        return caught.value


@pytest.fixture
def bench() -> Bench:
    return Bench()


# States


@pytest.mark.parametrize("slave", [0, 1, 2])
@pytest.mark.parametrize("looks", [1, 2, 20])
def test_a_state_is_asked_for_once_and_looked_at_each_ms(
    bench: Bench, slave: int, looks: int
) -> None:
    bench.shows = lambda _station, look: (PREOP, 0) if look >= looks else (INIT, 0)
    bench.run(bench.start._change(bench.slaves[slave], AlState.PREOP))
    assert bench.log == [(FPWR, 1001 + slave, AL_CONTROL, bytes((PREOP, 0)))]
    assert (bench.looks, bench.clock.now_ns) == (looks, (looks - 1) * MS)


@pytest.mark.parametrize(
    ("shown", "found"), [((INIT, 0), "INIT"), ((SAFEOP, 0), "SAFEOP"), (SILENT, "no answer")]
)
def test_a_state_that_does_not_come_is_an_alarm_at_the_end_of_its_time(
    bench: Bench, shown: tuple[int, int] | None, found: str
) -> None:
    bench.shows = lambda *_: shown
    alarm = bench.refused(bench.start._wait(bench.slaves[1], AlState.PREOP))
    values = {"axis": "Y", "position": 2, "state": "PREOP", "found": found, "ms": 20}
    assert (alarm.id, alarm.values) == (900704, values)
    assert bench.clock.now_ns == TIMEOUT_NS


def test_what_a_slave_has_shown_last_is_in_the_alarm_of_one_that_has_gone_silent(
    bench: Bench,
) -> None:
    bench.shows = lambda _station, look: (INIT, 0) if look < 3 else SILENT
    alarm = bench.refused(bench.start._wait(bench.slaves[0], AlState.PREOP))
    assert (alarm.id, alarm.values["found"]) == (900704, "INIT")


def test_a_state_that_is_refused_is_an_alarm_at_once(bench: Bench) -> None:
    bench.shows = lambda *_: (PREOP | ERROR, 0x001E)
    alarm = bench.refused(bench.start._wait(bench.slaves[0], AlState.SAFEOP))
    assert (alarm.id, alarm.values["state"], alarm.values["found"]) == (
        900705, "SAFEOP", "PREOP with error",
    )  # fmt: skip
    assert str(alarm.values["code"]).startswith("0x001E")
    assert (bench.looks, bench.clock.now_ns) == (1, 0)


def test_an_error_of_before_is_no_refusal_of_init(bench: Bench) -> None:
    """It is acknowledged by the order for INIT, and the slave may take its time."""
    bench.shows = lambda _station, look: (INIT, 0) if look > 3 else (SAFEOP | ERROR, 0x001B)
    bench.run(bench.start._wait(bench.slaves[0], AlState.INIT))
    assert bench.looks == 4


def test_the_family_has_its_turn_before_and_after_each_state(bench: Bench) -> None:
    x = bench.slaves[0]
    for phase in (bench.start._set_up, bench.start._to_safeop, bench.start._to_op):
        bench.run(phase(x))
    bench.run(bench.start._in_op(x))
    assert bench.log == [
        ("X", "in_preop"), ("X", "before_safeop"), (FPWR, 1001, AL_CONTROL, bytes((SAFEOP, 0))),
        ("X", "before_op"), (FPWR, 1001, AL_CONTROL, bytes((OP, 0))), ("X", "in_op"),
    ]  # fmt: skip


@pytest.mark.parametrize(("refused", "calls"), [(SAFEOP, 0), (OP, 1)])
def test_a_family_hears_of_a_slave_that_does_not_reach_op_and_of_no_other_state(
    bench: Bench, refused: int, calls: int
) -> None:
    bench.shows = lambda *_: (PREOP | ERROR, 0x001E)
    phase = bench.start._to_safeop if refused == SAFEOP else bench.start._to_op
    assert bench.refused(phase(bench.slaves[1])).id == 900705
    assert bench.log.count(("Y", "not_in_op")) == calls
    assert ("X", "not_in_op") not in bench.log


def test_a_terminal_without_a_drive_goes_the_same_way_without_a_family(bench: Bench) -> None:
    terminal = bench.slaves[2]
    for phase in (bench.start._set_up, bench.start._to_safeop, bench.start._to_op):
        bench.run(phase(terminal))
    bench.run(bench.start._in_op(terminal))
    assert bench.log == [
        (FPWR, 1003, 0x981, b"\1"), (FPWR, 1003, AL_CONTROL, bytes((SAFEOP, 0))),
        (FPWR, 1003, AL_CONTROL, bytes((OP, 0))),
    ]  # fmt: skip


# The line as a whole


@pytest.mark.parametrize(("found", "alarm_id"), [(3, None), (2, 900701), (4, 900701), (0, 900700)])
def test_the_slaves_of_a_line_are_counted(bench: Bench, found: int, alarm_id: int | None) -> None:
    bench.found = found
    alarm = bench.run(bench.start._find())
    assert (alarm.id if alarm else None) == alarm_id
    if alarm_id == 900701:
        assert alarm.values == {"segment": "ec1", "found": found, "expected": 3}


def test_a_line_is_reset_as_a_whole_and_each_place_gets_its_address(bench: Bench) -> None:
    """APWR with the places 0, -1, -2: one more with each slave that a datagram passes."""
    bench.run(bench.start._reset())
    assert bench.log[0] == (BWR, 0, AL_CONTROL, bytes((INIT | ERROR, 0)))
    assert (BWR, 0, FMMU, bytes(256)) in bench.log
    assert (BWR, 0, SYNC_MANAGER, bytes(128)) in bench.log
    assert (BWR, 0, 0x981, b"\0") in bench.log
    assert [each for each in bench.log if each[0] == APWR] == [
        (APWR, place, STATION, station.to_bytes(2, "little"))
        for place, station in ((0, 1001), (0xFFFF, 1002), (0xFFFE, 1003))
    ]


# Mailbox and process data


def described(managers: tuple[tuple[int, int], ...] = MANAGERS) -> Described:
    return Described((2, 3, 4, 5), BOX, managers)


def manager(start: int, length: int, control: int) -> bytes:
    return struct.pack("<HHBBBB", start, length, control, 0, 1, 0)


def fmmu(logical: int, length: int, start: int, kind: int) -> bytes:
    return struct.pack("<IHBBHBBBxxx", 0x10000 + logical, length, 0, 7, start, 0, kind, 1)


def test_the_mailbox_has_the_first_two_managers_with_the_places_of_the_eeprom(
    bench: Bench,
) -> None:
    box: Any = bench.slaves[1].mailbox
    bench.run(bench.start._open_mailbox(1002, box, described()))
    data = manager(0x1000, 128, 0x26) + manager(0x1080, 192, 0x22)
    assert bench.log == [(FPWR, 1002, SYNC_MANAGER, data)]
    assert box.places == BOX


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("more", [(), ((0x1200, 0x20),)])
def test_process_data_have_the_third_and_fourth_manager_and_each_drive_its_own_place(
    bench: Bench, number: int, more: tuple[tuple[int, int], ...]
) -> None:
    """Outputs of both, inputs of both, then the state of each mailbox (080D: SyncManager 1)."""
    slave, station = bench.slaves[number], 1001 + number
    slave.described = described((*MANAGERS, *more))
    bench.run(bench.start._map(slave))
    managers = manager(0x1100, 6, 0x64) + manager(0x1180, 8, 0x20)
    units = fmmu(6 * number, 6, 0x1100, 2) + fmmu(12 + 8 * number, 8, 0x1180, 1)
    units += fmmu(28 + number, 1, 0x080D, 1)
    assert bench.log == [(FPWR, station, SYNC_MANAGER + 16, managers), (FPWR, station, FMMU, units)]


def test_a_terminal_has_its_registers_in_the_image_and_nothing_else(bench: Bench) -> None:
    bench.slaves[2].described = described(())
    bench.run(bench.start._map(bench.slaves[2]))
    assert bench.log == [(FPWR, 1003, FMMU, fmmu(30, 16, 0x9A0, 1))]


def test_each_terminal_has_its_own_place_in_the_image(bench: Bench) -> None:
    """Places of terminals come after those of all drives, in the order of the line."""
    bench.master.image.registers = [30, 46, 50]
    for node, first, size in ((4, 0x1000, 4), (5, 0x9A8, 8)):
        settings = RegisterInputs(axis=f"T{node}", node_id=node, first=first, size=size, writes=())
        bench.slaves.append(Starting(settings, None, None))
    bench.start = LineStart(bench.master, bench.clock, bench.slaves)
    for slave in bench.slaves[2:]:
        slave.described = described(())
        bench.run(bench.start._map(slave))
    assert bench.log == [
        (FPWR, 1003, FMMU, fmmu(30, 16, 0x9A0, 1)),
        (FPWR, 1004, FMMU, fmmu(46, 4, 0x1000, 1)),
        (FPWR, 1005, FMMU, fmmu(50, 8, 0x9A8, 1)),
    ]


def test_the_line_begins_once_whoever_begins(bench: Bench) -> None:
    """Each drive has its own end; the steps of the line are taken by the first of them."""
    begun: list[Any] = []
    start: Any = bench.start
    start._stepper = SimpleNamespace(run=begun.append)
    ends: list[tuple[str, Alarm | None]] = []
    for number, axis in enumerate("XY"):
        bench.start.begin(number, lambda alarm, axis=axis: ends.append((axis, alarm)))
    assert len(begun) == 1
    alarm = Alarm(900701, segment="ec1", found=1, expected=3)
    start._fail(bench.slaves[1], alarm)
    start._fail(bench.slaves[0], alarm)
    assert ends == [("Y", alarm), ("X", alarm)]


def test_a_terminal_gets_all_of_its_registers_in_their_order(bench: Bench) -> None:
    """Of a terminal that stamps: how each of its two inputs latches (09A8 and 09A9)."""
    writes = (("LATCH1_CONTROL", b"\1"), ("LATCH0_CONTROL", b"\3"), ("ACTIVATION", b"\0"))
    for count in range(len(writes) + 1):
        bench.log.clear()
        bench.slaves[2].settings = RegisterInputs(
            axis="T", node_id=3, first=0x9A0, size=16, writes=writes[:count]
        )
        bench.run(bench.start._set_up(bench.slaves[2]))
        assert bench.log == [(FPWR, 1003, address_of(name), data) for name, data in writes[:count]]
    assert [address_of(name) for name, _ in writes[:2]] == [0x9A9, 0x9A8]


# What fails


def an_alarm() -> Alarm:
    return Alarm(900706, axis="Y", position=2)


def test_a_slave_that_fails_leaves_the_others_on_their_way(bench: Bench) -> None:
    def failing() -> Steps:
        raise an_alarm()
        yield

    bench.run(bench.start._guarded(bench.slaves[1], failing()))
    assert [slave.settings.axis for slave in bench.start._alive] == ["X", "T"]
    assert [(axis, alarm.id) for axis, alarm in bench.ended.items() if alarm] == [("Y", 900706)]
    bench.start._end()
    assert bench.ended["X"] is None
    assert bench.log == []  # cyclic frames go on for X


def test_a_terminal_that_fails_is_that_of_the_first_drive_and_reported_once(bench: Bench) -> None:
    for _ in range(2):
        bench.start._fail(bench.slaves[2], an_alarm())
    assert list(bench.ended) == ["X"]
    assert [slave.settings.axis for slave in bench.start._alive] == ["Y"]


def test_a_line_without_a_drive_that_goes_on_sends_no_more(bench: Bench) -> None:
    for slave in bench.slaves[:2]:
        bench.start._fail(slave, an_alarm())
    bench.start._end()
    assert bench.log == [("stop",)]
    assert all(bench.ended.values())
