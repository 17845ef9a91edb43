"""LSS without a bus (CiA 305): the fast scan bit by bit, and the silence of a new bit rate."""

import struct
from collections.abc import Sequence

import pytest

from axisrig.bench.drive.canopen.lss import UNCONFIGURED, LssSettings, LssSlave
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

IDENTIFIED = "4f00000000000000"
CONFIRM = 0x80
IDENTITY = (0x1A2, 402, 0x10000, 3)


class Slave:
    """A slave with what it has sent, and the bit rates that it was given with their ms."""

    def __init__(
        self,
        identity: Sequence[int] = IDENTITY,
        *,
        active: int = UNCONFIGURED,
        pending: int = UNCONFIGURED,
        changes_rate: bool = True,
    ) -> None:
        self.clock = new_scheduler()
        self.active = active
        self.settings = LssSettings(pending, pending)
        self.sent: list[str] = []
        self.rates: list[tuple[float, int | None]] = []
        self.lss = LssSlave(
            self.settings, self.clock, lambda: tuple(identity), lambda: self.active,
            lambda data: self.sent.append(data.hex()), lambda: None,
            self._rate if changes_rate else None,
        )  # fmt: skip

    def _rate(self, bit_s: int | None) -> None:
        self.rates.append((self.clock.now_ns / MS, bit_s))

    def ask(self, *data: int) -> list[str]:
        self.sent.clear()
        self.lss.on_request(0x7E5, bytearray(bytes(data).ljust(8, b"\0")), 0.0)
        return list(self.sent)

    def scan(self, number: int, bit: int, position: int, following: int) -> bool:
        answers = self.ask(0x51, *struct.pack("<I", number), bit, position, following)
        assert answers in ([], [IDENTIFIED])
        return bool(answers)

    @property
    def is_configuring(self) -> bool:
        return bool(self.ask(0x5E))


def fast_scan(slaves: Sequence[Slave]) -> list[int] | None:
    """Do what a master does: each number from bit 31 down, 0 first; None where nobody is there."""

    def asked(*words: int) -> bool:
        return sum(slave.scan(*words) for slave in slaves) > 0

    if not asked(0, CONFIRM, 0, 0):
        return None
    found = []
    for position in range(4):
        number = 0
        for bit in range(31, -1, -1):
            if not asked(number, bit, position, position):
                number |= 1 << bit
        assert asked(number, 0, position, (position + 1) % 4)
        found.append(number)
    return found


@pytest.mark.parametrize(
    "identity",
    [
        IDENTITY,
        (0, 0, 0, 0),
        (0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF),
        (0x80000001, 0x7FFFFFFE, 1, 0x80000000),
        (1, 2, 3, 4),
    ],
)
def test_a_fast_scan_finds_each_bit_of_an_identity(identity: tuple[int, ...]) -> None:
    slave = Slave(identity)
    assert fast_scan([slave]) == list(identity)
    assert slave.is_configuring
    assert fast_scan([slave]) is None  # whoever is found takes no part any more
    assert slave.ask(0x11, 9) == ["1100000000000000"]


@pytest.mark.parametrize("place", range(4))
def test_a_fast_scan_finds_two_slaves_one_after_the_other(place: int) -> None:
    """The smaller number first, wherever they differ; only the one that is found is meant."""
    other = tuple(value + (at == place) for at, value in enumerate(IDENTITY))
    slaves = [Slave(other), Slave(IDENTITY)]
    assert fast_scan(slaves) == list(IDENTITY)
    assert [slave.is_configuring for slave in slaves] == [False, True]
    slaves[1].ask(0x11, 9)
    assert fast_scan(slaves) == list(other)
    assert fast_scan(slaves) is None


@pytest.mark.parametrize(("active", "pending"), [(3, 3), (3, UNCONFIGURED), (UNCONFIGURED, 9)])
def test_a_slave_with_a_number_or_a_pending_one_takes_no_part(active: int, pending: int) -> None:
    slave = Slave(active=active, pending=pending)
    assert fast_scan([slave]) is None
    assert slave.ask(0x4C) == []
    assert Slave().ask(0x4C) == ["5000000000000000"]


@pytest.mark.parametrize(
    ("words", "hit"),
    [
        ((0x1A2, 0, 0, 0), True),
        ((0x1A3, 0, 0, 0), False),
        ((0x1A3, 1, 0, 0), True),  # down to bit 1 alone
        ((0x1A0, 1, 0, 0), False),
        ((0x5A2, 10, 0, 0), False),
        ((0x5A2, 11, 0, 0), True),
        ((0x1A2, 31, 0, 3), True),
        ((0x1A2, 32, 0, 0), False),
        ((0x1A2, 127, 0, 0), False),
        ((0x1A2, 0, 4, 0), False),
        ((0x1A2, 0, 0, 4), False),
        ((402, 0, 1, 1), False),  # the first number comes first
    ],
)
def test_a_question_of_a_fast_scan_is_answered_by_its_bits(
    words: tuple[int, int, int, int], hit: bool
) -> None:
    slave = Slave()
    assert slave.scan(*words) is hit
    assert not slave.is_configuring


def test_a_fast_scan_that_begins_anew_begins_with_the_first_number() -> None:
    slave = Slave()
    assert slave.scan(IDENTITY[0], 0, 0, 1)
    assert slave.scan(IDENTITY[1], 0, 1, 1)
    assert not slave.scan(IDENTITY[0], 0, 0, 1)
    assert slave.scan(0, CONFIRM, 0, 0)
    assert slave.scan(IDENTITY[0], 0, 0, 1)
    assert not slave.scan(IDENTITY[2], 0, 2, 2)


# A new bit rate


def activate(slave: Slave, delay_ms: int, entry: int | None = 2) -> None:
    slave.ask(0x04, 1)
    if entry is not None:
        assert slave.ask(0x13, 0, entry) == ["1300000000000000"]
    assert slave.ask(0x15, *delay_ms.to_bytes(2, "little")) == []


@pytest.mark.parametrize("delay_ms", [0, 1, 10, 255, 256, 0x0102, 0xFFFF])
@pytest.mark.parametrize(("entry", "bit_s"), [(0, 1_000_000), (2, 500_000), (8, 10_000)])
def test_a_new_bit_rate_is_there_after_twice_the_delay(
    delay_ms: int, entry: int, bit_s: int
) -> None:
    """A silence before the switch and one behind it; 16 bits, the low byte first."""
    slave = Slave()
    slave.clock.run_until(5 * MS)
    activate(slave, delay_ms, entry)
    assert slave.rates == [(5, None)]
    slave.clock.run_until((5 + 2 * delay_ms) * MS)
    assert slave.rates == [(5, None), (5 + 2 * delay_ms, bit_s)]
    slave.clock.run_until((6 + 4 * delay_ms) * MS)
    assert len(slave.rates) == 2


def test_a_reset_during_the_silence_ends_the_change() -> None:
    slave = Slave()
    activate(slave, 10)
    slave.clock.run_until(15 * MS)
    slave.lss.reset()
    slave.clock.run_until(100 * MS)
    assert slave.rates == [(0, None)]
    assert not slave.is_configuring
    activate(slave, 10)
    slave.clock.run_until(200 * MS)
    assert slave.rates[1:] == [(100, None), (120, 500_000)]


def test_without_a_pending_bit_rate_nothing_is_activated() -> None:
    slave = Slave()
    activate(slave, 10, None)
    slave.clock.run_until(100 * MS)
    assert slave.rates == []


def test_a_waiting_slave_activates_nothing() -> None:
    slave = Slave()
    slave.ask(0x04, 1)
    slave.ask(0x13, 0, 2)
    slave.ask(0x04, 0)
    slave.ask(0x15, 10, 0)
    slave.clock.run_until(100 * MS)
    assert slave.rates == []


def test_a_bus_of_one_bit_rate_refuses_another() -> None:
    slave = Slave(changes_rate=False)
    slave.ask(0x04, 1)
    assert slave.ask(0x13, 0, 2) == ["1301000000000000"]
    assert slave.settings.bit_rate is None
    assert slave.ask(0x15, 10, 0) == []
    slave.clock.run_until(100 * MS)
    assert slave.settings.stored_bit_rate is None


def _select(slave: Slave, *numbers: tuple[int, int]) -> list[str]:
    """Send numbers of an identity by their place; return every answer."""
    return [
        found
        for place, number in numbers
        for found in slave.ask(0x40 + place, *struct.pack("<I", number))
    ]


@pytest.mark.parametrize(
    ("wrong", "by"), [(1, "number"), (2, "number"), (3, "number"), (2, "place"), (3, "place")]
)
def test_after_a_mismatch_a_selection_begins_with_the_vendor(wrong: int, by: str) -> None:
    """CiA 305, switch state selective: the right numbers behind it do not make up for it."""
    slave, right = Slave(), list(enumerate(IDENTITY))
    odd = (wrong, IDENTITY[wrong] + 1) if by == "number" else right[wrong - 1]
    assert _select(slave, *right[:wrong], odd, *right[wrong:]) == []
    assert not slave.is_configuring
    assert _select(slave, *right) == ["4400000000000000"]
    assert slave.is_configuring


@pytest.mark.parametrize("before", [1, 2, 3])
def test_a_reset_ends_a_selection(before: int) -> None:
    slave, right = Slave(), list(enumerate(IDENTITY))
    _select(slave, *right[:before])
    slave.lss.reset()
    assert _select(slave, *right[before:]) == []
    assert not slave.is_configuring


@pytest.mark.parametrize(
    ("node_id", "error"), [(0, 1), (1, 0), (127, 0), (128, 1), (254, 1), (255, 0)]
)
def test_node_numbers_that_can_be_set(node_id: int, error: int) -> None:
    """CiA 305, configure node-ID: 1 to 127, and 255 for none; another one leaves what there is."""
    slave = Slave(active=9, pending=9)
    slave.ask(0x04, 1)
    assert slave.ask(0x11, node_id) == [f"11{error:02x}000000000000"]
    assert slave.settings.node_id == (9 if error else node_id)
    assert slave.ask(0x5E) == ["5e09000000000000"]  # the present one, until a reset
    assert slave.settings.stored_node_id == 9
    assert slave.ask(0x17) == ["1700000000000000"]
    assert slave.settings.stored_node_id == slave.settings.node_id


@pytest.mark.parametrize(
    ("table", "entry", "bit_s"),
    [
        (0, 0, 1_000_000), (0, 1, 800_000), (0, 2, 500_000), (0, 3, 250_000), (0, 4, 125_000),
        (0, 5, None), (0, 6, 50_000), (0, 7, 20_000), (0, 8, 10_000), (0, 9, None), (0, 255, None),
        (1, 2, None), (255, 2, None),
    ],
)  # fmt: skip
def test_bit_rates_of_the_standard_table(table: int, entry: int, bit_s: int | None) -> None:
    """CiA 305, table of bit timing parameters: 5 is reserved, 9 asks the slave to detect it."""
    slave = Slave()
    slave.ask(0x04, 1)
    error = 0 if bit_s else 1
    assert slave.ask(0x13, table, entry) == [f"13{error:02x}000000000000"]
    assert slave.settings.bit_rate == bit_s
    slave.ask(0x17)
    assert slave.settings.stored_bit_rate == bit_s
    assert slave.rates == []  # only an activation changes it


IN_ORDER = range(6)


def _identify(slave: Slave, *places: int) -> list[str]:
    """Send numbers of an identity by their place in 46h to 4Bh; return every answer.

    Vendor, product, lowest and highest revision, lowest and highest serial number.
    """
    vendor, product, revision, serial = IDENTITY
    numbers = (vendor, product, revision, revision, serial, serial)
    return [
        found
        for place in places
        for found in slave.ask(0x46 + place, *struct.pack("<I", numbers[place]))
    ]


@pytest.mark.parametrize("numbers", [1, 3, 5])
def test_a_reset_ends_an_identification(numbers: int) -> None:
    """All six numbers after the reset, or no answer."""
    slave = Slave()
    assert _identify(slave, *IN_ORDER[:numbers]) == []
    slave.lss.reset()
    assert _identify(slave, *IN_ORDER[numbers:]) == []
    assert _identify(slave, *IN_ORDER) == [IDENTIFIED]


@pytest.mark.parametrize(
    "places",
    [(0, 1, 3, 2, 4, 5), (0, 1, 2, 3, 5, 4), (0, 2, 1, 3, 4, 5), (0, 1, 2, 2, 4, 5),
     (0, 1, 2, 3, 4, 4), (1, 0, 2, 3, 4, 5)],
)  # fmt: skip
def test_an_identity_that_comes_out_of_turn_identifies_nobody(places: tuple[int, ...]) -> None:
    slave = Slave()
    assert _identify(slave, *places) == []
    assert _identify(slave, *IN_ORDER) == [IDENTIFIED]
