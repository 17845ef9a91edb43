"""What the kernel itself sends on CAN: the SYNC of each cycle, its heartbeat on every segment."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.carrier import CanCarrier, HeartbeatProducer
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

SYNC, HEARTBEAT_OF_127 = 0x80, 0x77F
OPERATIONAL = 5


class Network:
    """Keeps what is sent, with its time where there is a clock."""

    def __init__(self, clock: Any = None, bus: Any = None) -> None:
        self._clock, self.bus = clock, bus
        self.sent: list[tuple[int, bytes]] = []
        self.times_ns: list[int] = []

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        assert not remote
        self.sent.append((can_id, bytes(data)))
        if self._clock is not None:
            self.times_ns.append(self._clock.now_ns)


def test_the_heartbeat_goes_out_on_every_segment_from_begin_to_end() -> None:
    """CiA 301: 0x700 + node, one byte with the state, once per period."""
    clock = new_scheduler()
    networks = [Network(clock) for _ in range(3)]
    producer = HeartbeatProducer(networks, clock, 127, 50)
    clock.run_until(10 * MS)
    producer.begin()
    producer.begin()  # it goes out already
    clock.run_until(120 * MS)
    producer.end()
    clock.run_until(300 * MS)
    for network in networks:
        assert network.times_ns == [10 * MS, 60 * MS, 110 * MS]
        assert set(network.sent) == {(HEARTBEAT_OF_127, bytes((OPERATIONAL,)))}
    producer.begin()
    clock.run_until(360 * MS)
    for network in networks:
        assert network.times_ns[3:] == [300 * MS, 350 * MS]
    producer.end()  # and on again before the next one was due
    producer.begin()
    clock.run_until(470 * MS)
    for network in networks:
        assert network.times_ns[5:] == [360 * MS, 410 * MS, 460 * MS]


def test_there_is_no_heartbeat_without_a_period() -> None:
    clock = new_scheduler()
    network = Network(clock)
    HeartbeatProducer([network], clock, 127, 0).begin()
    clock.run_until(100 * MS)
    assert network.sent == []


@pytest.mark.parametrize(
    ("overflow", "data"), [(0, [b""] * 7), (3, [bytes((n,)) for n in (1, 2, 3, 1, 2, 3, 1)])]
)
def test_a_sync_counts_from_1_to_its_overflow_value(overflow: int, data: list[bytes]) -> None:
    """1019; 0: it carries nothing."""
    network = Network()
    carrier = CanCarrier(network, overflow)
    for _ in range(7):
        carrier.begin_cycle()
    assert network.sent == [(SYNC, each) for each in data]


def test_a_controller_that_is_asked_is_bus_off_as_long_as_it_says_so() -> None:
    bus = SimpleNamespace(channel_info="can7", state=SimpleNamespace(name="ACTIVE"))
    carrier = CanCarrier(Network(bus=bus))
    assert carrier.check() is None
    bus.state = SimpleNamespace(name="ERROR")
    alarm = carrier.check()
    assert alarm is not None
    assert (alarm.id, alarm.values) == (900030, {"segment": "can7"})
    bus.state = SimpleNamespace(name="PASSIVE")
    assert carrier.check() is None


def test_a_controller_that_says_it_once_stays_bus_off() -> None:
    heard: list[Any] = []
    pending = [(0, 0, 0, 0, SimpleNamespace(arbitration_id=SYNC + 1))]
    bus = SimpleNamespace(channel_info="can1", on_bus_off=heard.append, pending=pending)
    carrier = CanCarrier(Network(bus=bus))
    assert (carrier.check(), carrier.holds_back) == (None, False)
    pending.append((0, 0, 0, 0, SimpleNamespace(arbitration_id=SYNC)))
    assert carrier.holds_back
    heard[0]()
    alarm = carrier.check()
    assert alarm is not None
    assert (alarm.id, carrier.late().id) == (900030, 900031)
