"""Telegrams of a node with digital inputs at stated instants, and what its PLC makes of them.

They come to the subscribers of the PLC's network as frames from a bus would, without a bus.
"""

from collections.abc import Iterator

import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.machine.canopen.io_terminal import IoTerminal
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

NODE, FIRST_NS, LAST_NS = 20, 99 * US, 600 * US


class Signal:
    """An input that nothing comes to."""

    level = False
    edges = ()


class Plc:
    """The PLC's end of a node with inputs 1 and 2, which is operational from the begin on."""

    def __init__(self, segment: Segment, heartbeat_ms: int = 0) -> None:
        self.clock = segment.scheduler
        self.network = SimNetwork(segment.port("cnc")).connect()
        self.terminal = IoTerminal(
            TerminalTable.model_validate(
                {"segment": "can1", "node": NODE, "heartbeat_ms": heartbeat_ms}
                | {"input_1": "p1", "input_2": "p2"}
            ),
            {"p1": Signal(), "p2": Signal()},
            self.clock,
            node_port=SimNetwork(segment.port("io")).connect(),
            master=self.network,
            advance=lambda _: None,
            telegrams=NodeTelegrams("can1", 0x180 + NODE, MS, FIRST_NS, LAST_NS),
        )
        self.terminal.node.power_off()  # what comes is what a test lets come
        self.alive()

    def alive(self) -> None:
        self.network.notify(0x700 + NODE, bytearray(b"\5"), 0.0)

    def comes(self, time_ns: int, *data: int) -> None:
        """Let a telegram with these bytes come."""
        self.clock.run_until(time_ns)
        self.network.notify(0x180 + NODE, bytearray(data), time_ns * 1e-9)

    def read(self, time_ns: int) -> tuple[int, int]:
        """A cycle of the PLC: working counter state, and the levels as bits from input 1 on."""
        self.clock.run_until(time_ns)
        self.terminal.exchange_until(time_ns)
        levels = self.terminal.image.items()
        return self.terminal.wc_state, sum(seen.input << n - 1 for n, seen in levels)


@pytest.fixture
def segment() -> Iterator[Segment]:
    with Segment("can1", 1_000_000, new_scheduler()) as made:
        yield made


@pytest.mark.parametrize("levels", range(4))
def test_each_input_has_its_bit(segment: Segment, levels: int) -> None:
    """The bits of the others of the 8 are nobody's."""
    plc = Plc(segment)
    plc.comes(5 * MS + 200 * US, levels | 0b1010_0100)
    assert plc.read(5 * MS + 300 * US) == (0, levels)
    plc.comes(6 * MS + 200 * US, levels ^ 3)
    assert plc.read(6 * MS + 300 * US) == (0, levels ^ 3)


@pytest.mark.parametrize(
    ("after_ns", "counts"),
    [
        *((0, False), (FIRST_NS - 1, False), (FIRST_NS, True)),
        *((LAST_NS, True), (LAST_NS + 1, False), (MS - 1, False)),
    ],
)
def test_an_answer_comes_neither_before_its_frames_nor_after_the_nc_cycle(
    segment: Segment, after_ns: int, counts: bool
) -> None:
    """Both instants are inside."""
    plc = Plc(segment)
    plc.comes(5 * MS + 200 * US, 1)
    plc.comes(6 * MS + after_ns, 2)
    assert plc.read(6 * MS + max(after_ns, 700 * US)) == (0, 2 if counts else 1)


@pytest.mark.parametrize("data", [(), (2, 0), (2, 2, 2)])
def test_a_telegram_of_another_length_is_none(segment: Segment, data: tuple[int, ...]) -> None:
    plc = Plc(segment)
    plc.comes(5 * MS + 200 * US, 1)
    plc.comes(6 * MS + 200 * US, *data)
    assert plc.read(6 * MS + 300 * US) == (0, 1)
    plc.comes(6 * MS + 400 * US, 2)  # the first of this SYNC
    assert plc.read(6 * MS + 500 * US) == (0, 2)


@pytest.mark.parametrize(("more_ns", "state"), [(-1, 0), (0, 0), (1, 1)])
def test_the_node_is_lost_after_three_periods_without_and_one(
    segment: Segment, more_ns: int, state: int
) -> None:
    """`missing_cycles` is 3: more than 4 periods from one telegram on."""
    plc = Plc(segment)
    plc.comes(5 * MS + 200 * US, 1)
    assert plc.read(9 * MS + 200 * US + more_ns) == (state, 1)


@pytest.mark.parametrize(("heartbeat_ms", "more_ns", "state"), [
    (10, -1, 0), (10, 0, 0), (10, 1, 1), (2, 0, 0), (2, 1, 1), (0, 500 * MS, 0)
])  # fmt: skip
def test_the_node_is_lost_without_a_heartbeat_for_twice_its_time(
    segment: Segment, heartbeat_ms: int, more_ns: int, state: int
) -> None:
    """Its telegrams still come. With 0 it has no heartbeat."""
    plc = Plc(segment, heartbeat_ms)
    plc.clock.run_until(30 * MS)
    plc.alive()
    until_ns = 30 * MS + 2 * heartbeat_ms * MS + more_ns
    for period in range(30, until_ns // MS):
        plc.comes(period * MS + 200 * US, 1)
    assert plc.read(until_ns) == (state, 1)
    plc.alive()
    assert plc.read(until_ns) == (0, 1)


@pytest.mark.parametrize("third", [1, 2, 3])
def test_whatever_comes_after_two_that_differ_that_sync_has_no_answer(
    segment: Segment, third: int
) -> None:
    plc = Plc(segment)
    plc.comes(5 * MS + 200 * US, 0)
    for after_us, levels in ((200, 1), (300, 2), (400, third), (500, 0)):
        plc.comes(6 * MS + after_us * US, levels)
    assert plc.read(6 * MS + 700 * US) == (0, 0)
    plc.comes(7 * MS + 200 * US, 3)
    assert plc.read(7 * MS + 700 * US) == (0, 3)


@pytest.mark.parametrize(
    ("read_us", "is_misled"), [(199, False), (200, True), (250, True), (300, False)]
)
def test_who_has_read_the_first_of_two_that_differ_learns_it_once(
    segment: Segment, read_us: int, is_misled: bool
) -> None:
    """They come at 200 and 300 us; who reads at the instant of one has read it.

    The cycle after it sees that it was misled, also where a third one comes behind that; the one
    after is not concerned any more.
    """
    plc = Plc(segment)
    plc.comes(5 * MS + 200 * US, 0)
    at_ns = 6 * MS + read_us * US
    for after_us, levels in ((200, 1), (300, 2)):
        if at_ns < 6 * MS + after_us * US:
            plc.read(at_ns)
            at_ns = 1 << 62
        plc.comes(6 * MS + after_us * US, levels)
    if at_ns < 1 << 62:
        plc.read(at_ns)
        at_ns = 1 << 62
    assert plc.read(6 * MS + 350 * US) == (int(is_misled), 0)
    plc.comes(6 * MS + 400 * US, 2)
    plc.comes(7 * MS + 200 * US, 2)
    assert plc.read(7 * MS + 350 * US) == (0, 2)
