"""The CiA 401 node of a PLC: what canopen and python-can read of it, and the PLC's end."""

import io
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import can
import canopen
import pytest
from canopen.objectdictionary import ODArray, ODRecord, ODVariable
from canopen.objectdictionary.eds import import_eds
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.bus.can.canopen_sim import SimNetwork, SimRemoteNode
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.canopen.io_node import IoNode, io_table
from axisrig.bench.machine.canopen.io_terminal import IoTerminal
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.canopen.arrival import describe_arrival
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

NODE = 20
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
TELEGRAMS = NodeTelegrams("can1", 0x180 + NODE, MS, 99_000, 600_000)
"""SYNC (44 bits), intermission (3), answer (44 + 8) without stuff bits; the NC cycle at 600 us."""
SYNC_NS = 48_000  # a SYNC frame at 1 Mbit/s: 44 bits and 4 stuff bits


def foreign_dictionary() -> canopen.ObjectDictionary:
    """The EDS as canopen writes it, read again."""
    table, found, text = io_table(), canopen.ObjectDictionary(), io.StringIO()  # type: ignore[no-untyped-call]
    found.node_id = NODE
    for (index, sub), value in table.defaults(NODE).items():
        row = table.rows[index, sub]
        variable = ODVariable(row.name, index, sub)
        variable.data_type, variable.access_type = row.data_type.code, row.access
        variable.pdo_mappable = bool(row.pdo)
        variable.default = value.decode() if isinstance(value, bytes) else value
        if row.sub is None:
            found.add_object(variable)
            continue
        if index not in found:
            found.add_object((ODArray if index == 0x6000 else ODRecord)(f"{index:04X}", index))
        whole = found[index]
        assert isinstance(whole, ODArray | ODRecord)
        whole.add_member(variable)
    canopen.export_od(found, text, "eds")  # type: ignore[no-untyped-call]
    return import_eds(io.StringIO(text.getvalue()), NODE)  # type: ignore[no-untyped-call]


@dataclass
class Bus:
    """A segment with a master of canopen; heard: time in ns, identifier and data of each frame."""

    scheduler: Scheduler
    segment: Segment
    master: SimNetwork
    remote: SimRemoteNode
    heard: list[tuple[int, int, bytes]] = field(default_factory=list)

    def until_ms(self, time_ms: float) -> None:
        self.scheduler.run_until(round(time_ms * MS))

    def syncs(self, first_ms: int, count: int) -> None:
        """Send a SYNC at each of so many milliseconds and let the answers through."""
        for time_ms in range(first_ms, first_ms + count):
            self.until_ms(time_ms)
            self.master.send_message(0x80, b"")
        self.until_ms(first_ms + count - 0.1)

    def frames(self, cob_id: int) -> list[bytes]:
        return [data for _, can_id, data in self.heard if can_id == cob_id]


@pytest.fixture
def bus() -> Iterator[Bus]:
    scheduler = new_scheduler()
    with Segment("io bus", 1_000_000, scheduler) as segment:
        port = segment.port("master")
        heard: list[tuple[int, int, bytes]] = []
        port.attach(lambda m: heard.append((segment.now_ns, m.arbitration_id, bytes(m.data))))
        master = SimNetwork(port).connect()
        remote = SimRemoteNode(NODE, foreign_dictionary())
        master.add_node(remote)
        yield Bus(scheduler, segment, master, remote, heard)


def node_on(bus: Bus, levels: Callable[[int], int] = lambda _: 0) -> IoNode:
    network = SimNetwork(bus.segment.port("io")).connect()
    node = IoNode(NODE, network, bus.scheduler, levels)
    bus.until_ms(1)
    return node


def test_it_boots_and_shows_its_objects_to_canopen(bus: Bus) -> None:
    node_on(bus)
    assert bus.frames(0x700 + NODE) == [b"\x00"]
    sdo = bus.remote.sdo
    assert (sdo[0x1000].raw, sdo[0x1018][2].raw, sdo[0x6000][1].raw) == (0x10191, 0x191, 0)
    assert sdo[0x1A00][1].raw == 0x6000_0108


def test_it_sends_the_levels_of_the_sync_while_it_is_operational(bus: Bus) -> None:
    seen: list[int] = []

    def levels(now_ns: int) -> int:
        seen.append(now_ns)
        return len(seen) % 2 * 3

    node_on(bus, levels)
    bus.syncs(2, 2)
    assert not bus.frames(0x180 + NODE)
    bus.remote.nmt.send_command(1)
    bus.syncs(5, 3)
    assert bus.frames(0x180 + NODE) == [b"\x03", b"\x00", b"\x03"]
    assert [now_ns % MS for now_ns in seen] == [SYNC_NS] * 5  # before the start too: for SDO
    bus.remote.tpdo.read(from_od=True)
    bus.syncs(8, 1)
    (inputs,) = bus.remote.tpdo[1].map
    assert (inputs.index, inputs.subindex, inputs.raw) == (0x6000, 1, 0)
    bus.remote.nmt.send_command(2)
    bus.syncs(9, 2)
    assert len(bus.frames(0x180 + NODE)) == 4


def test_a_stopped_node_answers_no_sdo_and_keeps_its_heartbeat(bus: Bus) -> None:
    """CiA 301, NMT states and objects: SDO in pre-operational and operational only."""
    node_on(bus)
    bus.remote.sdo[0x1017].raw = 3
    answers = []
    for command in (2, 128, 2, 1):
        bus.remote.nmt.send_command(command)
        begin_ms = bus.scheduler.now_ns / MS
        bus.heard.clear()
        bus.master.send_message(0x600 + NODE, bytes.fromhex("4000100000000000"))
        bus.until_ms(begin_ms + 7)
        answers.append(len(bus.frames(0x580 + NODE)))
        assert len(bus.frames(0x700 + NODE)) >= 2
    assert answers == [0, 1, 0, 1]


def test_transmission_type_counts_syncs_and_others_are_refused(bus: Bus) -> None:
    node_on(bus)
    bus.remote.sdo[0x1800][2].raw = 3
    for index, sub, value, code in (
        (0x1800, 2, 255, 0x06090030),
        (0x1000, None, 1, 0x06010002),
        (0x1800, 2, 0, 0x06090030),
    ):
        place = bus.remote.sdo[index] if sub is None else bus.remote.sdo[index][sub]
        with pytest.raises(SdoAbortedError) as refused:
            place.raw = value
        assert refused.value.code == code
    with pytest.raises(SdoAbortedError) as missing:
        bus.remote.sdo.upload(0x6200, 1)
    assert missing.value.code == 0x06020000
    bus.remote.nmt.send_command(1)
    first_ms = bus.segment.now_ns // MS + 1
    bus.syncs(first_ms, 7)
    assert len(bus.frames(0x180 + NODE)) == 2


def test_it_answers_node_guarding_and_remote_requests_as_every_slave_does(bus: Bus) -> None:
    """CiA 301: state and toggle bit; the sample of the last SYNC where 1800:1 allows it."""
    node_on(bus, lambda _: 5)
    cob_id = 0x180 + NODE
    for value in (1 << 31 | cob_id, cob_id):
        bus.remote.sdo[0x1800][1].raw = value
    bus.remote.nmt.send_command(1)
    bus.syncs(bus.segment.now_ns // MS + 1, 1)
    for can_id in (0x700 + NODE, 0x700 + NODE, cob_id):
        bus.master.send_message(can_id, b"", remote=True)
        bus.until_ms(bus.segment.now_ns / MS + 1)
    assert [data for data in bus.frames(0x700 + NODE) if data] == [b"\x00", b"\x05", b"\x85"]
    assert [data for data in bus.frames(cob_id) if data] == [b"\x05", b"\x05"]


def test_its_heartbeat_shows_its_state_and_a_reset_boots_it(bus: Bus) -> None:
    node_on(bus)
    bus.remote.sdo[0x1017].raw = 20
    begin_ns = bus.segment.now_ns
    bus.remote.nmt.send_command(1)
    bus.until_ms(begin_ns / MS + 45)
    beats = [(t, data) for t, can_id, data in bus.heard if can_id == 0x700 + NODE][1:]
    assert [data for _, data in beats] == [b"\x7f", b"\x05", b"\x05"]
    assert beats[2][0] - beats[1][0] == pytest.approx(20 * MS, abs=10_000)
    bus.remote.nmt.send_command(129)
    bus.until_ms(begin_ns / MS + 145)
    assert bus.frames(0x700 + NODE)[-1] == b"\x00"
    assert bus.remote.sdo[0x1017].raw == 0


class Signal:
    """A probe that closes at 12.3 ms."""

    level = False
    edges = ((12_300_000, True),)


def terminal_on(bus: Bus, **keys: int) -> IoTerminal:
    table = TerminalTable(segment="can1", node=NODE, input_1="probe", **keys)
    return IoTerminal(
        table,
        {"probe": Signal()},
        bus.scheduler,
        node_port=SimNetwork(bus.segment.port("io")).connect(),
        master=bus.master,
        advance=lambda _: None,
        telegrams=TELEGRAMS,
    )


def test_the_plc_starts_the_node_and_sees_the_level_of_the_last_sync(bus: Bus) -> None:
    terminal = terminal_on(bus, heartbeat_ms=10)
    assert terminal.wc_state == 1
    bus.syncs(5, 8)
    assert (terminal.wc_state, terminal.image[1].input) == (0, False)
    bus.syncs(13, 1)
    assert (terminal.wc_state, terminal.image[1].input) == (0, True)


def test_the_node_is_lost_without_its_telegram_or_its_heartbeat(bus: Bus) -> None:
    """missing_cycles 3: the fourth period without one; a heartbeat of 10 ms: after 20 ms."""
    terminal = terminal_on(bus)
    bus.syncs(5, 3)
    came_ns = next(t for t, can_id, _ in reversed(bus.heard) if can_id == 0x180 + NODE)
    bus.scheduler.run_until(came_ns + 4 * MS)
    assert terminal.wc_state == 0
    bus.scheduler.run_until(came_ns + 4 * MS + 1)
    assert (terminal.wc_state, terminal.image[1].input) == (1, False)
    bus.syncs(14, 1)
    assert terminal.wc_state == 0
    bus.remote.nmt.send_command(129)  # another master resets it: the PLC starts it again
    bus.until_ms(15.5)
    assert terminal.wc_state == 1
    bus.syncs(20, 2)
    assert (terminal.wc_state, terminal.image[1].input) == (0, True)


def test_a_node_without_heartbeats_that_were_wanted_is_lost(bus: Bus) -> None:
    terminal = terminal_on(bus, heartbeat_ms=10)
    bus.syncs(5, 2)
    terminal.node.slave.heartbeat.stop()
    bus.syncs(7, 12)
    assert terminal.wc_state == 0
    bus.syncs(19, 12)
    assert terminal.wc_state == 1


def test_a_node_that_boots_while_the_plc_starts_it_is_started_anew(bus: Bus) -> None:
    """The reset takes the answer with it; the question asked again does not count for the start."""
    terminal_on(bus)
    sent: list[bytes] = []
    ear = bus.segment.port("ear")
    ear.attach(lambda m: sent.append(bytes(m.data)) if m.arbitration_id in (0, 0x600 + NODE) else 0)
    bus.scheduler.run_while(lambda: not sent, MS)
    bus.master.send_message(0, bytes((129, NODE)))
    bus.syncs(5, 2)
    assert bus.frames(0x180 + NODE) == []
    bus.until_ms(320)
    device_type, abort, heartbeat = b"\x40\x00\x10", b"\x80\x00\x10", b"\x2b\x17\x10"
    again = [abort, device_type, device_type, heartbeat]
    assert [data[:3] for data in sent] == [device_type, b"\x81\x14", *again, b"\x01\x14"]
    bus.syncs(321, 2)
    assert len(bus.frames(0x180 + NODE)) == 2


def test_what_is_no_state_of_the_node_changes_nothing(bus: Bus) -> None:
    """An error control message has one byte (CiA 301); that of another node is none of this one."""
    terminal = terminal_on(bus)
    other = SimNetwork(bus.segment.port("other")).connect()
    bus.syncs(5, 3)
    for can_id, data in ((NODE, b"\x00\x00"), (NODE, b"\x7f\x00"), (NODE + 1, b"\x7f"),
                         (NODE + 1, b"\x00")):  # fmt: skip
        other.send_message(0x700 + can_id, data)
        bus.until_ms(bus.scheduler.now_ns / MS + 0.2)
        assert terminal.wc_state == 0
    other.send_message(0x700 + NODE, b"\x7f")  # somebody has stopped it
    bus.until_ms(9.5)
    assert terminal.wc_state == 1
    other.send_message(0x700 + NODE, b"\x05")
    bus.until_ms(9.9)
    assert terminal.wc_state == 0


def test_a_node_that_has_booted_counts_from_its_next_telegram_on(bus: Bus) -> None:
    """Started anew within the 4 ms that its last telegram is good for."""
    terminal = terminal_on(bus)
    bus.syncs(5, 3)
    starts = [1, NODE]
    commands: list[list[int]] = []
    bus.segment.port("ear").attach_data(
        lambda can_id, data, _time: commands.append([can_id, *data])
    )
    bus.remote.nmt.send_command(129)
    bus.until_ms(10.5)
    assert [0, *starts] in commands
    assert terminal.wc_state == 1
    bus.syncs(11, 1)
    assert terminal.wc_state == 0


def test_a_node_that_could_not_be_started_stays_lost_whoever_starts_it(bus: Bus) -> None:
    """Stopped at once it answers nothing; its telegrams come all the same later on."""
    terminal = terminal_on(bus)
    bus.until_ms(0.2)
    bus.remote.nmt.send_command(2)
    bus.until_ms(3000)
    bus.remote.nmt.send_command(1)
    bus.syncs(3001, 3)
    assert len(bus.frames(0x180 + NODE)) >= 2
    assert terminal.wc_state == 1


def test_a_state_from_before_its_start_does_not_stop_a_node(bus: Bus) -> None:
    """A heartbeat in pre-operational that comes behind the start and before the first telegram."""
    terminal = terminal_on(bus)
    other = SimNetwork(bus.segment.port("other")).connect()
    bus.until_ms(3)  # booted and started
    other.send_message(0x700 + NODE, b"\x7f")
    bus.until_ms(4)
    assert terminal.wc_state == 1  # nothing has come yet
    bus.syncs(5, 1)
    assert terminal.wc_state == 0


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"node": 3}, "both segment and node"),
        ({"segment": "can1", "node": NODE, "cycle_us": 1000}, "cycle_us"),
        ({"segment": "can1", "node": NODE, "stamp_jitter_ns": 5}, "stamp_jitter_ns"),
        ({"heartbeat_ms": 10}, "heartbeat_ms"),
    ],
)
def test_keys_that_belong_to_the_other_kind_are_refused(
    keys: dict[str, str | int], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        TerminalTable(**keys)


@pytest.mark.long
def test_python_can_and_canopen_read_the_levels_that_the_probe_had(tmp_path: Path) -> None:
    """Every frame of the log holds the level of the probe at its SYNC, the end of that frame."""
    rig, files = read_rig(RIGS / "plc-io-node.toml")
    settings = read_settings(rig, files, [(parse_assignment("plc:V.E.FEED=600"), as_written)])
    (tmp_path / "touch.nc").write_text(
        "%touch\nN10 G90 G100 Z98 F600\nN20 G1 Z101 F3000\nN30 M30\n"
    )
    settings.start.setdefault("z", []).append(
        (parse_assignment("plant:z.position_start_mm=100.5"), lambda error, _: error)
    )
    log = tmp_path / "bus.blf"
    with ExitStack() as stack:
        machine = Machine(settings, read_program(tmp_path / "touch.nc", ("Z",)), bus_logs=[log])
        stack.callback(machine.close)
        machine.run()
        edges = list(machine.plant.probes["probe"].signal.edges)
    remote, reader = canopen.RemoteNode(NODE, foreign_dictionary()), canopen.Network()
    reader.add_node(remote)
    remote.tpdo.read(from_od=True)
    levels = []
    for frame in can.LogReader(log):
        if frame.arbitration_id == 0x180 + NODE:
            reader.notify(frame.arbitration_id, frame.data, frame.timestamp)
            sync_ns = int(frame.timestamp * 1e9) // MS * MS + SYNC_NS
            passed = [level for time_ns, level in edges if time_ns <= sync_ns]
            levels.append((remote.tpdo[1].map[0].raw, int(bool(passed and passed[-1]))))
    assert [read for read, _ in levels] == [true for _, true in levels]
    assert {read for read, _ in levels} == {0, 1}


def test_the_check_of_a_rig_shows_when_the_levels_are_there() -> None:
    """SYNC, TPDO1 of drive and node, TPDO2, one event frame, without the last intermission.

    55 + 10 n bits at most for a frame of n bytes, the intermission in it (Davis et al. 2007).
    """
    settings = read_settings(*read_rig(RIGS / "plc-io-node.toml"), [])
    lines = [line for line in describe_arrival(settings) if line.startswith("terminal")]
    bits = sum(55 + 10 * count for count in (0, 8, 1, 6, 4)) - 3
    assert lines == [
        "terminal of the PLC: sampled 48 us after the SYNC is requested,"
        f" its telegram is there after {bits} us at most"
    ]
