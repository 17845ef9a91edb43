"""The node id of a terminal of the PLC on a CAN bus: nobody else may have it on its segment."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.canopen.io_node import check_terminal
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

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


@pytest.mark.parametrize(
    ("node", "heartbeat_ms", "owner"),
    [(20, 0, None), (3, 0, "axis Z"), (5, 0, None), (5, 20, "the kernel"), (20, 20, None)],
)
def test_it_is_no_axis_and_not_the_kernel_where_that_has_a_heartbeat(
    rig_file: Callable[..., Path],
    settings_of: Callable[..., Settings],
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
