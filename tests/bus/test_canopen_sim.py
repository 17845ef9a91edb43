"""Unmodified canopen on the simulated bus: one thread, real frame times, no wall clock."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import can
import canopen
import pytest
from canopen.emcy import EmcyError
from canopen.nmt import NmtError
from canopen.objectdictionary import (
    INTEGER32,
    UNSIGNED8,
    UNSIGNED16,
    UNSIGNED32,
    VISIBLE_STRING,
    ObjectDictionary,
    ODArray,
    ODRecord,
    ODVariable,
)
from canopen.profiles.p402 import BaseNode402
from canopen.sdo.exceptions import SdoAbortedError, SdoCommunicationError

from axisrig.bench.bus.can.canopen_sim import SimNetwork, SimRemoteNode
from axisrig.bench.bus.can.faults import FrameFault
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.bus.hits import Hits
from axisrig.kernel.time.clock import MS, Phase, S

Bits = Callable[[Frame], int]
NAME = "a device name of twenty-nine"
TARGET, NAME_INDEX, TEXT, HEARTBEAT, CONTROLWORD, STATUSWORD = (
    0x607A,
    0x1008,
    0x2000,
    0x1017,
    0x6040,
    0x6041,
)


def variable(index: int, subindex: int, kind: int, default: object, name: str) -> ODVariable:
    made = ODVariable(name, index, subindex)
    made.data_type, made.default, made.access_type = kind, default, "rw"
    return made


def dictionary() -> ObjectDictionary:
    """Just enough objects, with one RPDO and one TPDO."""
    od = ObjectDictionary()
    od.add_object(variable(TARGET, 0, INTEGER32, 5, "Target position"))
    od.add_object(variable(CONTROLWORD, 0, UNSIGNED16, 0, "Controlword"))
    od.add_object(variable(STATUSWORD, 0, UNSIGNED16, 0x40, "Statusword"))
    od.add_object(variable(NAME_INDEX, 0, VISIBLE_STRING, NAME, "Name"))
    od.add_object(variable(TEXT, 0, VISIBLE_STRING, "", "Text"))
    od.add_object(variable(HEARTBEAT, 0, UNSIGNED16, 0, "Heartbeat"))
    for offset, cob_id in ((0x1400, 0x203), (0x1800, 0x183)):
        communication = ODRecord(f"Communication {offset:x}", offset)
        for subindex, kind, default in (
            (0, UNSIGNED8, 2),
            (1, UNSIGNED32, cob_id),
            (2, UNSIGNED8, 1),
        ):
            communication.add_member(variable(offset, subindex, kind, default, f"c{subindex}"))
        mapping = ODArray(f"Mapping {offset:x}", offset + 0x200)
        for subindex, kind, default in ((0, UNSIGNED8, 1), (1, UNSIGNED32, TARGET << 16 | 32)):
            mapping.add_member(variable(offset + 0x200, subindex, kind, default, f"m{subindex}"))
        od.add_object(communication)
        od.add_object(mapping)
    return od


@dataclass
class Pair:
    """A master and a drive on one segment, each with its own network."""

    segment: Segment
    master: SimNetwork
    drive: SimNetwork
    remote: SimRemoteNode
    local: canopen.LocalNode

    def later(self, delay_ns: int, action: Callable[[], object]) -> None:
        self.segment.scheduler.call_at(self.segment.now_ns + delay_ns, Phase.APPLICATION, action)


@pytest.fixture
def pair(segment: Segment) -> Iterator[Pair]:
    threads = threading.active_count()
    master = SimNetwork(segment.port("master")).connect()
    drive = SimNetwork(segment.port("drive")).connect()
    remote, local = SimRemoteNode(3, dictionary()), canopen.LocalNode(3, dictionary())
    master.add_node(remote)
    drive[3] = local
    yield Pair(segment, master, drive, remote, local)
    master.disconnect()
    drive.disconnect()
    assert threading.active_count() == threads


def test_expedited_upload_takes_its_two_frames(pair: Pair, naive_bits: Bits) -> None:
    """The answer is requested when the request ends, starts after its intermission."""
    assert pair.remote.sdo[TARGET].raw == 5
    request = data_frame(0x603, bytes.fromhex("407a600000000000"))
    answer = data_frame(0x583, bytes.fromhex("437a600005000000"))
    assert pair.segment.now_ns == 1000 * (naive_bits(request) + naive_bits(answer) - 3)


def test_expedited_download_arrives(pair: Pair) -> None:
    pair.remote.sdo[TARGET].raw = -123456
    assert pair.local.data_store[TARGET][0] == (-123456).to_bytes(4, "little", signed=True)


def test_segmented_transfers_take_one_pair_of_frames_per_seven_bytes(pair: Pair) -> None:
    """28 characters: initiate and 4 segments each way."""
    assert len(NAME) == 28
    assert pair.remote.sdo[NAME_INDEX].raw == NAME
    assert pair.segment.load().frames == 2 * (1 + 4)
    pair.remote.sdo[TEXT].raw = NAME
    assert pair.local.data_store[TEXT][0] == NAME.encode()
    assert pair.segment.load().frames == 2 * 2 * (1 + 4)


def test_abort_carries_its_code(pair: Pair) -> None:
    with pytest.raises(SdoAbortedError) as caught:
        pair.remote.sdo.upload(0x5555, 0)
    assert caught.value.code == 0x06020000


def test_lost_answer_times_out_after_its_simulated_time(pair: Pair, naive_bits: Bits) -> None:
    pair.segment.add_fault(FrameFault(0x583, hits=Hits(count=1)))
    with pytest.raises(SdoCommunicationError):
        pair.remote.sdo.upload(TARGET, 0)
    assert pair.segment.now_ns == 300 * MS
    assert pair.remote.sdo[TARGET].raw == 5


def test_sdo_waits_for_the_bus_behind_other_traffic(pair: Pair, naive_bits: Bits) -> None:
    """Ten frames of higher priority, requested first, delay the request by their sum."""
    traffic = [data_frame(0x100 + n, bytes(8)) for n in range(10)]
    port = pair.segment.port("traffic")
    for frame in traffic:
        port.send_raw(frame.arbitration_id, frame.data)
    pair.remote.sdo.upload(TARGET, 0)
    wait_ns = 1000 * sum(naive_bits(frame) for frame in traffic)
    assert pair.segment.load().worst_delay_ns[0x603] == wait_ns


def test_nmt_command_changes_the_state_of_the_drive(pair: Pair) -> None:
    pair.remote.nmt.state = "OPERATIONAL"
    pair.segment.scheduler.run_until(MS)
    assert pair.local.nmt.state == "OPERATIONAL"


def test_boot_up_and_heartbeat(pair: Pair) -> None:
    pair.later(5 * MS, lambda: setattr(pair.local.nmt, "state", "INITIALISING"))
    pair.remote.nmt.wait_for_bootup(timeout=1.0)
    assert 5 * MS < pair.segment.now_ns < 6 * MS
    pair.local.nmt.state = "PRE-OPERATIONAL"
    pair.remote.sdo[HEARTBEAT].raw = 20
    assert pair.remote.nmt.wait_for_heartbeat(timeout=1.0) == "PRE-OPERATIONAL"
    pair.remote.nmt.wait_for_heartbeat(timeout=1.0)  # the first one waited behind the SDO answer
    first_ns = pair.segment.now_ns
    pair.remote.nmt.wait_for_heartbeat(timeout=1.0)
    assert pair.segment.now_ns - first_ns == 20 * MS


def test_a_boot_up_of_before_is_not_the_one_that_is_waited_for(pair: Pair) -> None:
    pair.local.nmt.state = "INITIALISING"  # sends it
    pair.segment.scheduler.run_until(MS)
    pair.later(5 * MS, lambda: setattr(pair.local.nmt, "state", "INITIALISING"))
    pair.remote.nmt.wait_for_bootup(timeout=1.0)
    assert 6 * MS < pair.segment.now_ns < 7 * MS


def test_waiting_for_what_never_comes_ends_in_simulated_time(pair: Pair) -> None:
    """Heartbeats go on meanwhile, so events never run out; none of them is a boot-up."""
    pair.local.nmt.state = "PRE-OPERATIONAL"
    pair.local.nmt.start_heartbeat(50)
    pair.segment.scheduler.run_until(MS)
    with pytest.raises(NmtError):
        pair.remote.nmt.wait_for_bootup(timeout=10)
    assert pair.segment.now_ns == 10 * S + MS
    pair.local.nmt.stop_heartbeat()
    with pytest.raises(NmtError):
        pair.remote.nmt.wait_for_heartbeat(timeout=2)
    assert pair.segment.now_ns == 12 * S + MS


def test_an_emergency_of_before_is_not_the_one_that_is_awaited(pair: Pair) -> None:
    """Error code 0 takes the errors back: they are in the log, and active no more (CiA 301)."""
    for delay_ns, code in ((1 * MS, 0x8110), (2 * MS, 0x0000)):
        pair.later(delay_ns, lambda code=code: pair.local.emcy.send(code))
    assert pair.remote.emcy.wait(timeout=0.01) is not None
    assert pair.remote.emcy.wait(0x0000, timeout=0.01) is not None
    assert [entry.code for entry in pair.remote.emcy.active] == []
    assert [entry.code for entry in pair.remote.emcy.log] == [0x8110, 0x0000]
    assert pair.remote.emcy.wait(timeout=0.01) is None
    pair.later(1 * MS, lambda: pair.local.emcy.send(0x8611))
    found = pair.remote.emcy.wait(timeout=1.0)
    assert found is not None
    assert found.code == 0x8611


def test_emergency_is_received_and_awaited_by_code(pair: Pair) -> None:
    seen: list[EmcyError] = []
    pair.remote.emcy.add_callback(seen.append)
    for delay_ns, code in ((1 * MS, 0x8110), (2 * MS, 0x8611)):
        pair.later(delay_ns, lambda code=code: pair.local.emcy.send(code, 0x21, b"abcde"))
    found = pair.remote.emcy.wait(0x8611, timeout=1.0)
    assert found is not None
    assert (found.code, found.register, found.data) == (0x8611, 0x21, b"abcde")
    assert found.timestamp == pair.segment.now_ns / 1e9
    assert [entry.code for entry in seen] == [0x8110, 0x8611]
    before_ns = pair.segment.now_ns
    assert pair.remote.emcy.wait(timeout=0.5) is None
    assert pair.segment.now_ns == before_ns + 500 * MS


@pytest.mark.parametrize("codes", [(0x8611, 0x8110), (0x8110, 0x8611), (0x8611, 0x8120, 0x8110)])
def test_an_emergency_of_another_code_is_not_the_one_that_is_awaited(
    pair: Pair, codes: tuple[int, ...]
) -> None:
    """Whether its code is the greater or the smaller one; each comes 1 ms after the other."""
    for number, code in enumerate(codes, 1):
        pair.later(number * MS, lambda code=code: pair.local.emcy.send(code))
    found = pair.remote.emcy.wait(codes[-1], timeout=0.1)
    assert found is not None
    assert found.code == codes[-1]
    assert pair.segment.now_ns > len(codes) * MS


def test_pdo_is_received_into_a_buffer_of_its_own(pair: Pair) -> None:
    other = SimNetwork(pair.segment.port("other")).connect()
    twin = SimRemoteNode(3, dictionary())
    other.add_node(twin)
    for node in (pair.remote, twin):
        node.tpdo.read(from_od=True)
    pair.later(MS, lambda: pair.drive.send_message(0x183, (77).to_bytes(4, "little")))
    assert pair.remote.tpdo[1].wait_for_reception(timeout=1.0) == pair.segment.now_ns / 1e9
    pair.remote.tpdo[1][TARGET].raw = 1
    assert twin.tpdo[1][TARGET].raw == 77
    other.disconnect()


def test_sync_producer_and_cyclic_pdo_run_on_the_clock(pair: Pair) -> None:
    times: dict[int, list[int]] = {0x80: [], 0x203: []}
    for can_id, seen in times.items():
        pair.drive.subscribe(can_id, lambda *_, seen=seen: seen.append(pair.segment.now_ns))
    pair.remote.rpdo.read(from_od=True)
    pair.master.sync.start(0.001)
    pair.segment.scheduler.run_until(MS // 2)
    pair.remote.rpdo[1].start(0.002)
    pair.segment.scheduler.run_until(10 * MS - 1)
    pair.master.sync.stop()
    pair.remote.rpdo[1].stop()
    assert times[0x80] == [k * MS + 48_000 for k in range(10)]
    assert len(times[0x203]) == 5


def test_remote_frames_are_not_data(pair: Pair) -> None:
    seen: list[int] = []
    pair.drive.subscribe(0x183, lambda *_: seen.append(1))
    pair.remote.tpdo.read(from_od=True)
    pair.remote.tpdo[1].remote_request()
    pair.segment.scheduler.run_until(MS)
    assert pair.segment.load().frames == 1
    assert seen == []


def test_waiting_inside_a_callback_is_refused(pair: Pair) -> None:
    pair.master.subscribe(0x80, lambda *_: pair.remote.sdo.upload(TARGET, 0))
    pair.drive.sync.transmit()
    with pytest.raises(RuntimeError, match="must not wait"):
        pair.segment.scheduler.run_until(MS)


def test_exception_of_a_subscriber_ends_the_run(pair: Pair) -> None:
    pair.master.subscribe(0x80, lambda *_: 1 // 0)
    pair.drive.sync.transmit()
    with pytest.raises(ZeroDivisionError):
        pair.segment.scheduler.run_until(MS)


def test_scanner_sees_nodes_that_nobody_subscribed(pair: Pair) -> None:
    pair.drive.send_message(0x705, b"\x05")
    pair.segment.scheduler.run_until(MS)
    assert pair.master.scanner.nodes == [5]


def test_numbers_become_simulated_nodes(pair: Pair) -> None:
    assert isinstance(pair.master.add_node(4, dictionary()), SimRemoteNode)
    assert isinstance(pair.drive.create_node(4, dictionary()), canopen.LocalNode)
    assert pair.master[4].sdo[TARGET].raw == 5
    with pytest.raises(NotImplementedError):
        pair.master.add_node(5, upload_eds=True)


def test_master_of_the_drive_profile_works_by_inheritance(pair: Pair) -> None:
    class SimNode402(SimRemoteNode, BaseNode402):
        pass

    node = SimNode402(3, dictionary())
    pair.master[3] = node
    assert node.sdo[STATUSWORD].raw == 0x40
    node.tpdo[1].clear()
    assert node.statusword == 0x40
    assert node.state == "SWITCH ON DISABLED"


def test_nodes_added_before_connecting_wait_in_simulated_time(segment: Segment) -> None:
    network = SimNetwork()
    remote = SimRemoteNode(3, dictionary())
    network.add_node(remote)
    network.bus = SimBus("bus")
    network.connect()
    with pytest.raises(NmtError):
        remote.nmt.wait_for_heartbeat(timeout=3)
    assert segment.now_ns == 3 * S
    network.disconnect()
    assert segment.ports == ()


@pytest.mark.long
def test_on_another_interface_the_classes_are_plain_canopen() -> None:
    """python-can's own virtual bus with canopen's notifier thread; the wall clock runs here."""
    threads = threading.active_count()
    networks = []
    for node in (SimRemoteNode(3, dictionary()), canopen.LocalNode(3, dictionary())):
        network = SimNetwork()
        network.NOTIFIER_CYCLE = 0.01
        network.connect(interface="virtual", channel="plain")
        network[3] = node
        networks.append(network)
    master, drive = networks
    assert threading.active_count() > threads
    remote, local = master[3], drive[3]
    assert isinstance(remote, canopen.RemoteNode)
    remote.sdo[TARGET].raw = 11
    assert remote.sdo[TARGET].raw == 11
    assert type(remote.nmt.state_update) is threading.Condition
    with pytest.raises(NmtError):
        remote.nmt.wait_for_heartbeat(timeout=0.01)
    with pytest.raises(NmtError):
        remote.nmt.wait_for_bootup(timeout=0.01)
    assert remote.emcy.wait(timeout=0.01) is None
    master.withdraw([0x203])  # its controller is out of reach
    local.add_read_callback(lambda **_: 1 // 0)
    with pytest.raises(SdoAbortedError):
        remote.sdo.upload(TARGET, 0)
    for network in networks:
        network.disconnect()
    assert threading.active_count() == threads


def test_interface_by_name_needs_an_open_segment() -> None:
    with pytest.raises((can.CanInitializationError, can.CanInterfaceNotImplementedError)):
        SimNetwork().connect(interface="axisrig", channel="nowhere")


@pytest.mark.parametrize("joins_first", [True, False])
def test_a_further_sdo_channel_is_heard_whenever_it_was_added(
    pair: Pair, joins_first: bool
) -> None:
    """CiA 301: an expedited answer 43 of four bytes to the request 40, on their own identifiers."""
    node = SimRemoteNode(7, dictionary())
    if joins_first:
        pair.master.add_node(node)
    client = node.add_sdo(0x647, 0x5C7)
    if not joins_first:
        pair.master.add_node(node)
    assert [*node.sdo_channels][-1] is client
    client.network = pair.master  # canopen leaves it to who adds the channel

    def answer(_can_id: int, data: bytearray, _time: float) -> None:
        assert data[0] == 0x40
        pair.drive.send_message(0x5C7, b"\x43" + bytes(data[1:4]) + b"\x11\x22\x33\x44")

    pair.drive.subscribe(0x647, answer)
    assert client.upload(TARGET, 0) == b"\x11\x22\x33\x44"
    begin_ns = pair.segment.now_ns
    pair.drive.unsubscribe(0x647, answer)
    client.RESPONSE_TIMEOUT = 0.02
    client.MAX_RETRIES = 1
    with pytest.raises(SdoCommunicationError):
        client.upload(TARGET, 0)
    assert pair.segment.now_ns - begin_ns == pytest.approx(20 * MS, abs=MS)


def test_a_network_that_has_left_sends_no_more(segment: Segment) -> None:
    network, other = SimNetwork(segment.port("one")).connect(), segment.port("other")
    network.send_message(0x123, b"\x01")
    segment.scheduler.run_until(MS)
    assert other.recv(0) is not None
    network.disconnect()
    with pytest.raises(RuntimeError, match="Not connected"):
        network.send_message(0x123, b"\x01")
    segment.scheduler.run_until(2 * MS)
    assert other.recv(0) is None


def test_the_scanner_keeps_the_order_of_the_first_messages_and_forgets_on_reset(
    pair: Pair,
) -> None:
    """EMCY, TPDO1, SDO answer and heartbeat are of a node; SYNC, RPDO and NMT of none."""
    scanner = pair.master.scanner
    for can_id in (0x709, 0x080, 0x185, 0x205, 0x087, 0x000, 0x585, 0x581):
        pair.drive.send_message(can_id, b"\x05" * 8)
    pair.segment.scheduler.run_until(5 * MS)
    assert scanner.nodes == [9, 5, 7, 1]
    scanner.reset()
    assert scanner.nodes == []
    pair.drive.send_message(0x185, b"\x05")
    pair.segment.scheduler.run_until(6 * MS)
    assert scanner.nodes == [5]
