"""Nodes whose power goes before they have booted, and a node with digital inputs that leaves."""

from collections.abc import Iterator
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.canopen.io_node import IoNode
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

NODE = 5
BOOT_UP, PRE_OPERATIONAL = (0x705, "00"), (0x705, "7f")


class Bus:
    """A segment with a listener. heard: identifier and data of each frame.

    levels: of the inputs, bit by bit; asked_ns: when a node has asked for them.
    """

    def __init__(self, segment: Segment) -> None:
        self.segment, self.clock = segment, segment.scheduler
        self.port, self.second = segment.port("stranger"), segment.port("second")
        self.node_port = segment.port("node")
        self.network = SimNetwork(self.node_port).connect()
        self.heard: list[tuple[int, str]] = []
        self.levels, self.asked_ns = 0, list[int]()
        self.port.attach(lambda m: self.heard.append((m.arbitration_id, m.data.hex())))
        self.second.attach_data(lambda _id, _data, _time: None)

    def level(self, now_ns: int) -> int:
        self.asked_ns.append(now_ns)
        return self.levels

    def after(self, can_id: int, data: str = "", wait_ms: float = 1) -> list[tuple[int, str]]:
        """Send a frame; return what is heard within `wait_ms`."""
        begin = len(self.heard)
        self.port.send(
            can.Message(arbitration_id=can_id, is_extended_id=False, data=bytes.fromhex(data))
        )
        self.clock.run_until(self.clock.now_ns + round(wait_ms * MS))
        return self.heard[begin:]


@pytest.fixture
def bus() -> Iterator[Bus]:
    with Segment("power before the boot", 1_000_000, new_scheduler()) as segment:
        yield Bus(segment)


def test_a_drive_whose_power_goes_at_once_boots_when_it_has_it_again(
    bus: Bus, fake_axis: Any
) -> None:
    axis = fake_axis()
    node = DriveNode("Z", NODE, bus.network, bus.clock, axis)
    node.power_off()
    bus.clock.run_until(10 * MS)
    assert (bus.heard, node.is_on, node.nmt_state.name) == ([], False, "INITIALISING")
    assert bus.after(0x605, "4041600000000000") == []
    node.power_on()
    bus.clock.run_until(bus.clock.now_ns + MS)
    assert bus.heard == [BOOT_UP]
    assert node.nmt_state.name == "PRE_OPERATIONAL"
    node.power_on()  # it has it
    bus.clock.run_until(bus.clock.now_ns + MS)
    assert bus.heard == [BOOT_UP]
    assert not axis.commands[-1].enabled


def test_a_node_with_inputs_whose_power_goes_at_once_never_boots(bus: Bus) -> None:
    node = IoNode(NODE, bus.network, bus.clock, bus.level)
    node.power_off()
    bus.clock.run_until(10 * MS)
    assert bus.heard == []
    assert bus.after(0x605, "4000600100000000") == []


def test_a_node_with_inputs_leaves_the_bus_with_its_power(bus: Bus) -> None:
    """It says nothing, samples nothing, acknowledges nothing, and a frame of it breaks off."""
    node = IoNode(NODE, bus.network, bus.clock, bus.level)
    bus.clock.run_until(MS)
    assert bus.heard == [BOOT_UP]
    assert bus.after(0x605, "2b17100005000000", 12)[0] == PRE_OPERATIONAL
    bus.after(0, "0105")
    bus.levels = 0x5A
    assert bus.after(0x80) == [(0x185, "5a")]
    node.power_off()
    asked = len(bus.asked_ns)
    for can_id, data in ((0x80, ""), (0x605, "4000600100000000"), (0, "8105")):
        assert bus.after(can_id, data, 20) == []
    assert len(bus.asked_ns) == asked
    assert not bus.node_port.takes_part
    bus.second.shutdown()
    bus.after(0x80)  # alone on the bus: nobody acknowledges
    assert bus.port.tec > 0


def test_inputs_are_8_bits_and_0_from_a_reset_to_the_next_sync(bus: Bus) -> None:
    node = IoNode(NODE, bus.network, bus.clock, bus.level)
    bus.clock.run_until(MS)
    read = "4000600100000000"
    bus.levels = 0x1FF
    bus.after(0x80)
    assert bus.after(0x605, read) == [(0x585, "4f006001ff000000")]
    bus.levels = 0x01
    assert bus.after(0x605, read) == [(0x585, "4f006001ff000000")]  # that of the SYNC
    bus.after(0, "8105")
    assert bus.after(0x605, read) == [(0x585, "4f00600100000000")]
    bus.after(0x80)
    assert bus.after(0x605, read) == [(0x585, "4f00600101000000")]
    bus.after(0, "0205")  # stopped
    asked = len(bus.asked_ns)
    bus.after(0x80)
    assert len(bus.asked_ns) == asked
    assert node.node_id == NODE


def test_a_node_with_inputs_beats_before_it_answers_and_then_in_its_time(bus: Bus) -> None:
    """1017 written: the heartbeat, the answer, and the next heartbeat a period later; 0 ends it."""
    IoNode(NODE, bus.network, bus.clock, bus.level)
    bus.clock.run_until(MS)
    answer = (0x585, "6017100000000000")
    assert bus.after(0x605, "2b17100005000000", 4.5) == [PRE_OPERATIONAL, answer]
    bus.clock.run_until(bus.clock.now_ns + 10 * MS)
    assert bus.heard[-3:] == [answer, PRE_OPERATIONAL, PRE_OPERATIONAL]
    assert bus.after(0x605, "2b17100000000000", 20)[0] == answer
    assert bus.heard[-1] == answer


def test_a_node_with_inputs_has_no_emergencies_to_send(bus: Bus) -> None:
    """It has no 1014 (CiA 301: emergency object is optional); 1001 shows the error all the same."""
    IoNode(NODE, bus.network, bus.clock, bus.level)
    bus.clock.run_until(MS)
    bus.after(0, "0105")
    read = "4001100000000000"
    assert bus.after(0x605, read) == [(0x585, "4f01100000000000")]
    assert bus.after(0x80, "01") == []  # a SYNC with data
    assert bus.after(0x605, read) == [(0x585, "4f01100011000000")]
    assert bus.after(0x80) == [(0x185, "00")]
    assert bus.after(0x605, read) == [(0x585, "4f01100000000000")]
    assert bus.after(0x605, "4014100000000000") == [(0x585, "8014100000000206")]
