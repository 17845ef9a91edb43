"""The start-up of a CANopen node step by step, with answers by hand: what ends it, and how."""

from collections import deque
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.startup import DriveAddress, StartUp
from axisrig.kernel.drives.canopen.startup_steps import (
    BootUp,
    Check,
    CheckScaling,
    Keep,
    Nmt,
    Scaling,
    StartUpSettings,
    Step,
    Write,
)
from axisrig.kernel.drives.cia402.objects import Done, SdoError
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

NODE, HEARTBEAT_ID = 3, 0x703
RESET_COMMUNICATION, START = 0x82, 0x01
BOOT = BootUp("boot-up", RESET_COMMUNICATION)
GO = Nmt("NMT start", START)
TIMEOUT_NS = 100 * MS


class Node:
    """A start-up and its node, which answers by hand; log: NMT, reads and writes in their order."""

    def __init__(self, *steps: Step, attempts: int = 3) -> None:
        self.clock = new_scheduler()
        self.log: list[tuple[Any, ...]] = []
        self.ended: list[Alarm | None] = []
        self.kept: list[tuple[int, int, int]] = []
        self.open: deque[Done] = deque()
        self.bus: Any = SimpleNamespace(pending=[])
        self._hear: Any = None
        settings = StartUpSettings(boot_timeout_ns=TIMEOUT_NS, boot_attempts=attempts)
        self.start = StartUp(
            DriveAddress("Z", NODE), self, self.clock, self, steps, settings,  # type: ignore[arg-type]
            lambda *values: self.kept.append(values),
        )  # fmt: skip

    def subscribe(self, can_id: int, callback: Any) -> None:
        assert can_id == HEARTBEAT_ID
        self._hear = callback

    def send_message(self, can_id: int, data: bytes) -> None:
        self.log.append((can_id, bytes(data)))

    def read(self, index: int, sub: int, done: Done) -> None:
        self.log.append(("read", index, sub))
        self.open.append(done)

    def write(self, index: int, sub: int, data: bytes, done: Done) -> None:
        self.log.append(("write", index, sub, data))
        self.open.append(done)

    def begin(self) -> None:
        self.start.begin(self.ended.append)

    def hear(self, data: bytes = b"\0") -> None:
        self._hear(HEARTBEAT_ID, bytearray(data), 0.0)

    def answer(self, *values: int | bytes | SdoError) -> None:
        """Answer the oldest questions; a number has four bytes."""
        for value in values:
            data = (value & 0xFFFFFFFF).to_bytes(4, "little") if isinstance(value, int) else value
            self.open.popleft()(data)

    def wait(self, time_ns: int) -> None:
        self.clock.run_until(self.clock.now_ns + time_ns)

    @property
    def alarm(self) -> Alarm:
        (found,) = self.ended
        assert found is not None
        return found


def command(code: int) -> tuple[int, bytes]:
    return 0, bytes((code, NODE))


# Boot-up


def test_a_node_is_started_once_its_boot_up_has_come() -> None:
    node = Node(BOOT, GO)
    node.hear()  # nobody has asked for it
    node.begin()
    assert node.log == [command(RESET_COMMUNICATION)]
    for data in (b"\x7f", b"\5", b"", b"\0\0"):  # heartbeats, and what is none
        node.hear(data)
    assert node.ended == []
    node.hear()
    assert node.log == [command(RESET_COMMUNICATION), command(START)]
    assert node.ended == [None]
    node.hear()
    node.wait(1000 * MS)
    assert node.ended == [None]


@pytest.mark.parametrize("attempts", [1, 3])
def test_a_node_that_does_not_boot_is_commanded_so_often(attempts: int) -> None:
    node = Node(BOOT, GO, attempts=attempts)
    node.begin()
    node.wait(attempts * TIMEOUT_NS - 1)
    assert node.log == [command(RESET_COMMUNICATION)] * attempts
    assert node.ended == []
    node.wait(1)
    assert node.alarm.id == 900020
    assert node.alarm.values == {
        "axis": "Z", "node": NODE, "ms": attempts * 100, "attempts": attempts,
    }  # fmt: skip
    node.hear()  # too late
    assert node.log == [command(RESET_COMMUNICATION)] * attempts


def test_a_node_that_boots_by_itself_is_waited_for_without_a_command() -> None:
    node = Node(BootUp("boot-up", None), GO)
    node.begin()
    node.wait(TIMEOUT_NS + 1)
    assert node.log == []
    node.hear()
    assert node.log == [command(START)]


@pytest.mark.parametrize(("waiting", "counts"), [((), True), ((NODE,), False), ((4,), True)])
def test_a_boot_up_before_its_command_is_on_the_bus_does_not_count(
    waiting: tuple[int, ...], counts: bool
) -> None:
    """Commands for other nodes may wait, and other frames for this one."""
    node = Node(BOOT, GO)
    node.begin()
    for number in waiting:
        frame = SimpleNamespace(arbitration_id=0, data=bytes((RESET_COMMUNICATION, number)))
        node.bus.pending.append((0, 0, 0, 0, frame))
    node.bus.pending.append((0, 0, 0, 0, SimpleNamespace(arbitration_id=0x600, data=b"\0\3")))
    node.hear()
    assert (node.ended == [None]) is counts


# A start that begins anew


def test_what_belongs_to_an_earlier_start_does_nothing_to_the_next_one() -> None:
    """Its time-outs, its answers and what it had read."""
    node = Node(BOOT, Write("w", 0x6060, 0, b"\x08"), GO)
    node.begin()
    node.wait(2 * TIMEOUT_NS + TIMEOUT_NS // 2)  # in its third attempt
    node.begin()
    node.wait(TIMEOUT_NS - 1)
    assert node.log == [command(RESET_COMMUNICATION)] * 4
    node.hear()
    assert node.log[-1] == ("write", 0x6060, 0, b"\x08")
    node.begin()
    node.answer(b"")  # to the write of the start before
    assert node.ended == []
    node.hear()
    node.answer(b"")
    assert node.ended == [None]
    node.begin()
    node.wait(3 * TIMEOUT_NS)
    assert [alarm and alarm.id for alarm in node.ended] == [None, 900020]
    assert node.ended[1] is not None
    assert node.ended[1].values["attempts"] == 3  # of this start


# Objects


@pytest.mark.parametrize(
    ("value", "mask", "is_it"),
    [
        (0x00020192, 0xFFFF, True), (0x00020193, 0xFFFF, False), (0x00020192, 0xFFFFFFFF, False),
        (0x192, 0xFFFFFFFF, True),
    ],
)  # fmt: skip
def test_a_device_is_the_one_of_the_rig_in_the_bits_that_count(
    value: int, mask: int, is_it: bool
) -> None:
    node = Node(Check("0x1000:0 device type", 0x1000, 0, 402, mask), GO)
    node.begin()
    node.answer(value)
    assert (node.ended == [None]) is is_it
    if not is_it:
        assert node.alarm.id == 900021
        assert node.alarm.values["found"] == f"0x{value:X}"
        assert node.alarm.values["expected"] == "0x192"
        assert command(START) not in node.log


@pytest.mark.parametrize(("signed", "value"), [(True, -2), (False, 0xFFFE)])
def test_what_an_rpdo_will_carry_is_kept_as_it_is(signed: bool, value: int) -> None:
    node = Node(Keep("k", 0x6072, 1, signed), GO)
    node.begin()
    node.answer(b"\xfe\xff")
    assert node.kept == [(0x6072, 1, value)]
    assert node.ended == [None]
    node.begin()  # a program may have sent another value; the drive has 0 again
    node.answer(b"\0\0")
    assert node.kept[1:] == [(0x6072, 1, 0)]


@pytest.mark.parametrize(
    ("step", "asked"),
    [
        (Write("0x6060:0 = 8", 0x6060, 0, b"\x08"), "0x6060:0 = 8"),
        (Check("0x1000:0 device type", 0x1000, 0, 402), "the reading of 0x1000:0 device type"),
        (CheckScaling("scaling", Scaling(1, Fraction(1))), "the reading of 0x608F:1 (scaling)"),
    ],
)
def test_a_step_that_is_refused_ends_the_start_with_its_words(step: Step, asked: str) -> None:
    node = Node(step, GO)
    node.begin()
    node.answer(SdoError(*((0x608F, 1) if "scaling" in step.name else (0x1000, 0)), 0x06020000))
    assert (node.alarm.id, node.alarm.values["step"]) == (900011, asked)
    assert str(node.alarm.values["answer"]).startswith("abort 0x06020000")
    assert command(START) not in node.log


# Scaling: 608F increments/motor revolutions, 6091 motor/shaft revolutions, 6092 feed/shaft


@pytest.mark.parametrize(
    ("values", "increments", "units"),
    [
        ((1 << 20, 1, 1, 1, 10_000, 1), 1 << 20, Fraction(10_000)),
        ((1 << 20, 1, 5, 2, 10_000, 1), 1 << 20, Fraction(4000)),  # 2 turns of the shaft for 5
        ((1 << 20, 1, 1, 1, 10_000, 3), 1 << 20, Fraction(10_000, 3)),
        ((1 << 21, 2, 2, 5, 10_000, 1), 1 << 20, Fraction(25_000)),
    ],
)
@pytest.mark.parametrize("off", [0, 1])
def test_the_scaling_of_a_drive_is_that_of_its_factors(
    values: tuple[int, ...], increments: int, units: Fraction, off: int
) -> None:
    """Units of a motor revolution are feed / shaft revolutions times shaft / motor (CiA 402-2)."""
    for expected in (Scaling(increments + off, units), Scaling(increments, units + off)):
        node = Node(CheckScaling("scaling", expected), GO)
        for _ in range(2):  # what was read before is forgotten
            node.begin()
            node.answer(*values)
            assert [alarm and alarm.id for alarm in node.ended] == [900022 if off else None]
            node.ended.clear()
        places = [(0x608F, 1), (0x608F, 2), (0x6091, 1), (0x6091, 2), (0x6092, 1), (0x6092, 2)]
        assert [(each[1], each[2]) for each in node.log if each[0] == "read"] == places * 2


def test_increments_that_are_no_whole_number_are_those_of_no_rig() -> None:
    node = Node(CheckScaling("scaling", Scaling(1000, Fraction(10))), GO)
    node.begin()
    node.answer(2001, 2, 1, 1, 10, 1)
    assert str(node.alarm.values["found"]).startswith("2001/2 increments and 10 position units")


@pytest.mark.parametrize("place", [1, 2, 3, 5])
def test_a_factor_of_0_is_no_scaling(place: int) -> None:
    values = [1 << 20, 1, 1, 1, 10_000, 1]
    values[place] = 0
    node = Node(CheckScaling("scaling", Scaling(1 << 20, Fraction(10_000))), GO)
    node.begin()
    node.answer(*values)
    assert node.alarm.id == 900022
    assert "factor of 0" in str(node.alarm)
