"""The EEPROM interface to its last word, and which SyncManagers fit a drive, each alone."""

from struct import Struct
from types import SimpleNamespace
from typing import Any

import pytest
from tests.ethercat.line import OP, PREOP, SAFEOP, Line

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.description import describe
from axisrig.bench.drive.ethercat.eeprom import Eeprom, check_sum
from axisrig.bench.drive.ethercat.fitting import Fitting
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.drive.ethercat.sii import SIZE, sii_content
from axisrig.kernel.time.clock import MS, US

READ, WRITE, RELOAD, UNKNOWN, MAY = 0x0100, 0x0200, 0x0400, 0x0700, 0x0001
READS_8, BAD_SUM, REFUSED, NOT_ENABLED = 1 << 6, 1 << 11, 1 << 13, 1 << 14
LAST = SIZE // 2 - 1


@pytest.fixture
def eeprom() -> Eeprom:
    made = Eeprom(sii_content(describe(DriveProfile())))
    made.load()
    return made


def test_the_last_word_is_written_and_one_behind_it_refused(eeprom: Eeprom) -> None:
    given = b"\x34\x12" + bytes(6)
    assert eeprom.command(WRITE | MAY, LAST, given) == given
    assert (bytes(eeprom.content[-2:]), eeprom.status) == (b"\x34\x12", READS_8)
    assert eeprom.command(READ, LAST, bytes(8)) == b"\x34\x12" + b"\xff" * 6
    before = bytes(eeprom.content)
    for word in (LAST + 1, LAST + 2, 0xFFFF):
        eeprom.command(WRITE | MAY, word, given)
        assert eeprom.status == READS_8 | REFUSED
        assert eeprom.command(READ, word, bytes(8)) == b"\xff" * 8
        assert eeprom.status == READS_8
    assert bytes(eeprom.content) == before
    assert len(before) == SIZE


def test_a_write_needs_its_bit_and_a_command_its_number(eeprom: Eeprom) -> None:
    before = bytes(eeprom.content)
    eeprom.command(WRITE, 4, b"\x01\x00")
    assert eeprom.status == READS_8 | NOT_ENABLED
    eeprom.command(UNKNOWN, 4, b"\x01\x00")
    assert eeprom.status == READS_8 | REFUSED
    eeprom.command(0, 4, b"\x01\x00")
    assert (eeprom.status, bytes(eeprom.content)) == (READS_8, before)


def test_a_wrong_check_sum_is_reported_until_it_is_right_at_a_reload(eeprom: Eeprom) -> None:
    """The alias, word 4, counts with a right one only; each command goes on saying it."""
    eeprom.command(WRITE | MAY, 4, b"\x07\x00")
    assert (eeprom.status, eeprom.alias) == (READS_8, 0)  # not loaded yet
    for command in (RELOAD, READ, WRITE | MAY, 0):
        eeprom.command(command, 4, b"\x07\x00")
        assert (eeprom.status, eeprom.alias) == (READS_8 | BAD_SUM, 0)
    eeprom.command(UNKNOWN, 4, bytes(2))
    assert eeprom.status == READS_8 | BAD_SUM | REFUSED
    eeprom.command(WRITE | MAY, 7, bytes((check_sum(eeprom.content), 0)))
    assert eeprom.status == READS_8 | BAD_SUM
    eeprom.command(RELOAD, 0, bytes(8))
    assert (eeprom.status, eeprom.alias) == (READS_8, 7)
    eeprom.command(WRITE | MAY, 5, b"\x01\x00")
    eeprom.command(RELOAD, 0, bytes(8))
    assert (eeprom.status, eeprom.alias) == (READS_8 | BAD_SUM, 0)


def test_the_check_sum_is_that_of_words_0_to_6() -> None:
    """CRC 8 of polynomial 07, start FF: of no bytes but zeros, bit by bit."""
    register = 0xFF
    for _ in range(8 * 14):
        register = (register << 1 ^ 0x07 if register & 0x80 else register << 1) & 0xFF
    assert check_sum(bytes(14)) == check_sum(bytes(14) + b"\xff" * 10) == register
    assert check_sum(bytes(13) + b"\x01") != register


class Fit:
    """A drive with SyncManagers as its EEPROM has them; `wrong` after a change of one."""

    def __init__(self, outputs: int, inputs: int) -> None:
        self.description = describe(DriveProfile())
        self.managers = [
            SimpleNamespace(start=m.start, length=m.length, control=m.control, is_enabled=True)
            for m in self.description.managers
        ]
        self.managers[2].length, self.managers[3].length = outputs, inputs
        for number, size in ((2, outputs), (3, inputs)):
            self.managers[number].is_enabled = size > 0

        def layout(size: int) -> Any:
            return SimpleNamespace(codec=Struct(f"{size}s"))

        managers: Any = self.managers
        data: Any = SimpleNamespace(outputs=layout(outputs), inputs=layout(inputs))
        self.made = Fitting(self.description, managers, data)


@pytest.mark.parametrize(("outputs", "inputs"), [(8, 12), (0, 12), (8, 0), (0, 0)])
def test_what_carries_something_is_on_and_what_carries_nothing_off(
    outputs: int, inputs: int
) -> None:
    fit = Fit(outputs, inputs)
    assert fit.made.wrong() is None
    for number, name, size in ((2, "INVALID_OUTPUTS", outputs), (3, "INVALID_INPUTS", inputs)):
        manager = fit.managers[number]
        manager.is_enabled = not manager.is_enabled
        assert fit.made.wrong() == name
        manager.is_enabled = not manager.is_enabled
        if size:
            for key, change in (("length", 1), ("length", -1), ("control", 0x04), ("control", 2)):
                before = getattr(manager, key)
                setattr(manager, key, before + change if key == "length" else before ^ change)
                assert fit.made.wrong() == name
                setattr(manager, key, before)
            manager.start += 0x100  # it may be anywhere
            manager.control ^= 0x20  # the interrupt is of the slave alone
        assert fit.made.wrong() is None


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize(
    ("key", "change"), [("start", 2), ("length", 1), ("control", 0x04), ("is_enabled", 1)]
)
def test_both_mailboxes_are_as_the_eeprom_has_them(number: int, key: str, change: int) -> None:
    fit = Fit(8, 12)
    assert fit.made.has_mailbox()
    manager = fit.managers[number]
    setattr(manager, key, getattr(manager, key) ^ change)
    assert not fit.made.has_mailbox()
    assert fit.made.wrong() is None


def test_a_sample_gives_way_to_the_next_cycle() -> None:
    """700 us after each outputs; where these come each 500 us, only the last one is sampled so."""
    line = Line(
        motion=lambda time_s: 0.1 * time_s, settings=[SlaveSettings(serial=1, sample_ns=700 * US)]
    )
    line.op()
    line.wait(5 * MS)
    samples: list[int] = []
    refresh = line.drive.servo.refresh

    def note(now_ns: int, *, is_apart: bool = False) -> None:
        if is_apart:
            samples.append(now_ns)
        refresh(now_ns, is_apart=is_apart)

    line.drive.servo.refresh = note  # type: ignore[method-assign]
    for _ in range(4):
        line.cycle()
        line.wait(500 * US)
    assert samples == []
    line.wait(2 * MS)
    (only_ns,) = samples
    latest = line.drive.managers[3].latest
    shown_um = int.from_bytes(latest[2:6], "little", signed=True) / 104.8576
    assert shown_um == pytest.approx(0.1 * only_ns * 1e-3, abs=0.02)


@pytest.mark.parametrize("serial", [0, 7, 0xFFFF_FFFF])
def test_the_identity_has_the_serial_number_of_the_slave(serial: int) -> None:
    """1018:4 and word 14 of the EEPROM; it stays over power."""
    line = Line(settings=[SlaveSettings(serial=serial)])
    for _ in range(2):
        line.wait(1000)
        line.preop()
        assert int.from_bytes(line.sdo_read(0x1018, 4), "little") == serial
        assert int.from_bytes(line.drive.eeprom.content[28:32], "little") == serial
        line.drive.power_off()
        line.drive.power_on()


@pytest.mark.parametrize("state", [SAFEOP, PREOP])
def test_nobody_is_missed_after_op_was_left_by_wish(state: int) -> None:
    """0440 says that nothing is watched, 0442 counts nothing, and no error comes later."""
    line = Line()
    line.op()
    line.cycle()
    assert line.read(0x0440, 2) == 1
    assert line.ask(state) == (state, 0)
    line.wait(500 * MS)
    assert (line.al(), line.read(0x0440, 2), line.read(0x0442, 1)) == ((state, 0), 0, 0)
    if state == SAFEOP:
        line.cycle()
        line.wait(500 * MS)  # outputs in SAFEOP are none that anybody waits for
        assert (line.al(), line.read(0x0442, 1)) == ((SAFEOP, 0), 0)
        line.cycle()
        line.ask(OP)
        line.cycle()
        line.wait(500 * MS)
        assert (line.al()[0], line.read(0x0442, 1)) == (SAFEOP | 0x10, 1)
