"""A node of a PLC with any number and two inputs; the drives of buses, each with its own parts."""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import can
import pytest
from tests.machine.made_rigs import above, settings_of

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.journal import Journal
from axisrig.bench.drive.canopen.io_node import IoNode
from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.machine.canopen import nodes
from axisrig.bench.machine.canopen.io_terminal import IoTerminal
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


class Signal:
    """A probe with edges that are known beforehand, the first one rising."""

    level = False

    def __init__(self, *edges_us: int) -> None:
        self.edges = [(at_us * US, number % 2 == 0) for number, at_us in enumerate(edges_us)]


class Plc:
    """A node on a bus of 1 Mbit/s with the PLC that starts it; heard: identifier and data."""

    def __init__(
        self, segment: Segment, node: int, signals: dict[str, Signal], **keys: Any
    ) -> None:
        self.clock, self.heard = segment.scheduler, list[tuple[int, bytes]]()
        segment.port("ear").attach_data(
            lambda can_id, data, _time: self.heard.append((can_id, bytes(data)))
        )
        self.master = SimNetwork(segment.port("cnc")).connect()
        self.sampled_ns: list[int] = []
        wired: Any = signals
        self.terminal = IoTerminal(
            TerminalTable.model_validate({"segment": "can1", "node": node} | keys),
            wired,
            self.clock,
            node_port=SimNetwork(segment.port("io")).connect(),
            master=self.master,
            advance=self.sampled_ns.append,
            telegrams=NodeTelegrams("can1", 0x180 + node, MS, 99 * US, 600 * US),
        )

    def syncs(self, first: int, last: int) -> None:
        for cycle in range(first, last + 1):
            self.clock.run_until(cycle * MS)
            self.master.send_message(0x80, b"")
        self.clock.run_until(last * MS + 900 * US)

    def levels(self) -> dict[int, bool]:
        return {number: state.input for number, state in self.terminal.image.items()}


@pytest.fixture
def segment() -> Iterator[Segment]:
    with Segment("can1", 1_000_000, new_scheduler()) as made:
        yield made


@pytest.mark.parametrize("node", [1, 35, 127])
@pytest.mark.parametrize("heartbeat_ms", [0, 300])
def test_the_plc_starts_the_node_by_its_number(
    segment: Segment, node: int, heartbeat_ms: int
) -> None:
    """CiA 301: 1000 is read, 1017 written (two bytes, the lower one first), NMT start sent."""
    plc = Plc(segment, node, {"p": Signal(3500)}, heartbeat_ms=heartbeat_ms, input_1="p")
    assert plc.terminal.node.node_id == node
    plc.syncs(3, 6)
    assert (plc.terminal.wc_state, plc.levels()) == (0, {1: True})
    write = (0x600 + node, bytes.fromhex("2b171000") + heartbeat_ms.to_bytes(4, "little"))
    assert (0x600 + node, bytes.fromhex("4000100000000000")) in plc.heard
    assert write in plc.heard
    assert (0x000, bytes((1, node))) in plc.heard
    data = [data for can_id, data in plc.heard if can_id == 0x180 + node]
    assert data[-3:] == [b"\1"] * 3
    assert not [can_id for can_id, _ in plc.heard if can_id & 0x7F not in (0, node)]


@pytest.mark.parametrize("inputs", [(1, 2), (2, 1)])
def test_each_input_has_its_own_signal_and_both_are_in_one_telegram(
    segment: Segment, inputs: tuple[int, int]
) -> None:
    """One signal is on from 3.5 to 5.5 ms, the other from 4.5 ms on; bit n - 1 is input n."""
    signals = {"a": Signal(3500, 5500), "b": Signal(4500)}
    first, second = inputs
    plc = Plc(segment, 9, signals, **{f"input_{first}": "a", f"input_{second}": "b"})
    found = []
    for cycle in range(3, 8):
        plc.syncs(cycle, cycle)
        found.append((plc.levels()[first], plc.levels()[second]))
    assert found == [
        (False, False), (True, False), (True, True), (False, True), (False, True)
    ]  # fmt: skip
    bits = [data[0] for can_id, data in plc.heard if can_id == 0x189][-5:]
    one, other = 1 << first - 1, 1 << second - 1
    assert bits == [0, one, one | other, other, other]
    assert [at_ns // MS for at_ns in plc.sampled_ns[-5:]] == [3, 4, 5, 6, 7]


@pytest.mark.parametrize(
    ("edges_us", "bits"),
    [
        ((3100,), [0, 0, 0, 1, 1]), ((3100, 3900), [0, 0, 0, 0, 0]),
        ((3100, 5000), [0, 0, 0, 0, 0]), ((2900, 4900), [0, 0, 1, 1, 0]),
    ],
)  # fmt: skip
def test_a_level_counts_from_the_sync_behind_its_filter_on(
    segment: Segment, edges_us: tuple[int, ...], bits: list[int]
) -> None:
    """A filter of 2 ms, SYNCs of 3 to 7 ms: an edge comes so late, a shorter pulse not at all."""
    plc = Plc(segment, 9, {"p": Signal(*edges_us)}, input_1="p", filter_us=2000)
    plc.syncs(3, 7)
    assert [data[0] for can_id, data in plc.heard if can_id == 0x189][-5:] == bits


def test_without_power_a_node_neither_answers_nor_shows_that_it_is_there(segment: Segment) -> None:
    """Nor does it boot where the power goes first; no frame of it waits for the bus."""
    plc = Plc(segment, 9, {"p": Signal()}, input_1="p", heartbeat_ms=2)
    plc.syncs(3, 9)
    assert [can_id for can_id, _ in plc.heard].count(0x709) > 3
    plc.terminal.node.power_off()
    plc.heard.clear()
    plc.syncs(10, 20)
    plc.master.send_message(0x609, bytes.fromhex("4000100000000000"))
    plc.syncs(21, 22)
    assert {can_id for can_id, _ in plc.heard} == {0x080, 0x609}
    assert plc.terminal.wc_state == 1
    never = IoNode(11, SimNetwork(segment.port("never")).connect(), plc.clock, lambda _: 1)
    never.power_off()
    plc.syncs(23, 25)
    assert {can_id for can_id, _ in plc.heard} == {0x080, 0x609}


def test_a_node_that_is_reset_has_sampled_nothing_yet(segment: Segment) -> None:
    """6000:1 is 0 from the reset to the next SYNC, as at power on."""
    levels = iter((5, 5, 5, 4, 4, 4, 4))
    node = IoNode(
        9, SimNetwork(segment.port("io")).connect(), segment.scheduler, lambda _: next(levels)
    )
    master = SimNetwork(segment.port("cnc")).connect()
    segment.scheduler.run_until(1 * MS)
    read = node.slave.objects.upload
    assert read(0x6000, 1) == b"\0"
    for command, shown in ((1, b"\5"), (130, b"\5"), (129, b"\0")):
        master.send_message(0, bytes((command, 9)))
        segment.scheduler.run_until(segment.scheduler.now_ns + MS)
        if command == 1:
            master.send_message(0x80, b"")
            segment.scheduler.run_until(segment.scheduler.now_ns + MS)
        assert read(0x6000, 1) == shown, command


# --- drives of buses


def test_each_drive_of_a_bus_has_its_own_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Number, port, axis, probes, switches and profile of its own, and another seed."""
    made: list[tuple[tuple[Any, ...], dict[str, Any]]] = []
    monkeypatch.setattr(nodes, "DriveNode", lambda *args, **given: made.append((args, given)))
    changes = ("bus:can2.drive_queue=mailbox", "bus:can3.queue=mailbox")
    settings, clock = settings_of("probe-xyz.toml", *changes), new_scheduler()
    ports: list[tuple[str, str, str]] = []

    def segment_named(segment: str) -> Any:
        def port(name: str, queue: str) -> Any:
            ports.append((segment, name, queue))
            return SimpleNamespace(attach=lambda _: None, attach_data=lambda _: None, name=name)

        return SimpleNamespace(port=port)

    monkeypatch.setattr(
        nodes, "SimNetwork", lambda port: SimpleNamespace(connect=lambda: None, of=port.name)
    )
    beside: Any = SimpleNamespace(
        axis="axis {}".format, probes="probes {}".format, switches="switches {}".format
    )
    states: list[tuple[str, State]] = []
    segments = {name: segment_named(name) for name in ("can1", "can2", "can3")}
    found = nodes.build_nodes(
        settings, clock, segments, beside, 77, lambda *entered: states.append(entered)
    )
    assert list(found) == ["X", "Y", "Z"]
    assert ports == [("can1", "X", "fifo"), ("can2", "Y", "mailbox"), ("can3", "Z", "fifo")]
    seeds = set()
    for (args, given), name in zip(made, "XYZ", strict=True):
        axis, node_id, network, of_clock, *parts, profile, seed = args
        assert (axis, network.of, of_clock) == (name, name, clock)
        assert node_id == settings.rig.axis[name].node_id
        assert parts == [f"axis {name}", f"probes {name}"]
        assert given["switches"] == f"switches {name}"
        assert given["document"] is None
        assert profile.encoder_increments == 1_048_576
        given["entered"](State.FAULT)
        assert states[-1] == (name, State.FAULT)
        seeds |= {seed + number for number in range(10_000)}  # and those that it counts on from
    assert len(seeds) == 30_000
    assert made[0][0][-1] == 77


def test_a_drive_has_the_eds_of_its_maker_for_its_own_number(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Byte for byte, and read for the number of its axis: what depends on $NODEID is its own."""
    path, made = tmp_path / "maker.eds", dict[str, Any]()
    path.write_text(eds_text(DriveProfile()), encoding="ascii")
    monkeypatch.setattr(
        nodes, "DriveNode", lambda name, *_, document, **_given: made.update({name: document})
    )
    settings, clock = (
        settings_of("probe-xyz.toml", f"drive:servo.eds={path.as_posix()}"),
        new_scheduler(),
    )
    beside: Any = SimpleNamespace(axis=str, probes=str, switches=str)
    with ExitStack() as opened:
        segments = nodes.build_segments(settings, clock, Journal(), [], opened)
        nodes.build_nodes(settings, clock, segments, beside, 0)
    assert list(made) == ["X", "Y", "Z"]
    for name, document in made.items():
        assert document.text == path.read_bytes()
        assert document.dictionary[0x1014].default == 0x80 + settings.rig.axis[name].node_id
    numbers = {settings.rig.axis[name].node_id for name in made}
    assert len(numbers) == 3


@pytest.mark.parametrize("suffix", [".log", ".asc"])
def test_a_log_of_buses_has_the_frames_of_all_of_them_when_the_run_is_over(
    tmp_path: Path, suffix: str
) -> None:
    """Also those that are still in the journal then."""
    settings, clock = settings_of("probe-xyz.toml"), new_scheduler()
    path = tmp_path / f"run{suffix}"
    opened = ExitStack()
    segments = nodes.build_segments(settings, clock, Journal(), [path], opened)
    for number, segment in enumerate(segments.values(), 1):
        segment.port("other")
        segment.port("one").send_raw(0x100 + number, bytes((number,)))
    clock.run_until(MS)
    opened.close()
    found = [(message.arbitration_id, bytes(message.data)) for message in can.LogReader(path)]
    assert sorted(found) == [(0x101, b"\1"), (0x102, b"\2"), (0x103, b"\3")]


@pytest.mark.parametrize("real", ["can1", "can2", "can3"])
def test_an_axis_whose_drive_is_outside_has_no_node_and_the_others_have(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, real: str
) -> None:
    monkeypatch.setattr(nodes, "DriveNode", lambda name, *_, **_given: f"node {name}")
    text = f'[segment.{real}]\ninterface = "slcan"\nchannel = "x"'
    settings, clock = settings_of(above(tmp_path, "probe-xyz.toml", text)), new_scheduler()
    beside: Any = SimpleNamespace(axis=str, probes=str, switches=str)
    with ExitStack() as opened:
        buses = {
            name: opened.enter_context(Segment(name, 1_000_000, clock))
            for name in ("can1", "can2", "can3")
        }
        found = nodes.build_nodes(settings, clock, buses, beside, 0)
    outside = {"can1": "X", "can2": "Y", "can3": "Z"}[real]
    assert found == {name: f"node {name}" for name in "XYZ" if name != outside}
