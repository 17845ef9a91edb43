"""What a counter in the SYNC, a number of a node and a sub-index are for a rig."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.bus.conftest import wire_bits

from axisrig.bench.rig.canopen.arrival import stamp_clock
from axisrig.bench.rig.canopen.checks import check_nodes
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
OFFSET = "cycle_offset_us = 600"
OTHER = """
[segment.can2]
bitrate = 1_000_000

[axis.Y]
list = "lists/axis-y.lst"
segment = "{segment}"
node = {node}
drive = "servo"
plant = "y"

[plant.y]
fmu = "AxisRig.Drives.ServoAxis"

[plant.z]
"""


@pytest.mark.parametrize(("counter", "data"), [(0, b""), (10, b"\0")])
@pytest.mark.parametrize("bitrate", [1_000_000, 500_000])
def test_a_time_stamp_counts_from_the_end_of_the_sync_with_its_counter(
    rig_file: Write, settings_of: Read, counter: int, data: bytes, bitrate: int
) -> None:
    """From SOF to the end of frame: the bits on the wire up to the check sum and ten more."""
    path = rig_file(
        (OFFSET, f"{OFFSET}\nsync_counter = {counter}"),
        ("bitrate = 1_000_000", f'bitrate = {bitrate}\noverload = "run"'),
    )
    clock = stamp_clock(settings_of(path), "Z")
    assert clock is not None
    bits = len(wire_bits(0x80, data, False, False, len(data))) + 10
    assert clock.sync_ns == bits * 1_000_000_000 // bitrate


@pytest.mark.parametrize(
    ("segment", "node", "is_taken"), [("can1", 3, True), ("can1", 4, False), ("can2", 3, False)]
)
def test_a_node_number_is_taken_on_its_own_segment_alone(
    rig_file: Write, settings_of: Read, segment: str, node: int, is_taken: bool
) -> None:
    path = rig_file(("\n[plant.z]\n", OTHER.format(segment=segment, node=node)))
    settings = settings_of(path)
    if not is_taken:
        check_nodes(settings)
        return
    with pytest.raises(UserError, match="axes Z and Y have the same node id on segment can1"):
        check_nodes(settings)


@pytest.mark.parametrize(
    ("sub", "is_one"), [("255", True), ("0xFF", True), ("256", False), ("999", False)]
)
def test_a_sub_index_has_a_byte(rig_file: Write, settings_of: Read, sub: str, is_one: bool) -> None:
    key = f'lead_mm = 10.0\nsdo = [["0x2000:{sub}", 1]]'
    path = rig_file(("lead_mm = 10.0", key))
    if is_one:
        settings_of(path)
        return
    with pytest.raises(UserError, match=f"0x2000:{sub}' is no object"):
        settings_of(path)
