"""Random frames from a stranger: no exception, and the drive still answers afterwards."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

NODE = 3
IDENTIFIERS = (
    0x000, 0x080, 0x081, 0x083, 0x183, 0x203, 0x303, 0x403, 0x503, 0x583, 0x603, 0x703, 0x705, 0x7E5
)  # fmt: skip
OBJECTS = (
    0x1003, 0x1005, 0x1006, 0x1007, 0x1008, 0x100C, 0x100D, 0x1010, 0x1011, 0x1014, 0x1015, 0x1016,
    0x1017, 0x1019, 0x1020, 0x1021, 0x1029, 0x1400, 0x1401, 0x1600, 0x1601, 0x1800, 0x1801, 0x1802,
    0x1803, 0x1A00, 0x1A03, 0x6040, 0x6060, 0x607A, 0x60B8, 0x6041, 0x6065, 0x6083, 0x60C2, 0x60FF,
)  # fmt: skip
VALUES = st.one_of(
    st.integers(0, 0xFFFF_FFFF),
    st.sampled_from(
        [0, 1, 2, 240, 255, 0x65766173, 0x64616F6C, 0x80, 0x203, 0x8000_0203, 0x4000_0183, 0x483,
         0x60410010, 0x60640020, 0x607A0020, 0x00050008, 5 << 16 | 3]
    ),
)  # fmt: skip


@st.composite
def sdo_requests(draw: st.DrawFn) -> tuple[int, bytes]:
    """A request that is likely to mean something."""
    head = draw(st.sampled_from([0x22, 0x23, 0x27, 0x2B, 0x2F, 0x21, 0x20, 0x40, 0x60, 0x70, 0xA0,
                                 0xA4, 0xA3, 0xA2, 0xA1, 0xC2, 0xC6, 0xC1, 0xD5, 0x80, 0x00, 0x01,
                                 0x0F, 0x1D, 0x81, 0x82]))  # fmt: skip
    index, sub = draw(st.sampled_from(OBJECTS)), draw(st.integers(0, 9))
    data = draw(VALUES).to_bytes(4, "little")
    return 0x600 + NODE, bytes((head, index & 0xFF, index >> 8, sub)) + data


COMMANDS = [bytes((command, node)) for command in (1, 2, 128, 129, 130) for node in (0, NODE)]
TARGETS = [bytes((word, 0, 0, 0, 0, 0, 0, 0)) for word in (0x06, 0x07, 0x0F, 0x80)]
LSS = [0x04, 0x11, 0x13, 0x17, 0x40, 0x46, 0x51, 0x5A, 0x5E]
LSS_REQUESTS = st.builds(
    lambda command, data: bytes((command, *data)),
    st.sampled_from(LSS),
    st.binary(min_size=7, max_size=7),
)
ANY_SDO = st.tuples(st.just(0x603), st.binary(min_size=8, max_size=8))
FRAMES = st.one_of(
    sdo_requests(),
    ANY_SDO,
    st.tuples(st.sampled_from(IDENTIFIERS), st.binary(max_size=8)),
    st.tuples(st.just(0), st.sampled_from(COMMANDS)),
    st.tuples(st.just(0x80), st.just(b"")),
    st.tuples(st.just(0x203), st.sampled_from(TARGETS)),
    st.tuples(st.just(0x7E5), LSS_REQUESTS),
)


class Bus:
    """A drive and the raw port of a stranger."""

    def __init__(self, axis: Any) -> None:
        self.scheduler = new_scheduler()
        self.segment = Segment("fuzz", 1_000_000, self.scheduler)
        network = SimNetwork(self.segment.port("drive")).connect()
        self.node = DriveNode("Z", NODE, network, self.scheduler, axis)
        self.port = self.segment.port("stranger")
        self.heard: list[tuple[int, bytes]] = []
        self.port.attach_data(lambda can_id, data, _time: self.heard.append((can_id, data)))
        self.run(MS)

    def run(self, time_ns: int) -> None:
        self.scheduler.run_until(self.scheduler.now_ns + time_ns)

    def close(self) -> None:
        self.segment.close()


def ends_well(bus: Bus) -> None:
    """After power off and on a drive of number `node_id` boots and reads 1000 as ever."""
    bus.node.slave.lss_settings.stored_node_id = NODE
    bus.node.slave.lss_settings.stored_bit_rate = None
    bus.node.restart()
    bus.run(MS)
    assert (0x700 + NODE, b"\0") in bus.heard
    bus.port.send_raw(0x603, bytes.fromhex("4000100000000000"))
    bus.run(2 * MS)
    assert bus.heard[-1] == (0x583, bytes.fromhex("4300100092010200"))


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(frames=st.lists(st.tuples(FRAMES, st.integers(1, 3_000_000)), max_size=40))
@pytest.mark.long
def test_any_frames_in_any_order(
    fake_axis: Callable[..., Any], frames: list[tuple[tuple[int, bytes], int]]
) -> None:
    bus = Bus(fake_axis())
    try:
        for (can_id, data), pause_ns in frames:
            bus.port.send_raw(can_id, data)
            bus.run(pause_ns)
        bus.run(1100 * MS)
        ends_well(bus)
    finally:
        bus.close()


@pytest.mark.long
@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(request=st.one_of(sdo_requests(), ANY_SDO))
def test_every_sdo_request_of_8_bytes_gets_one_answer_at_most(
    fake_axis: Callable[..., Any], request: tuple[int, bytes]
) -> None:
    """In pre-operational, without a transfer under way: one answer, none to an abort."""
    bus = Bus(fake_axis())
    try:
        bus.heard.clear()
        bus.port.send_raw(*request)
        bus.run(5 * MS)
        answers = [data for can_id, data in bus.heard if can_id == 0x583]
        assert len(answers) == (0 if request[1][0] >> 5 == 4 else 1)
        assert all(len(data) == 8 for data in answers)
    finally:
        bus.close()
