"""LSS slave (CiA 305): by frames as the standard writes them, and by canopen's own LSS master."""

import queue
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from canopen.lss import LssError, LssMaster

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

Make = Callable[..., Any]
IDENTITY = (0, 402, 0x10000, 3)


def lss(drive: Any, *data: int) -> str:
    """Send a request; return the answer, "" for none."""
    answers = [a for can_id, a in drive.after(0x7E5, bytes(data).ljust(8, b"\0").hex())]
    found = [a for can_id, a in drive.heard[len(drive.heard) - len(answers) :] if can_id == 0x7E4]
    assert len(found) <= 1
    return found[0] if found else ""


def number(command: int, value: int) -> tuple[int, ...]:
    return (command, *value.to_bytes(4, "little"))


def select(drive: Any, *identity: int) -> list[str]:
    pairs = zip((0x40, 0x41, 0x42, 0x43), identity, strict=True)
    return [lss(drive, *number(command, value)) for command, value in pairs]


def test_selective_switch(stranger: Make) -> None:
    """44 hex answers the fourth number, when all four are those of the drive."""
    drive = stranger()
    assert select(drive, *IDENTITY) == ["", "", "", "4400000000000000"]
    assert lss(drive, 0x5E) == "5e03000000000000"


@pytest.mark.parametrize("wrong", range(4))
def test_another_identity_is_not_meant(stranger: Make, wrong: int) -> None:
    drive = stranger()
    identity = [value + (place == wrong) for place, value in enumerate(IDENTITY)]
    assert select(drive, *identity) == ["", "", "", ""]
    assert lss(drive, 0x5E) == ""


def test_selective_switch_needs_its_order(stranger: Make) -> None:
    drive = stranger()
    for place in (0, 2, 1, 3):
        assert lss(drive, *number(0x40 + place, IDENTITY[place])) == ""


def test_inquiries(stranger: Make) -> None:
    drive = stranger()
    assert lss(drive, 0x5A) == ""  # waiting
    lss(drive, 0x04, 1)
    answers = [lss(drive, command) for command in range(0x5A, 0x5F)]
    assert answers == [
        "5a00000000000000",
        "5b92010000000000",
        "5c00000100000000",
        "5d03000000000000",
        "5e03000000000000",
    ]
    lss(drive, 0x04, 0)
    assert lss(drive, 0x5E) == ""


def test_node_number_acts_with_reset_communication(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x1017, 0, 100, 2)
    lss(drive, 0x04, 1)
    assert lss(drive, 0x11, 9) == "1100000000000000"
    assert lss(drive, 0x5E) == "5e03000000000000"
    lss(drive, 0x04, 0)
    assert drive.read(0x1001) == 0  # still node 3
    assert (0x709, "00") in drive.nmt(130)
    assert drive.node.node_id == 9
    assert drive.after(0x609, "4014100000000000") == [(0x589, "4314100089000000")]
    assert drive.sdo("4000100000000000") == ""
    drive.after(0, "0109")
    assert [can_id for can_id, _ in drive.after(0x80)] == [0x189, 0x289]


@pytest.mark.parametrize("node_id", [0, 128, 254])
def test_impossible_node_numbers(stranger: Make, node_id: int) -> None:
    drive = stranger()
    lss(drive, 0x04, 1)
    assert lss(drive, 0x11, node_id) == "1101000000000000"


@pytest.mark.parametrize("stored", [True, False])
def test_stored_node_number_is_that_of_the_next_power_on(stranger: Make, stored: bool) -> None:
    drive = stranger()
    lss(drive, 0x04, 1)
    lss(drive, 0x11, 9)
    if stored:
        assert lss(drive, 0x17) == "1700000000000000"
    drive.node.restart()
    drive.run_ms(2)
    assert drive.heard[-1] == (0x709 if stored else 0x703, "00")


def test_stored_identifiers_follow_the_node_number(stranger: Make) -> None:
    """What 1010 stores is what differs from the default; the default has the node number in it."""
    drive = stranger()
    drive.write(0x1800, 2, 5, 1)
    drive.write(0x1401, 1, 0x8000_0222, 4)
    drive.write(0x1010, 1, int.from_bytes(b"save", "little"), 4)
    lss(drive, 0x04, 1)
    lss(drive, 0x11, 9)
    drive.nmt(130)
    read = drive.after(0x609, "4000180100000000") + drive.after(0x609, "4001140100000000")
    assert [data[8:] for _, data in read] == ["89010040", "22020080"]


def test_bit_timing(stranger: Make) -> None:
    """Standard table: 0 = 1 Mbit/s ... 8 = 10 kbit/s; 5 reserved, 9 automatic: refused."""
    drive = stranger()
    lss(drive, 0x04, 1)
    answers = [lss(drive, 0x13, 0, entry)[:4] for entry in range(11)]
    assert answers == [f"130{int(entry in (5, 9, 10))}" for entry in range(11)]
    assert lss(drive, 0x13, 1, 0) == "1301000000000000"  # no other table


def test_another_bit_rate_takes_the_drive_off_this_bus(stranger: Make) -> None:
    drive = stranger()
    lss(drive, 0x04, 1)
    lss(drive, 0x13, 0, 2)
    drive.after(0x7E5, "150a00" + "0000000000")  # delay 10 ms
    drive.run_ms(100)
    assert drive.sdo("4000100000000000") == ""
    drive.node.restart()  # not stored
    drive.run_ms(2)
    assert (0x703, "00") in drive.heard[-2:]  # and the answer to what nobody had acknowledged


@pytest.mark.parametrize("stored", [True, False])
def test_a_stored_bit_rate_is_that_of_the_next_power_on(stranger: Make, stored: bool) -> None:
    """500 kbit/s on a bus of 1 Mbit/s: the drive hears nobody until it gets a bit rate again."""
    drive = stranger()
    lss(drive, 0x04, 1)
    lss(drive, 0x13, 0, 2)
    if stored:
        assert lss(drive, 0x17) == "1700000000000000"
    assert drive.sdo("4000100000000000") != ""  # not activated yet
    for _ in range(2):
        drive.node.restart()
        drive.run_ms(2)
        assert (drive.sdo("4000100000000000") == "") == stored


def test_activating_the_present_bit_rate_is_a_silence(stranger: Make) -> None:
    """Twice the delay of 10 ms."""
    drive = stranger()
    lss(drive, 0x04, 1)
    lss(drive, 0x13, 0, 0)
    drive.after(0x7E5, "150a00" + "0000000000", wait_ms=19)
    assert drive.sdo("4000100000000000") == ""
    drive.run_ms(2)
    assert drive.sdo("4000100000000000") != ""


@pytest.mark.parametrize(
    ("numbers", "hit"),
    [
        ((0, 402, 0, 0xFFFFFFFF, 0, 0xFFFFFFFF), True),
        ((0, 402, 0x10000, 0x10000, 3, 3), True),
        ((1, 402, 0, 0xFFFFFFFF, 0, 0xFFFFFFFF), False),
        ((0, 401, 0, 0xFFFFFFFF, 0, 0xFFFFFFFF), False),
        ((0, 402, 0x10001, 0xFFFFFFFF, 0, 0xFFFFFFFF), False),
        ((0, 402, 0, 0xFFFF, 0, 0xFFFFFFFF), False),
        ((0, 402, 0, 0xFFFFFFFF, 4, 9), False),
        ((0, 402, 0, 0xFFFFFFFF, 0, 2), False),
    ],
)
def test_identify_remote_slave(stranger: Make, numbers: tuple[int, ...], hit: bool) -> None:
    drive = stranger()
    answers = [lss(drive, *number(0x46 + n, value)) for n, value in enumerate(numbers)]
    assert answers == [""] * 5 + (["4f00000000000000"] if hit else [""])


@pytest.mark.parametrize("data", ["", "04", "0401", "04010000000000"])
def test_short_frames_are_ignored(stranger: Make, data: str) -> None:
    drive = stranger()
    drive.after(0x7E5, data)
    assert lss(drive, 0x5E) == ""


# canopen's LSS master and drives without a number


class Answers(queue.Queue):  # type: ignore[type-arg]
    """The queue of the master; it waits in simulated time."""

    def __init__(self, scheduler: Scheduler) -> None:
        super().__init__()
        self.scheduler = scheduler

    def get(self, block: bool = True, timeout: float | None = None) -> Any:
        self.scheduler.run_while(self.empty, round((timeout or 0) * 1000) * MS)
        return super().get(block=False)


@pytest.fixture
def bus(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A segment and canopen's master; `drive(serial)` adds a drive without a number."""
    scheduler = new_scheduler()
    monkeypatch.setattr(
        "canopen.lss.time",
        SimpleNamespace(sleep=lambda s: scheduler.run_until(scheduler.now_ns + round(s * 1e9))),
    )
    with Segment("lss bus", 1_000_000, scheduler) as segment:
        network = SimNetwork(segment.port("master")).connect()
        master = network.lss
        assert isinstance(master, LssMaster)
        master.responses = Answers(scheduler)
        monkeypatch.setattr("canopen.lss.queue.Queue", lambda: Answers(scheduler))
        heard: list[tuple[int, bytes]] = []
        segment.port("listener").attach(lambda m: heard.append((m.arbitration_id, bytes(m.data))))
        yield SimpleNamespace(segment=segment, scheduler=scheduler, master=master, heard=heard)


def drive(bus: Any, axis: Any, serial: int, node_id: int = 255) -> DriveNode:
    node = DriveNode(
        f"drive {serial}",
        node_id,
        SimNetwork(bus.segment.port(f"drive {serial}")).connect(),
        bus.scheduler,
        axis,
    )
    node.slave.serial_number = serial
    bus.scheduler.run_until(bus.scheduler.now_ns + MS)
    return node


def test_a_drive_without_a_number_is_silent(bus: Any, fake_axis: Any) -> None:
    node = drive(bus, fake_axis(), 7)
    bus.master.network.send_message(0, b"\x01\x00")
    bus.master.network.send_message(0x80, b"")
    bus.master.network.send_message(0x6FF, b"\x40\x00\x10\x00\x00\x00\x00\x00")
    bus.scheduler.run_until(10 * MS)
    assert [can_id for can_id, _ in bus.heard] == [0, 0x80, 0x6FF]
    assert node.nmt_state is NmtState.INITIALISING


@pytest.mark.long
def test_fast_scan_finds_one_drive_after_the_other(bus: Any, fake_axis: Any) -> None:
    """Three drives that differ in their serial numbers get the node numbers 1, 2, 3."""
    nodes = [drive(bus, fake_axis(), serial) for serial in (0x8000_0001, 5, 4)]
    found = []
    for node_id in (1, 2, 3):
        hit, identity = bus.master.fast_scan()
        assert hit
        found.append(identity)
        bus.master.configure_node_id(node_id)
        bus.master.store_configuration()
        bus.master.send_switch_state_global(LssMaster.WAITING_STATE)
        bus.scheduler.run_until(bus.scheduler.now_ns + 5 * MS)
        assert bus.heard[-1] == (0x700 + node_id, b"\x00")
    assert found == [[0, 402, 0x10000, serial] for serial in (4, 5, 0x8000_0001)]
    assert bus.master.fast_scan() == (False, None)
    assert [node.node_id for node in nodes] == [3, 2, 1]
    assert {node.nmt_state for node in nodes} == {NmtState.PRE_OPERATIONAL}
    nodes[0].restart()
    bus.scheduler.run_until(bus.scheduler.now_ns + 5 * MS)
    assert bus.heard[-1] == (0x703, b"\x00")


def test_selective_switch_by_canopen(bus: Any, fake_axis: Any) -> None:
    drive(bus, fake_axis(), 5, node_id=11)
    drive(bus, fake_axis(), 6, node_id=12)
    assert bus.master.send_switch_state_selective(0, 402, 0x10000, 6)
    assert bus.master.inquire_node_id() == 12
    assert [bus.master.inquire_lss_address(cs) for cs in range(0x5A, 0x5E)] == [0, 402, 0x10000, 6]
    bus.master.send_switch_state_global(LssMaster.WAITING_STATE)
    with pytest.raises(LssError):
        bus.master.inquire_node_id()
    assert bus.master.fast_scan() == (False, None)  # every drive has a number
