"""A canopen network on a simulated bus: leaving it, waits, nodes that it finds, remote frames."""

import pytest

from axisrig.bench.bus.can.canopen_sim import SimCondition, SimNetwork, SimRemoteNode
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import MS


def test_a_network_that_has_left_sends_nothing_and_may_come_back(segment: Segment) -> None:
    heard: list[int] = []
    segment.port("listener").attach_data(lambda can_id, _data, _time: heard.append(can_id))
    network = SimNetwork(segment.port("one")).connect()
    network.send_message(0x201, b"\x01")
    segment.scheduler.run_until(MS)
    network.disconnect()
    with pytest.raises(RuntimeError, match="connected"):
        network.send_message(0x202, b"\x01")
    network.bus = segment.port("two")
    network.connect()
    network.send_message(0x203, b"\x01")
    segment.scheduler.run_until(2 * MS)
    assert heard == [0x201, 0x203]


def test_whatever_a_node_may_wait_for_comes_in_simulated_time(segment: Segment) -> None:
    """Heartbeat, emergencies, and PDOs of both directions."""
    node = SimRemoteNode(3, object_dictionary(3, DriveProfile()))
    network = SimNetwork(segment.port("master"))
    network.add_node(node)
    network.connect()
    waits = [node.nmt.state_update, node.emcy.emcy_received]
    waits += [pdo.receive_condition for maps in (node.tpdo, node.rpdo) for pdo in maps.values()]
    assert len(waits) > 4
    assert all(isinstance(wait, SimCondition) for wait in waits)


def test_nodes_may_be_counted_as_found(segment: Segment) -> None:
    """Set by hand they are the ones that are known, and others come after them."""
    network = SimNetwork(segment.port("master")).connect()
    other = segment.port("other")
    other.send_raw(0x701, b"\x05")
    segment.scheduler.run_until(MS)
    network.scanner.nodes = [9]
    assert network.scanner.nodes == [9]  # what was heard before is forgotten
    other.send_raw(0x702, b"\x05")
    other.send_raw(0x709, b"\x05")
    segment.scheduler.run_until(2 * MS)
    assert network.scanner.nodes == [9, 2]
    network.scanner.reset()
    assert network.scanner.nodes == []


def test_remote_requests_reach_who_listens_and_nobody_else(segment: Segment) -> None:
    network = SimNetwork(segment.port("one")).connect()
    master = SimNetwork(segment.port("two")).connect()
    came: list[str] = []
    first, second = (lambda: came.append("first")), (lambda: came.append("second"))
    network.subscribe_remote(0x183, first)
    network.subscribe_remote(0x183, second)
    network.subscribe_remote(0x184, lambda: network.unsubscribe_remote(0x183, first))
    for can_id in (0x183, 0x184, 0x183, 0x185):
        master.send_message(can_id, bytes(2), remote=True)
    segment.scheduler.run_until(2 * MS)
    assert came == ["first", "second", "second"]
    with pytest.raises(ValueError, match="not in list"):
        network.unsubscribe_remote(0x183, first)
