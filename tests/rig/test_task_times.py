"""Times of a PLC task and its terminal that follow from their keys, in whole ns."""

from typing import Any

import pytest

from axisrig.bench.rig.reading.plc_task import PlcTaskTable
from axisrig.kernel.time.clock import MS, US


def task(**keys: Any) -> PlcTaskTable:
    return PlcTaskTable.model_validate({"period_us": 2000, "program": "p.py", **keys})


@pytest.mark.parametrize(
    ("keys", "late_us"),
    [
        ({}, 2000),
        ({"busy_us": 500}, 2500),
        ({"busy_us": 2000}, 4000),  # as long as its period: none is left out
        ({"busy_us": 2001}, 6001),  # every second one is
        ({"busy_us": 4500}, 10_500),
        ({"terminal": {}}, 4000),  # exchanges in the cycle of the task
        ({"terminal": {"cycle_us": 500, "filter_us": 70}}, 2570),
        ({"busy_us": 500, "terminal": {"cycle_us": 4000}}, 6500),
        # A node on a CAN bus: sampled at a SYNC, its telegram is there before the next one
        ({"terminal": {"segment": "can1", "node": 9, "filter_us": 30}}, 2000 + 2 * 8000 + 30),
        # So are the inputs of the last slave of a line in their frame
        ({"busy_us": 300, "terminal": {"segment": "ec1"}}, 2000 + 300 + 2 * 8000),
    ],
)
def test_an_edge_takes_its_filter_an_exchange_and_the_cycles_of_the_task(
    keys: dict[str, Any], late_us: int
) -> None:
    """period x the cycles until one runs that begins after the edge, and the time that it takes."""
    assert task(**keys).late_ns(8 * MS) == late_us * US


@pytest.mark.parametrize(
    ("own", "terminal", "cycle_us", "offset_us"),
    [
        ({"offset_us": 300}, {}, 2000, 300),
        ({"offset_us": 300}, {"offset_us": 0}, 2000, 0),
        ({"offset_us": 1300}, {"cycle_us": 500}, 500, 300),  # within its own cycle
        ({"offset_us": 300}, {"cycle_us": 500, "offset_us": 450}, 500, 450),
    ],
)
def test_a_terminal_exchanges_with_its_task_where_it_says_nothing_else(
    own: dict[str, Any], terminal: dict[str, Any], cycle_us: int, offset_us: int
) -> None:
    made = task(**own, terminal=terminal)
    assert made.terminal is not None
    assert made.terminal.cycle_ns(made) == cycle_us * US
    assert made.terminal.offset_ns(made) == offset_us * US


def test_channels_have_the_probes_that_are_wired_to_them() -> None:
    for wired, inputs in (
        ({}, {}),
        ({"input_1": "a"}, {1: "a"}),
        ({"input_2": "b"}, {2: "b"}),
        ({"input_1": "a", "input_2": "b"}, {1: "a", 2: "b"}),
    ):
        terminal = task(terminal=wired).terminal
        assert terminal is not None
        assert terminal.inputs == inputs
