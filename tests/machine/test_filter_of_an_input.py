"""An input of a PLC terminal with a filter of 10 us: which edges pass it, to the nanosecond."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.plc.terminal import ChannelInput, InputChannel
from axisrig.bench.rig.reading.plc_task import TerminalTable

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

TABLE = TerminalTable(input_1="probe", filter_us=10)


def exchanged(end_ns: int, *edges: tuple[int, bool], level: bool = False) -> ChannelInput:
    signal: Any = SimpleNamespace(edges=list(edges), level=level)
    return InputChannel(signal, TABLE, 0).exchange(end_ns, lambda at_ns: at_ns, ChannelInput())


def test_an_edge_is_through_when_its_filter_is_over() -> None:
    assert exchanged(10_999, (1_000, True)) == ChannelInput(False, 0, 0)
    assert exchanged(11_000, (1_000, True)) == ChannelInput(True, 11_000, 0)


def test_a_pulse_as_long_as_the_filter_passes_and_a_shorter_one_does_not() -> None:
    assert exchanged(30_000, (1_000, True), (11_000, False)) == ChannelInput(False, 11_000, 21_000)
    assert exchanged(30_000, (1_000, True), (10_999, False)) == ChannelInput(False, 0, 0)


@pytest.mark.parametrize("level", [False, True])
def test_before_its_first_edge_an_input_has_the_other_level(level: bool) -> None:
    """The signal may have changed since; without an edge it is that of the signal."""
    assert exchanged(500, (1_000, level), level=level).input is not level
    assert exchanged(500, level=level).input is level
