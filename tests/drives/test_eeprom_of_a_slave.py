"""The EEPROM of a slave as the start-up reads it by its registers (ETG.1000.4, SII of ETG.2010)."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from tests.drives.test_steps_of_a_line import BOX, FPRD, FPWR, MANAGERS

from axisrig.kernel.drives.ethercat.eeprom import (
    ATTEMPTS,
    POLLS_MAX,
    WAIT_NS,
    Described,
    EepromError,
    read_eeprom,
)
from axisrig.kernel.drives.ethercat.frames import Answer
from axisrig.kernel.drives.ethercat.line_start import LineStart, Starting
from axisrig.kernel.drives.ethercat.settings import LineSettings, RegisterInputs, SlaveSettings
from axisrig.kernel.drives.ethercat.steps import Pause, Steps
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

CONFIGURATION, CONTROL, ADDRESS, DATA = 0x500, 0x502, 0x504, 0x508
AL_CONTROL, AL_STATUS, SYNC_MANAGER = 0x120, 0x130, 0x800
READ, BUSY, NO_ACKNOWLEDGE, EIGHT_BYTES = 0x0100, 0x8000, 0x2000, 0x0040
IDENTITY = (0x000001FE, 0x12345678, 0x00020001, 0xFFFFFFFE)
STRINGS, MANAGER = 10, 41


def words(managers: tuple[tuple[int, int], ...] = MANAGERS, *, ends: bool = True) -> dict[int, int]:
    """An EEPROM: identity at 8, mailbox at 0x18, categories from 0x40 on."""
    found = {8 + n: IDENTITY[n // 2] >> 16 * (n % 2) & 0xFFFF for n in range(8)}
    found |= dict(enumerate((BOX.out_start, BOX.out_size, BOX.in_start, BOX.in_size), 0x18))
    at = 0x40
    for kind, body in (
        (STRINGS, [0x1111] * 3),
        (MANAGER, [w for start, control in managers for w in (start, 0, 0xAA00 | control, 0x0101)]),
    ):
        for word in (kind, len(body), *body):
            found[at] = word
            at += 1
    if ends:
        found[at] = 0xFFFF
    return found


class Slave:
    """Its registers; log: what is written to them. busy: looks until it is ready, each time."""

    def __init__(self, eeprom: dict[int, int], *, size: int = 4, busy: int = 0) -> None:
        self.eeprom, self.size, self.busy = eeprom, size, busy
        self.fails = 0  # so many reads are not acknowledged
        self.lost = 0  # so many answers with data do not come
        self.log: list[tuple[int, bytes]] = []
        self.reads: list[int] = []
        self.now_ns = 0
        self._address = self._looks = self._state = 0

    def run(self, steps: Steps) -> Any:
        answer = None
        while True:
            try:
                step: Any = steps.send(answer)
            except StopIteration as end:
                return end.value
            answer = None
            if isinstance(step, Pause):
                self.now_ns += step.time_ns
            else:
                answer = [self._answer(step.datagrams[0])]

    def _answer(self, asked: Any) -> Answer:
        assert asked.address & 0xFFFF == 1001
        register = asked.address >> 16
        if int(asked.command) == FPWR:
            self._write(register, asked.data)
            return Answer(asked.data, 1)
        assert int(asked.command) == FPRD
        return next(self._read(register, len(asked.data)))

    def _write(self, register: int, data: bytes) -> None:
        self.log.append((register, data))
        if register == ADDRESS:
            self._address = int.from_bytes(data, "little")
        elif register == CONTROL:
            assert int.from_bytes(data, "little") == READ
            self._looks = self.busy
            self.reads.append(self._address)
        elif register == AL_CONTROL:
            self._state = data[0]

    def _read(self, register: int, size: int) -> Iterator[Answer]:
        if register == AL_STATUS:
            yield Answer(bytes((self._state,)) + bytes(size - 1), 1)
        elif register == CONTROL:
            state = EIGHT_BYTES if self.size == 8 else 0
            if self._looks:
                self._looks -= 1
                state |= BUSY
            elif self.fails:
                self.fails -= 1
                state |= NO_ACKNOWLEDGE
            yield Answer(state.to_bytes(2, "little"), 1)
        assert (register, size) == (DATA, self.size)
        found = [self.eeprom.get(self._address + n, 0x5555) for n in range(size // 2)]
        data = b"".join(word.to_bytes(2, "little") for word in found)
        self.lost -= 1
        yield Answer(data, int(self.lost < 0))


@pytest.mark.parametrize("size", [4, 8])
@pytest.mark.parametrize("busy", [0, 3])
def test_identity_mailbox_and_managers_are_read_word_by_word(size: int, busy: int) -> None:
    """Slaves give four or eight bytes at a time; no word is asked for twice."""
    slave = Slave(words(), size=size, busy=busy)
    found = slave.run(read_eeprom(1001))
    assert found == Described(IDENTITY, BOX, MANAGERS)
    assert slave.log[:2] == [(CONFIGURATION, b"\2"), (CONFIGURATION, b"\0")]
    assert len(set(slave.reads)) == len(slave.reads)
    assert slave.now_ns == busy * WAIT_NS * len(slave.reads)


@pytest.mark.parametrize(
    ("eeprom", "managers"),
    [
        (words(MANAGERS[:2]), MANAGERS[:2]), (words(()), ()),
        ({k: v for k, v in words().items() if k < 0x40} | {0x40: 0xFFFF}, ()),
    ],
)  # fmt: skip
def test_an_eeprom_may_describe_fewer_managers_or_none(
    eeprom: dict[int, int], managers: tuple[tuple[int, int], ...]
) -> None:
    assert Slave(eeprom).run(read_eeprom(1001)).managers == managers


def test_categories_without_an_end_are_not_read_for_ever() -> None:
    """Each further one is as long as its words say: the walk leaves the memory."""
    found = Slave({k: v for k, v in words().items() if k < 0x40}).run(read_eeprom(1001))
    assert found.managers == ()


@pytest.mark.parametrize("trouble", ["fails", "lost"])
def test_a_word_that_did_not_come_is_asked_for_again(trouble: str) -> None:
    slave = Slave(words())
    setattr(slave, trouble, ATTEMPTS - 1)
    assert slave.run(read_eeprom(1001)).identity == IDENTITY
    assert slave.reads[:ATTEMPTS] == [8] * ATTEMPTS


@pytest.mark.parametrize(
    ("trouble", "number", "reason", "reads"),
    [
        ("fails", ATTEMPTS, "does not acknowledge", ATTEMPTS),
        ("lost", ATTEMPTS, "does not acknowledge", ATTEMPTS), ("busy", POLLS_MAX, "stays busy", 1),
    ],
)  # fmt: skip
def test_an_eeprom_that_gives_nothing_is_an_error(
    trouble: str, number: int, reason: str, reads: int
) -> None:
    slave = Slave(words())
    setattr(slave, trouble, number)
    with pytest.raises(EepromError, match=reason):
        slave.run(read_eeprom(1001))
    assert slave.reads == [8] * reads
    if trouble == "busy":
        assert slave.now_ns == POLLS_MAX * WAIT_NS


# On the way to PREOP


def starting(**settings: Any) -> tuple[LineStart, Starting]:
    box: Any = SimpleNamespace(places=None)
    slave = Starting(
        SlaveSettings(axis="Z", increments_per_mm=1000.0, node_id=1, **settings), box, None
    )
    master: Any = SimpleNamespace(line=LineSettings(name="ec1", period_ns=MS), transactions=None)
    clock: Any = SimpleNamespace(now_ns=0)
    return LineStart(master, clock, [slave]), slave


def test_a_slave_goes_to_preop_once_its_mailbox_is_open_and_the_eeprom_its_own() -> None:
    line, slave = starting(identity={sub: IDENTITY[sub - 1] for sub in (1, 2, 3, 4)})
    registers = Slave(words())
    registers._state = 1
    registers.run(line._to_preop(slave))
    written = [(register, data) for register, data in registers.log if register < CONFIGURATION]
    assert written == [(AL_CONTROL, b"\2\0")]
    after = [register for register, _ in registers.log][-3:]
    assert after == [SYNC_MANAGER, CONFIGURATION, AL_CONTROL]
    assert registers.log[-2] == (CONFIGURATION, b"\1")
    assert slave.described == Described(IDENTITY, BOX, MANAGERS)


@pytest.mark.parametrize("sub", [1, 2, 3, 4])
def test_another_identity_is_an_alarm_with_both(sub: int) -> None:
    """Sub-indices of 1018: vendor, product, revision, serial; each is compared with its own."""
    expected = dict(enumerate(IDENTITY, 1))
    expected[sub] ^= 0x10
    line, slave = starting(identity=expected)
    registers = Slave(words())
    registers._state = 1
    with pytest.raises(Alarm) as caught:
        registers.run(line._to_preop(slave))
    alarm = caught.value
    assert (alarm.id, alarm.values["what"]) == (900703, f"0x1018:{sub}")
    assert alarm.values["found"] == f"0x{IDENTITY[sub - 1]:X}"
    assert alarm.values["expected"] == f"0x{IDENTITY[sub - 1] ^ 0x10:X}"
    assert all(register != AL_CONTROL for register, _ in registers.log)


def test_a_drive_without_process_data_in_its_eeprom_is_an_alarm() -> None:
    line, slave = starting()
    registers = Slave(words(MANAGERS[:3]))
    registers._state = 1
    with pytest.raises(Alarm) as caught:
        registers.run(line._to_preop(slave))
    assert (caught.value.id, str(caught.value.values["reason"])) == (
        900702, "it describes 3 SyncManagers",
    )  # fmt: skip


@pytest.mark.parametrize("sub", [1, 2, 3, 4])
@pytest.mark.parametrize("has_box", [True, False])
def test_an_identity_of_0_is_one_too(sub: int, has_box: bool) -> None:
    """The vendor of our own slaves is 0: another slave in their place is found by it."""
    line, slave = starting(identity={sub: 0})
    if not has_box:
        slave = Starting(
            RegisterInputs(axis="T", node_id=1, first=0, size=1, identity={sub: 0}), None, None
        )
    registers = Slave(words())
    registers._state = 1
    with pytest.raises(Alarm) as caught:
        registers.run(line._to_preop(slave))
    values = caught.value.values
    assert (caught.value.id, values["what"], values["expected"]) == (
        900703, f"0x1018:{sub}", "0x0"
    )  # fmt: skip
    assert values["axis"] == ("Z" if has_box else "T")


@pytest.mark.parametrize("count", [0, 2, 4])
def test_a_terminal_without_a_mailbox_may_describe_any_number_of_managers(count: int) -> None:
    """It goes to PREOP, and no SyncManager is written."""
    line, _ = starting()
    terminal = Starting(
        RegisterInputs(axis="T", node_id=1, first=0, size=1, identity={1: IDENTITY[0]}), None, None
    )
    registers = Slave(words(MANAGERS[:count]))
    registers._state = 1
    registers.run(line._to_preop(terminal))
    assert (AL_CONTROL, b"\2\0") in registers.log
    assert all(register != SYNC_MANAGER for register, _ in registers.log)
    assert terminal.described == Described(IDENTITY, BOX, MANAGERS[:count])
