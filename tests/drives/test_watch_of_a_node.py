"""What the control hears of a node beside its PDOs: boot-up, heartbeat, node guarding (CiA 301)."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.drives.test_link_by_hand import OPERATION_ENABLED, _link

from axisrig.kernel.drives.canopen.watch import LinkWatch, WatchSettings
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

BOOT_UP, STOPPED, OPERATIONAL, PRE_OPERATIONAL = 0, 4, 5, 127
TOGGLE = 0x80
HEARTBEAT = WatchSettings(heartbeat_ns=40 * MS)
GUARDING = WatchSettings(guard_ns=10 * MS, life_factor=3)


class Node:
    """A watch over the drive of node 3, and what it hears and sends."""

    def __init__(self, settings: WatchSettings) -> None:
        self.clock = new_scheduler()
        self.link, self.wire = _link(jump_mm=1.0)
        self.asked: list[tuple[int, int, int, bool]] = []
        self.wire.send_message = self.send  # type: ignore[assignment]
        self.watch = LinkWatch(self.link, self.clock, settings)
        self.watch.begin()

    def send(self, can_id: int, data: Any, remote: bool = False) -> None:
        self.asked.append((self.clock.now_ns, can_id, len(data), remote))

    def hear(self, *states: int) -> Alarm | None:
        """Bytes of error control, one telegram each, and what is wrong after them."""
        for state in states:
            self.wire._bring(0x703, bytes((state,)))
        return self.watch.communication()

    def wait(self, time_ns: int) -> Alarm | None:
        self.clock.run_until(self.clock.now_ns + time_ns)
        return self.watch.communication()


def ids(*alarms: Alarm | None) -> list[int | None]:
    return [alarm and alarm.id for alarm in alarms]


@pytest.mark.parametrize(("state", "name"), [(STOPPED, "stopped"), (PRE_OPERATIONAL, None)])
def test_a_node_that_leaves_operational_is_an_alarm_until_it_is_back(
    state: int, name: str | None
) -> None:
    node = Node(HEARTBEAT)
    assert node.hear(OPERATIONAL) is None
    found = node.hear(state)
    assert found is not None
    assert (found.id, found.values["node"], found.values["state"]) == (
        900034, 3, name or "pre-operational",
    )  # fmt: skip
    assert node.hear(OPERATIONAL) is None
    assert ids(node.hear(state)) == [900034]
    node.watch.begin()
    assert node.watch.communication() is None


def test_a_heartbeat_from_before_the_start_does_not_count() -> None:
    """It may still be on its way when the command to start is out."""
    node = Node(HEARTBEAT)
    for _ in range(2):
        assert node.hear(PRE_OPERATIONAL, STOPPED) is None
        assert ids(node.hear(OPERATIONAL, PRE_OPERATIONAL)) == [900034]
        node.watch.end()
        node.watch.begin()  # after the next start


@pytest.mark.parametrize("settings", [HEARTBEAT, GUARDING, WatchSettings()])
def test_a_boot_up_is_an_alarm_whatever_comes_after_it(settings: WatchSettings) -> None:
    node = Node(settings)
    node.hear(OPERATIONAL)
    node.wire.status(OPERATION_ENABLED, 0)
    node.wire.latch()
    node.link.take()
    assert node.link.power is Power.OPERATING
    assert ids(node.hear(BOOT_UP), node.hear(PRE_OPERATIONAL), node.hear(OPERATIONAL)) == [
        900024, 900024, 900024,
    ]  # fmt: skip
    assert node.link.power is Power.OFF  # its words mean something else now
    node.watch.begin()
    assert node.watch.communication() is None


def test_the_time_without_a_heartbeat_begins_with_each_of_them() -> None:
    node = Node(HEARTBEAT)
    for _ in range(3):
        assert node.wait(40 * MS) is None
        assert node.hear(OPERATIONAL) is None
    assert node.wait(40 * MS) is None
    found = node.wait(1)
    assert found is not None
    assert (found.id, found.values["what"], found.values["ms"]) == (900023, "heartbeat", 40)
    assert node.hear(OPERATIONAL) is None


@pytest.mark.parametrize(("settings", "limit_ms"), [(HEARTBEAT, 40), (GUARDING, 30)])
@pytest.mark.parametrize("more_ms", [1, 35, 1000])
def test_an_alarm_says_how_long_the_node_has_been_silent(
    settings: WatchSettings, limit_ms: int, more_ms: int
) -> None:
    """Since it was heard last, not since the watch began; whole milliseconds."""
    node = Node(settings)
    node.wait(7 * MS)
    node.hear(OPERATIONAL)
    found = node.wait((limit_ms + more_ms) * MS + 999_999)
    assert found is not None
    assert (found.values["axis"], found.values["node"]) == ("Z", 3)
    assert found.values["ms"] == limit_ms + more_ms


def test_an_answer_that_stands_still_is_an_alarm_with_its_own_time() -> None:
    """The node is not silent then: its answers came 0 and 4 ms before."""
    node = Node(GUARDING)
    node.hear(OPERATIONAL)
    found = node.hear(OPERATIONAL)
    later = node.wait(4 * MS)
    assert found is not None
    assert later is not None
    assert [alarm.values["ms"] for alarm in (found, later)] == [0, 4]
    assert [alarm.values["what"] for alarm in (found, later)] == ["node guarding"] * 2


@pytest.mark.parametrize("data", [b"", b"\x05\x00"])
def test_a_telegram_of_another_length_is_no_heartbeat(data: bytes) -> None:
    node = Node(HEARTBEAT)
    node.clock.run_until(30 * MS)
    node.wire._bring(0x703, data)
    assert ids(node.wait(10 * MS + 1)) == [900023]


def test_without_a_limit_silence_is_no_alarm_and_a_jump_is() -> None:
    node = Node(WatchSettings())
    assert node.wait(10_000 * MS) is None
    for place in (0, 5000):
        node.wire.status(OPERATION_ENABLED, place)
        node.wire.latch()
        node.link.take()
    assert ids(node.watch.communication(), node.watch.communication()) == [900029, None]


def test_a_node_is_guarded_by_remote_requests_of_one_byte_from_begin_to_end() -> None:
    node = Node(GUARDING)
    node.clock.run_until(35 * MS)
    assert node.asked == [(at * MS, 0x703, 1, True) for at in (0, 10, 20, 30)]
    node.watch.end()
    node.clock.run_until(100 * MS)
    assert len(node.asked) == 4
    node.watch.begin()
    node.clock.run_until(104 * MS)
    node.watch.end()  # and on again before the next question was due
    node.watch.begin()
    node.clock.run_until(125 * MS)
    assert [at_ns // MS for at_ns, *_ in node.asked[4:]] == [100, 104, 114, 124]


def test_a_guarded_node_may_be_silent_for_its_life_time() -> None:
    """Guard time times life factor: 30 ms."""
    node = Node(GUARDING)
    assert node.wait(30 * MS) is None
    found = node.wait(1)
    assert found is not None
    assert (found.id, found.values["what"], found.values["ms"]) == (900023, "node guarding", 30)


def test_the_toggle_bit_of_a_guarded_node_has_to_alternate() -> None:
    """One that stands still is an answer that was not made anew; it counts until it alternates."""
    node = Node(GUARDING)
    first, second = OPERATIONAL, OPERATIONAL | TOGGLE
    assert ids(node.hear(first), node.hear(second), node.hear(first)) == [None] * 3
    assert ids(node.hear(first), node.hear(second), node.hear(second)) == [900023, None, 900023]
    assert ids(node.hear(first), node.hear(first)) == [None, 900023]
    node.watch.begin()
    assert node.watch.communication() is None  # what stood still was before
    assert node.hear(first) is None  # the first answer of a guarding has nothing before it


def test_the_states_of_a_guarded_node_are_read_without_their_toggle_bit() -> None:
    node = Node(GUARDING)
    node.hear(OPERATIONAL)
    found = node.hear(PRE_OPERATIONAL | TOGGLE)
    assert found is not None
    assert (found.id, found.values["state"]) == (900034, "pre-operational")


def test_what_is_heard_before_begin_and_after_end_counts_for_nothing() -> None:
    heard: dict[int, Any] = {}
    network = SimpleNamespace(subscribe=heard.__setitem__)
    forgotten: list[bool] = []
    link: Any = SimpleNamespace(
        name="Z", node_id=3, network=network, jump_mm=None, begin=lambda: None,
        forget=lambda: forgotten.append(True), power=Power.OPERATING,
    )  # fmt: skip
    watch = LinkWatch(link, new_scheduler(), HEARTBEAT)
    hear = heard[0x703]
    hear(0x703, bytearray((BOOT_UP,)), 0.0)
    watch.begin()
    assert watch.communication() is None
    watch.end()
    hear(0x703, bytearray((BOOT_UP,)), 0.0)
    assert watch.communication() is None
    assert forgotten == []


@pytest.mark.parametrize(
    ("settings", "count"), [(HEARTBEAT, 0), (WatchSettings(), 0), (GUARDING, 1)]
)
def test_a_node_is_asked_for_its_state_where_it_is_guarded(
    settings: WatchSettings, count: int
) -> None:
    """With the begin of each watch; a node that sends a heartbeat, or neither, is never asked."""
    node = Node(settings)
    assert node.asked == [(0, 0x703, 1, True)] * count
    node.watch.end()
    node.watch.begin()
    assert len(node.asked) == 2 * count
