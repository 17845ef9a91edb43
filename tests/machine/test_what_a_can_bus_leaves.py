"""What the CAN buses of a run leave: waits and states of their figures, cyclic values, SYNCs."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.machine.made_rigs import above, settings_of
from tests.machine.test_cyclic_values import frame_of, link_of, lists, sent

from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.machine.canopen.bus_figures import _figures
from axisrig.bench.machine.canopen.family import CanBuses
from axisrig.bench.machine.canopen.links import build_carriers, build_links
from axisrig.bench.machine.canopen.telegram_log import TelegramLog
from axisrig.bench.record.series import TARGET
from axisrig.bench.rig.canopen.answers import first_answer_ns
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


def test_of_waits_that_are_as_long_the_lowest_identifier_comes_first() -> None:
    """Whatever their names: each frame was alone on the bus."""
    names = {0x201: ("A", ""), 0x181: ("Z", "Z"), 0x080: ("SYNC", "")}
    scheduler = new_scheduler()
    with Segment("can1", 1_000_000, scheduler) as segment:
        port = segment.port("one")
        segment.port("other")
        for number, can_id in enumerate(names):
            send = lambda can_id=can_id: port.send_raw(can_id, b"")  # noqa: E731
            scheduler.call_at((1 + number) * MS, Phase.APPLICATION, send)
        scheduler.run_until(9 * MS)
        found = _figures(segment, names, "")
    assert [(each.name, each.worst_us) for each in found.waiting] == [
        ("SYNC", 0.0), ("Z", 0.0), ("A", 0.0)
    ]  # fmt: skip


def test_who_is_error_passive_is_not_active() -> None:
    """A sender alone counts 8 for each frame that nobody acknowledges, up to 128 (ISO 11898-1)."""
    scheduler = new_scheduler()
    with Segment("can1", 1_000_000, scheduler) as segment:
        segment.port("alone").send_raw(0x181, b"")
        scheduler.run_until(5 * MS)
        passive = _figures(segment, {}, "")
        segment.port("other")
        scheduler.run_until(9 * MS)
        found = _figures(segment, {}, "")
    assert passive.counters == (("alone", 128, 0, "error passive"),)
    states = [(change.port, change.state, change.is_active) for change in found.changes]
    assert states == [("alone", "error passive", False), ("alone", "error active", True)]


# --- cyclic values of telegrams


NODE = NodeTelegrams("can1", 0x194, MS, 99 * US, 600 * US)


def inputs(log: TelegramLog, *times_ns: int, is_last: bool = False) -> list[list[int]]:
    columns = log.take_columns(np.array(times_ns, dtype=np.int64), is_last=is_last)
    found: list[list[int]] = columns["plc.inputs_frame_ns"].to_pylist()
    return found


def test_inputs_of_a_node_are_those_of_its_own_bus_whole_and_not_destroyed() -> None:
    taken: list[Any] = []
    journal: Any = SimpleNamespace(add=taken.append, drain=lambda: None)
    log = TelegramLog([], journal, NODE)
    good = frame_of(0x194, b"\1")
    taken[0]([
        (1 * MS + 300 * US, "can1", good, False),
        (2 * MS + 300 * US, "can2", good, False),
        (3 * MS + 300 * US, "can1", good, True),
        (4 * MS + 300 * US, "can1", frame_of(0x194, b"\1\2"), False),
        (5 * MS + 300 * US, "can1", frame_of(0x195, b"\1"), False),
        (6 * MS + 300 * US, "can1", good, False),
    ])  # fmt: skip
    assert inputs(log, 9 * MS, is_last=True) == [[1_300_000, 6_300_000]]


def test_what_ends_at_the_instant_of_a_row_belongs_to_it_alone() -> None:
    """Also where that row is the last one of its block."""
    taken: list[Any] = []
    journal: Any = SimpleNamespace(add=taken.append, drain=lambda: None)
    log = TelegramLog([], journal, NODE)
    at_ns = [period * MS + 300 * US for period in (1, 2, 3)]
    taken[0]([(each, "can1", frame_of(0x194, b"\1"), False) for each in at_ns])
    assert inputs(log, *at_ns[:2]) == [[at_ns[0]], [at_ns[1]]]
    assert inputs(log, at_ns[1] + 1, at_ns[2]) == [[], [at_ns[2]]]
    assert inputs(log, at_ns[2] + 1, is_last=True) == [[]]


@pytest.mark.parametrize("more", [-1, 0, 1])
def test_a_telegram_of_a_drive_has_its_own_length(more: int) -> None:
    taken: list[Any] = []
    journal: Any = SimpleNamespace(add=taken.append, drain=lambda: None)
    link = link_of("Z", 3)
    log = TelegramLog([("can1", link)], journal)
    can_id, data = sent(link, TARGET, -5)
    given = data[:more] if more < 0 else data + bytes(more)
    taken[0]([(1 * MS, "can1", frame_of(can_id, given), False)])
    columns = log.take_columns(np.array([2 * MS]), is_last=True)
    assert lists(columns, "Z", TARGET) == [[] if more else [(1 * MS, -5)]]


# --- what the control sends


class Network:
    """A segment that keeps what is sent on it."""

    bus = None

    def __init__(self) -> None:
        self.sent: list[tuple[int, bytes]] = []

    def subscribe(self, *_: Any) -> None:
        pass

    def send_message(self, can_id: int, data: bytes) -> None:
        self.sent.append((can_id, bytes(data)))


@pytest.mark.parametrize(("overflow", "data"), [(0, [b""] * 4), (3, [b"\1", b"\2", b"\3", b"\1"])])
def test_each_bus_counts_its_syncs_as_the_rig_has_it(
    tmp_path: Path, overflow: int, data: list[bytes]
) -> None:
    settings = settings_of(above(tmp_path, "probe-xyz.toml", f"[cycle]\nsync_counter = {overflow}"))
    networks = {name: Network() for name in settings.segment}
    carriers = build_carriers(settings, networks)
    assert [*carriers] == [*settings.segment]
    for network, carrier in zip(networks.values(), carriers.values(), strict=True):
        for _ in data:
            carrier.begin_cycle()
        assert network.sent == [(0x080, each) for each in data]


def test_an_answer_of_so_many_bytes_has_its_own_first_instant(tmp_path: Path) -> None:
    """From 0 to 8 bytes, by the bus of the axis."""
    text = "[segment.can2]\nbitrate = 500000"
    settings = settings_of(above(tmp_path, "probe-xyz.toml", text))
    networks = {name: Network() for name in settings.segment}
    links = build_links(settings, networks, new_scheduler())
    for name, link in links.items():
        segment = settings.rig.axis[name].segment
        expected = tuple(first_answer_ns(settings, segment, size) for size in range(9))
        assert link.settings.answers_ns == expected
        assert list(expected) == sorted(set(expected))


def test_drives_that_nobody_leads_any_more_are_let_go_and_no_others() -> None:
    """NMT pre-operational (128) to each node on its own bus (CiA 301)."""
    networks = {name: Network() for name in ("can1", "can2")}
    buses: Any = SimpleNamespace(
        links={
            axis: SimpleNamespace(network=networks[on], node_id=node)
            for axis, on, node in (("X", "can1", 1), ("Y", "can2", 2), ("Z", "can2", 3))
        }
    )
    CanBuses.let_go(buses, ["Z", "X"])
    assert networks["can1"].sent == [(0, bytes([128, 1]))]
    assert networks["can2"].sent == [(0, bytes([128, 3]))]


@pytest.mark.parametrize("attempts", [1, 2, 4])
def test_a_question_by_sdo_is_begun_as_often_as_the_rig_has_it(attempts: int) -> None:
    """Each time for sdo_timeout_ms; then the server of the drive counts as silent."""
    keys = f"drive:servo.sdo_attempts={attempts}", "drive:servo.sdo_timeout_ms=30"
    settings = settings_of("probe-z.toml", *keys)
    networks, clock = {name: Network() for name in settings.segment}, new_scheduler()
    link = build_links(settings, networks, clock)["Z"]
    answers = list[Any]()
    assert link.sdo is not None
    link.sdo.read(0x1000, 0, answers.append)
    (network,) = networks.values()
    request = (0x600 + link.node_id, bytes.fromhex("4000100000000000"))
    clock.run_until(attempts * 30 * MS - 1)
    assert (network.sent.count(request), answers) == (attempts, [])
    clock.run_until(attempts * 30 * MS)
    assert (network.sent.count(request), len(answers)) == (attempts, 1)


def test_drives_of_one_bus_share_its_room_for_sdo_and_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A transfer at standstill waits until every axis of its own bus is at rest."""
    text = '[axis.Z]\nsegment = "can1"'
    settings = settings_of(above(tmp_path, "probe-xyz.toml", text))
    shared = list[Any]()
    monkeypatch.setattr(
        "axisrig.bench.machine.canopen.links.StandstillRoom",
        lambda links: shared.append(links) or SimpleNamespace(),
    )
    networks = {name: Network() for name in settings.segment}
    build_links(settings, networks, new_scheduler())
    found = {name: [link.name for link in links] for name, links in zip(networks, shared,
             strict=True)}  # fmt: skip
    assert found == {"can1": ["X", "Z"], "can2": ["Y"], "can3": []}
