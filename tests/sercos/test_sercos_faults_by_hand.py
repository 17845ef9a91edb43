"""Faults of a virtual SERCOS drive: class 1, stuck bits, probing that ends by itself."""

import struct
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.sync_managers import MAILBOX_IN
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.drive.sercos.profiles import make_profile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import (
    ERROR_CODE,
    HEADER,
    Element,
    Header,
    Operation,
    command_states,
    ident_number,
    pack_list,
    read_text,
    soe_errors,
)
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

ON, ENABLE, RUN = 0x8000, 0x4000, 0x2000
FOLLOW = ON | ENABLE | RUN
C1D = 0x2000
BIT_1, BIT_2 = 1 << 6, 1 << 7
PROFILE_BIT = 1 << 5
LAG, LIMIT, NO_OUTPUTS, NO_SYNC, SHORT = 0x8611, 0x8612, 0x8130, 0x8700, 0x2310


class Hand:
    """A drive whose telegrams are written by hand, each millisecond.

    edges_ns: of its probe 1. place_m: where its axis is.
    """

    def __init__(
        self, edges_ns: tuple[int, ...] = (), profile: str = "one_probe", place_m: float = 0.0
    ) -> None:
        self.clock = new_scheduler()
        axis = FakeAxis(place_m)
        self.drive = SercosDrive(
            "Z", self.clock, axis, (FakeSignal(axis, edges_ns), None),
            make_profile(profile, DriveProfile(), "rotary", 1 << 20),
        )  # fmt: skip
        self.start()

    def start(self) -> None:
        """To phase 4, with one position in either telegram."""
        self.clock.run_until(0)
        for ident, listed in (("S-0-0016", "S-0-0051"), ("S-0-0024", "S-0-0047")):
            assert self.written(ident, pack_list([ident_number(listed)], 2, 1)) is None
        self.drive.telegrams.compile()
        self.drive.managers[MAILBOX_IN].length = 128
        self.drive.states.state = AlState.OP  # phase 4

    def ask(self, operation: Operation, ident: str, data: bytes = b"") -> bytes | str | None:
        """A request over the service channel; the answer's value, or the code that refuses it."""
        head = Header(operation, 0, Element.VALUE, ident_number(ident))
        answers = self.drive.channel.serve(head.pack() + data)
        if not answers:
            return None
        (answer,) = answers
        if not Header.read(answer).is_error:
            return answer[HEADER.size :]
        code = ERROR_CODE.unpack_from(answer, HEADER.size)[0]
        return next(name for name, number in soe_errors().items() if number == code)

    def written(self, ident: str, data: bytes) -> bytes | str | None:
        return self.ask(Operation.WRITE, ident, data) or None

    def number(self, ident: str) -> int:
        value = self.ask(Operation.READ, ident)
        assert isinstance(value, bytes)
        return int.from_bytes(value, "little")

    def text(self) -> str:
        value = self.ask(Operation.READ, "S-0-0095")
        assert isinstance(value, bytes)
        return read_text(value)

    def state(self, ident: str) -> str:
        """Data state of a procedure command by its name."""
        number = self.drive.idents.table[ident_number(ident)].state
        return next(name for name, code in command_states().items() if code == number)

    def cycle(self, control: int, count: int = 1) -> int:
        """Run cycles; return S-0-0135 of the last."""
        drive, servo = self.drive, self.drive.servo
        for _ in range(count):
            self.clock.run_until(self.clock.now_ns + MS)
            servo.begin(self.clock.now_ns)
            drive.telegrams.take(servo.image, struct.pack("<Hi", control, 0))
            servo.cycle(self.clock.now_ns)
        return int(struct.unpack_from("<H", drive.telegrams.message(servo.image))[0])

    def fault(self, code: int) -> None:
        self.drive.servo.fault(code, PROFILE_BIT, self.clock.now_ns)

    def acknowledge(self) -> None:
        """S-0-0099 is set, then cancelled."""
        self.written("S-0-0099", b"\x03\x00")
        self.cycle(0, 4)
        assert self.state("S-0-0099") == "DONE"
        self.written("S-0-0099", b"\x00\x00")


@pytest.fixture
def hand() -> Hand:
    return Hand()


def test_class_1_has_the_bit_of_its_error_until_that_is_acknowledged(hand: Hand) -> None:
    """SERCOS, S-0-0011: 11 deviation, 12 communication, 13 travel limit, 15 of the maker.

    S-0-0390 and S-0-0095 come and go with it; one after the other, the first one twice.
    """
    bits = ((LAG, 11), (LIMIT, 13), (NO_OUTPUTS, 12), (SHORT, 15), (NO_SYNC, 12), (LAG, 11))
    numbers, texts = set[int](), set[str]()
    for code, bit in bits:
        assert (hand.number("S-0-0011"), hand.number("S-0-0390"), hand.text()) == (0, 0xD0012, "")
        assert hand.cycle(FOLLOW, 8) & C1D == 0
        assert hand.drive.state is State.OPERATION_ENABLED
        hand.fault(code)
        assert hand.cycle(FOLLOW, 4) & C1D
        assert hand.number("S-0-0011") == 1 << bit
        numbers.add(hand.number("S-0-0390"))
        texts.add(hand.text())
        hand.acknowledge()
    assert len(numbers) == len(texts) == 5
    assert {0xF2028, 0xF2057, 0xF0000 | SHORT} <= numbers  # AX5000: diagnostic codes
    assert f"error 0x{SHORT:04X}" in texts


def test_an_error_that_goes_beside_a_fault_takes_its_diagnosis_not_away(hand: Hand) -> None:
    """A limit switch that is left while the axis still brakes of its deviation, and at rest."""
    for brakes in (True, False, True):
        assert hand.cycle(FOLLOW, 8) & C1D == 0
        servo = hand.drive.servo
        servo.emergency.report(LIMIT, PROFILE_BIT)
        hand.fault(LAG)
        assert hand.drive.state is State.FAULT_REACTION_ACTIVE
        if not brakes:
            hand.cycle(FOLLOW, 4)
            assert hand.drive.state is State.FAULT
        servo.emergency.clear(LIMIT)
        found = hand.number("S-0-0011"), hand.number("S-0-0390"), hand.text()
        assert found == (1 << 11, 0xF2028, "excessive deviation")
        hand.cycle(FOLLOW, 4)
        hand.acknowledge()
        assert (hand.number("S-0-0011"), hand.text()) == (0, "")


@pytest.mark.parametrize(
    ("name", "mask"), [("STATUS_1", BIT_1), ("STATUS_2", BIT_2), ("CONTROL_1", BIT_1),
                       ("CONTROL_2", BIT_2)],
)  # fmt: skip
def test_a_bit_that_is_stuck_keeps_its_level_until_it_passes_again(
    hand: Hand, name: str, mask: int
) -> None:
    """Up, down, free; the other bit and the rest of the word pass all the time."""
    both = BIT_1 | BIT_2
    is_status = name.startswith("STATUS")
    enable = ident_number("S-0-0405")
    if is_status:  # both show what bit 0 of S-0-0405 is
        hand.drive.idents.put(ident_number("S-0-0305"), enable)
        hand.drive.idents.put(ident_number("S-0-0307"), enable)

    def status_at(level: bool) -> int:
        if not is_status:
            hand.cycle(FOLLOW | both * level)
            return hand.drive.front.control & ~FOLLOW
        hand.written("S-0-0405", bytes((level, 0)))
        return hand.cycle(0) & both

    for held in (None, True, False, True, None):
        hand.drive.hold_bit(name, level=held)
        for level in (True, False, True):
            own = mask if (level if held is None else held) else 0
            assert status_at(level) == own | (both & ~mask if level else 0), (held, level)


def test_a_probing_cycle_that_ends_by_itself_is_interrupted_and_begins_again(hand: Hand) -> None:
    """S-0-0170: state 5, no change bit; what was armed is off, and on again with the next 3."""
    hand.written("S-0-0169", b"\x01\x00")
    hand.written("S-0-0405", b"\x01\x00")
    image = hand.drive.servo.image
    hand.drive.interrupt_probing()
    assert hand.state("S-0-0170") == "IDLE"  # no cycle runs: nothing to interrupt
    for _ in range(2):
        hand.written("S-0-0170", b"\x03\x00")
        assert (hand.state("S-0-0170"), image.probe_function) == ("RUNNING", 0x11)
        hand.drive.interrupt_probing()
        assert (hand.state("S-0-0170"), image.probe_function) == ("INTERRUPTED", 0)
        assert not hand.drive.probing.is_running
        assert hand.cycle(0) & 1 << 5 == 0
        hand.written("S-0-0170", b"\x00\x00")


def test_the_edges_that_are_latched_are_bits_by_their_order() -> None:
    """S-0-0179: bit 0 rising, bit 1 falling of probe 1; gone with the enable, and here again."""
    hand = Hand((int(2.5 * MS), int(4.5 * MS), int(9.5 * MS)))
    hand.written("S-0-0169", b"\x03\x00")
    hand.written("S-0-0170", b"\x03\x00")
    hand.written("S-0-0405", b"\x01\x00")
    found = []
    for _ in range(6):
        hand.cycle(0)
        found.append(hand.number("S-0-0179"))
    assert found == [0, 0, 1, 1, 3, 3]
    hand.written("S-0-0405", b"\x00\x00")
    assert (hand.cycle(0), hand.number("S-0-0179")) == (hand.cycle(0), 0)
    hand.written("S-0-0405", b"\x01\x00")
    hand.cycle(0, 2)
    assert [hand.number(ident) for ident in ("S-0-0409", "S-0-0410", "S-0-0179")] == [1, 0, 1]


def test_the_channel_answers_as_its_disturbance_says_and_then_as_ever(hand: Hand) -> None:
    """No answer, a code, as ever; each request asks anew."""
    answers: list[Any] = ["", "NOT_NOW", None, "NOT_NOW", ""]
    left = list(answers)
    hand.drive.disturb_channel(lambda: left.pop(0) if left else None)
    found = [hand.ask(Operation.READ, "S-0-0390") for _ in range(len(answers) + 1)]
    there = (0xD0012).to_bytes(4, "little")
    assert found == [None, "NOT_NOW", there, "NOT_NOW", None, there]


@pytest.mark.parametrize(
    ("before", "after", "is_over"),
    [
        (AlState.OP, AlState.SAFEOP, False),
        (AlState.SAFEOP, AlState.PREOP, True),
        (AlState.OP, AlState.INIT, True),
    ],
)
def test_the_probing_cycle_ends_with_phase_3(
    hand: Hand, before: AlState, after: AlState, is_over: bool
) -> None:
    hand.written("S-0-0169", b"\x01\x00")
    hand.written("S-0-0170", b"\x03\x00")
    hand.drive.leave(before, after, "")
    assert hand.drive.probing.is_running is not is_over
    assert hand.state("S-0-0170") == ("IDLE" if is_over else "RUNNING")
