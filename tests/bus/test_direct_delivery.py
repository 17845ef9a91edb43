"""Subscribers that the segment asks itself get what `deliver` would give them, whatever changes."""

import random
from collections.abc import Callable

import can
import canopen
import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.faults import Alter, Delay, Drop, Duplicate, ErrorAtBit, FaultAction
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import new_scheduler


class Pair:
    """A network that sends and one that hears; heard: (identifier, data, time in s)."""

    def __init__(self, segment: Segment) -> None:
        self.segment = segment
        self.sender_port, self.port = segment.port("sender"), segment.port("receiver")
        self.sender = SimNetwork(self.sender_port).connect()
        self.network = SimNetwork(self.port).connect()
        self.heard: list[tuple[int, bytes, float]] = []
        for can_id in (0x80, 0x181, 0x182):
            self.network.subscribe(can_id, self.take)

    def take(self, can_id: int, data: bytearray, time_s: float) -> None:
        self.heard.append((can_id, bytes(data), time_s))

    def send(self, *can_ids: int) -> list[int]:
        """Send frames and return the identifiers of those that were taken."""
        self.heard.clear()
        for can_id in can_ids:
            self.sender.send_message(can_id, b"\x01\x02")
        self.segment.scheduler.run_until(self.segment.now_ns + MS)
        return [can_id for can_id, _, _ in self.heard]


@pytest.fixture
def pair(segment: Segment) -> Pair:
    return Pair(segment)


def test_a_network_alone_is_asked_directly(pair: Pair) -> None:
    assert pair.port.direct is not None
    assert pair.send(0x80, 0x181, 0x300) == [0x80, 0x181]
    assert pair.heard[0][1] == b"\x01\x02"


def test_a_filter_that_comes_later_holds(pair: Pair) -> None:
    pair.send(0x80)
    pair.port.set_filters([{"can_id": 0x181, "can_mask": 0x7FF}])
    assert pair.send(0x80, 0x181) == [0x181]
    pair.port.filters = [{"can_id": 0x80, "can_mask": 0x7FF}]
    assert pair.send(0x80, 0x181) == [0x80]
    pair.port.set_filters(None)
    assert pair.port.direct is not None
    assert pair.send(0x80, 0x181) == [0x80, 0x181]


def test_callbacks_that_come_later_get_their_frames(pair: Pair) -> None:
    messages: list[int] = []
    data: list[int] = []
    pair.send(0x80)
    pair.port.attach(lambda msg: messages.append(msg.arbitration_id))
    assert pair.send(0x80) == [0x80]
    pair.port.attach_data(lambda can_id, *_: data.append(can_id))
    assert pair.send(0x181) == [0x181]
    assert (messages, data) == ([0x80, 0x181], [0x181])


def test_a_network_that_is_not_alone_is_no_less_served(segment: Segment) -> None:
    data: list[int] = []
    port = segment.port("receiver")
    port.attach_data(lambda can_id, *_: data.append(can_id))
    network = SimNetwork(port).connect()
    taken: list[int] = []
    network.subscribe(0x80, lambda can_id, *_: taken.append(can_id))
    segment.port("sender").send_raw(0x80, b"")
    segment.scheduler.run_until(MS)
    assert (data, taken, network.scanner.nodes) == ([0x80], [0x80], [])


def test_subscriptions_may_change_at_any_time(pair: Pair) -> None:
    pair.network.unsubscribe(0x80, pair.take)
    assert pair.send(0x80, 0x181) == [0x181]
    pair.network.subscribe(0x300, pair.take)
    pair.network.unsubscribe(0x181)
    assert pair.send(0x181, 0x300) == [0x300]


def test_extended_and_remote_frames_pass_for_no_telegram(pair: Pair) -> None:
    pair.sender_port.send(can.Message(arbitration_id=0x80, is_extended_id=True, data=b"\x01"))
    pair.sender_port.send(
        can.Message(arbitration_id=0x80, is_extended_id=False, is_remote_frame=True, dlc=1)
    )
    assert pair.send() == []
    pair.network.subscribe(0x1_0080, pair.take)
    assert pair.send(0x1_0080) == [0x1_0080]


def test_after_its_end_a_port_hears_nothing(pair: Pair) -> None:
    pair.segment.port("third")
    pair.sender.send_message(0x80, b"")
    pair.port.shutdown()
    assert pair.send(0x181) == []
    assert pair.port.direct is None


def test_each_subscriber_of_a_port_has_the_data_of_the_frame(pair: Pair) -> None:
    """canopen's PdoMap writes into the buffer it gets: no other port may see that."""
    other = SimNetwork(pair.segment.port("other")).connect()
    seen: list[bytes] = []

    def spoil(_can_id: int, data: bytearray, _time_s: float) -> None:
        data[0] = 0xFF

    pair.network.subscribe(0x80, spoil)
    other.subscribe(0x80, lambda _id, data, _time: seen.append(bytes(data)))
    pair.send(0x80)
    assert seen == [b"\x01\x02"]


def faulty(numbers: random.Random) -> Callable[[Frame, Controller, int], FaultAction | None]:
    def fault(frame: Frame, _port: Controller, attempt: int) -> FaultAction | None:
        if attempt or numbers.random() > 0.2:
            return None
        return numbers.choice(
            [
                Alter(numbers.randbytes(len(frame.data))),
                Drop(),
                ErrorAtBit(numbers.randint(1, 60)),
                Duplicate(numbers.randrange(MS)),
                Delay(numbers.randrange(MS)),
            ]
        )

    return fault


@pytest.mark.parametrize("seed", range(8))
def test_random_traffic_with_faults_is_heard_as_through_deliver(seed: int) -> None:
    """Frame by frame the same at each node, with a fault that begins in the middle."""

    def heard(is_direct: bool) -> list[tuple[int, str, int, bytes, float]]:
        found: list[tuple[int, str, int, bytes, float]] = []
        numbers, scheduler = random.Random(seed), new_scheduler()
        with Segment("random", 1_000_000, scheduler) as segment:
            networks = {}
            for name in "abc":
                port = segment.port(name)
                networks[name] = SimNetwork(port).connect()
                if not is_direct:
                    port.attach(lambda _msg: None)
                assert (port.direct is not None) == is_direct
                for can_id in range(0x80, 0x84):
                    networks[name].subscribe(
                        can_id,
                        lambda can_id, data, time_s, name=name: found.append(
                            (scheduler.now_ns, name, can_id, bytes(data), time_s)
                        ),
                    )
            for _ in range(400):
                name, can_id = numbers.choice("abc"), numbers.randrange(0x80, 0x86)
                data = numbers.randbytes(numbers.randrange(9))
                scheduler.call_at(
                    numbers.randrange(40 * MS),
                    Phase.APPLICATION,
                    lambda n=name, i=can_id, d=data: networks[n].send_message(i, d),
                )
            scheduler.run_until(20 * MS)
            segment.add_fault(faulty(numbers))
            scheduler.run_until(60 * MS)
        return found

    direct = heard(True)
    assert direct == heard(False)
    assert len(direct) > 300


# canopen's scanner


def scan(network: canopen.Network, *can_ids: int) -> None:
    """What canopen's own network does with frames."""
    for can_id in can_ids:
        network.notify(can_id, bytearray(), 0.0)


def test_the_scanner_finds_what_canopens_finds_in_its_order(pair: Pair) -> None:
    numbers = random.Random(1)
    can_ids = [numbers.randrange(0x800) for _ in range(60)]
    plain = canopen.Network()
    for can_id in can_ids:
        pair.send(can_id)
        scan(plain, can_id)
    assert pair.network.scanner.nodes == plain.scanner.nodes
    assert len(plain.scanner.nodes) > 10


def test_a_scanner_that_is_reset_finds_only_what_comes_then(pair: Pair) -> None:
    scanner = pair.network.scanner
    pair.send(0x705)
    scanner.reset()
    assert scanner.nodes == []
    pair.send(0x706, 0x705)
    assert sorted(scanner.nodes) == [5, 6]
    scanner.nodes.remove(5)
    assert scanner.nodes == [6]
    pair.send(0x705)
    assert scanner.nodes == [6, 5]
    scanner.nodes = [9]
    assert scanner.nodes == [9]


def test_a_search_asks_every_node_and_finds_the_one_that_answers(pair: Pair) -> None:
    pair.network[5] = canopen.LocalNode(5, canopen.ObjectDictionary())
    pair.sender.scanner.search(limit=8)
    pair.segment.scheduler.run_until(pair.segment.now_ns + 10 * MS)
    assert pair.sender.scanner.nodes == [5]
