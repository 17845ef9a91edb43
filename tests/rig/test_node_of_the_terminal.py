"""A terminal of the PLC that is a node on a CAN bus: its number, its bus, what it sends there."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.canopen.io_node import (
    NodeTelegrams,
    check_terminal,
    node_table,
    synced_segments,
    terminal_frames,
    terminal_telegrams,
)
from axisrig.bench.rig.canopen.schedule import schedule_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import US

Read = Callable[..., Settings]
OFFSET = "cycle_offset_us = 600"
TERMINAL = """
[plc]
period_us = 2000
program = "plc.py"

[plc.terminal]
segment = "can1"
node = {node}

[plant.z]
"""
OWN_BUS = '[segment.can7]\nbitrate = 500_000\n[segment.can8]\n[plc.terminal]\nsegment = "can7"'


@pytest.mark.parametrize(
    ("node", "heartbeat_ms", "owner"),
    [(20, 0, None), (3, 0, "axis Z"), (5, 0, None), (5, 20, "the kernel"), (20, 20, None)],
)
def test_it_is_no_axis_and_not_the_kernel_where_that_has_a_heartbeat(
    rig_file: Callable[..., Path],
    settings_of: Read,
    node: int,
    heartbeat_ms: int,
    owner: str | None,
) -> None:
    """Z has 3, the kernel 5; without a heartbeat the kernel sends nothing by its number."""
    cycle = f"{OFFSET}\nmaster_node = 5\nheartbeat_ms = {heartbeat_ms}"
    path = rig_file((OFFSET, cycle), ("[plant.z]\n", TERMINAL.format(node=node)))
    (path.parent / "plc.py").write_text("", encoding="utf-8")
    settings = settings_of(path)
    if owner is None:
        check_terminal(settings)
        return
    with pytest.raises(UserError) as caught:
        check_terminal(settings)
    assert f"has the node id of {owner} on segment can1" in caught.value.message
    assert caught.value.value == node
    assert caught.value.file == str(path)
    assert caught.value.line == 1 + path.read_text().splitlines().index(f"node = {node}", 20)


def test_the_number_of_an_axis_is_free_on_another_bus(rig_above: Read) -> None:
    settings = rig_above("plc-io-node.toml", f"{OWN_BUS}\nnode = 3")
    check_terminal(settings)


@pytest.mark.parametrize(
    ("base", "text", "synced"),
    [
        ("probe-z.toml", "", {"can1"}),
        ("probe-xyz-mixed.toml", "", {"can1", "can2"}),  # ec1 is a line
        ("probe-z.toml", "[segment.can8]\n", {"can1"}),  # nobody is there
        ("plc-io-node.toml", "", {"can1"}),
        ("plc-io-node.toml", OWN_BUS, {"can1", "can7"}),
        ("plc-timestamp.toml", "[segment.can8]\n", {"can1"}),  # on the fieldbus of the PLC
        ("plc-timestamp-line.toml", "", set()),
        ("plc-timestamp-line.toml", '[segment.can7]\n[plc.terminal]\nsegment = "can7"\nnode = 9',
         {"can7"}),
        ("plc-radio.toml", "[segment.can8]\n", {"can1"}),  # a task without a terminal
    ],
)  # fmt: skip
def test_a_bus_with_an_axis_or_the_terminal_has_the_sync(
    rig_above: Read, base: str, text: str, synced: set[str]
) -> None:
    """On a bus where nobody is nobody would acknowledge it."""
    assert synced_segments(rig_above(base, text)) == synced


@pytest.mark.parametrize(
    ("base", "text", "is_node"),
    [
        ("probe-z.toml", "", False),
        ("plc-radio.toml", "", False),
        ("plc-timestamp.toml", "", False),
        ("plc-timestamp-line.toml", "", False),
        ("plc-io-node.toml", "", True),
        ("plc-io-node.toml", OWN_BUS, True),
    ],
)
def test_a_terminal_with_a_number_is_a_node_and_no_other_is(
    rig_above: Read, base: str, text: str, is_node: bool
) -> None:
    settings = rig_above(base, text)
    assert (node_table(settings) is not None) is is_node
    assert (terminal_telegrams(settings) is not None) is is_node
    found = [terminal_frames(settings, name, ()) for name in settings.segment]
    assert any(found) is is_node


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # SYNC and answer at their shortest: 44 + 3 + 44 + 8 bits (Bosch CAN 2.0)
        ("", NodeTelegrams("can1", 0x180 + 20, 1000 * US, 99 * US, 600 * US)),
        ("[plc.terminal]\nnode = 127", NodeTelegrams("can1", 0x1FF, 1000 * US, 99 * US, 600 * US)),
        (OWN_BUS, NodeTelegrams("can7", 0x194, 1000 * US, 198 * US, 600 * US)),
        ("[cycle]\nsync_counter = 10", NodeTelegrams("can1", 0x194, 1000 * US, 107 * US, 600 * US)),
        ("[cycle]\nperiod_us = 2000\ncycle_offset_us = 1700",
         NodeTelegrams("can1", 0x194, 2000 * US, 99 * US, 1700 * US)),
        ('[segment.can1]\ninterface = "socketcan"\nchannel = "can7"',
         NodeTelegrams("can1", 0x194, 1000 * US, 0, 600 * US)),
    ],
)  # fmt: skip
def test_its_inputs_answer_the_sync_of_its_bus(
    rig_above: Read, text: str, expected: NodeTelegrams
) -> None:
    """TPDO1 of the pre-defined connection set (CiA 301) after the SYNC, before the NC cycle."""
    assert terminal_telegrams(rig_above("plc-io-node.toml", text)) == expected


RARE = (("EMCY", 0x80), ("SDO answer", 0x580), ("SDO request", 0x600))


@pytest.mark.parametrize(
    ("heartbeat_ms", "rare"), [(0, ()), (50, ()), (0, RARE), (50, RARE), (1, RARE[:1])]
)
@pytest.mark.parametrize(("text", "bus"), [("", "can1"), (OWN_BUS, "can7")])
def test_its_bus_carries_its_frames_and_another_none(
    rig_above: Read, heartbeat_ms: int, rare: tuple[tuple[str, int], ...], text: str, bus: str
) -> None:
    """One byte of inputs and of the state; an SDO has 8. It has no emergencies."""
    key = f"plc:terminal.heartbeat_ms={heartbeat_ms}"
    settings = rig_above("plc-io-node.toml", text, key)
    expected = [("SYNC", "terminal.TPDO1", 0x194, 1)]
    expected += [("event", "terminal.heartbeat", 0x714, 1)] if heartbeat_ms else []
    for what, base in rare:
        if what != "EMCY":
            expected.append(("event", f"terminal.{what}", base + 20, 8))
    for name in settings.segment:
        schedule = schedule_of(settings, name, counters=False, rare=rare)
        found = [
            (at, frame.name, frame.can_id, frame.data_bytes)
            for at, frame in schedule.frames
            if frame.name.startswith("terminal.")
        ]
        assert sorted(found) == (sorted(expected) if name == bus else [])


@pytest.mark.parametrize(
    ("base", "text", "words", "value", "allowed"),
    [
        ("plc-io-node.toml", '[plc.terminal]\nsegment = "can7"',
         "the node of the terminal needs a simulated segment of this rig", "can7", "can1"),
        ("plc-io-node.toml", '[segment.can1]\ninterface = "socketcan"\nchannel = "can7"',
         "the node of the terminal needs a simulated segment of this rig", "can1",
         "none in this rig"),
        ("plc-timestamp-line.toml", "[plc.terminal]\nnode = 9",
         "the node of the terminal needs a simulated segment of this rig", "ec1",
         "none in this rig"),
        ("plc-signal.toml", '[plc.terminal]\nsegment = "can1"',
         "a terminal on a CAN bus needs a node number; without one it is on an EtherCAT line",
         "can1", "no line in this rig: give it a node"),
        ("plc-timestamp-line.toml", '[plc.terminal]\nsegment = "ec2"',
         "a terminal on a CAN bus needs a node number; without one it is on an EtherCAT line",
         "ec2", "ec1"),
    ],
)  # fmt: skip
def test_a_bus_that_cannot_have_it_is_refused_with_those_that_can(
    rig_above: Read, tmp_path: Path, base: str, text: str, words: str, value: str, allowed: str
) -> None:
    settings = rig_above(base, text)
    with pytest.raises(UserError) as caught:
        check_terminal(settings)
    assert caught.value.message == words
    assert caught.value.value == value
    assert f"allowed: {allowed}" in str(caught.value)
    own = (tmp_path / "rig.toml").read_text().splitlines()
    if f'segment = "{value}"' in own:
        where = (str(tmp_path / "rig.toml"), 1 + own.index(f'segment = "{value}"'))
        assert (caught.value.file, caught.value.line) == where


@pytest.mark.parametrize("base", ["probe-z.toml", "plc-radio.toml", "plc-timestamp.toml",
                                  "plc-timestamp-line.toml", "plc-io-node.toml"])  # fmt: skip
def test_a_terminal_where_it_can_be_is_taken(rig_above: Read, base: str) -> None:
    check_terminal(rig_above(base))
