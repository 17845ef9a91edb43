"""Cyclic values of two fields and axes, taken block by block."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.machine.canopen.telegram_log import TelegramLog
from axisrig.bench.machine.recording.cyclic_values import CyclicValues
from axisrig.bench.record.series import ACTUAL, FRAME_NS, INCREMENTS, TARGET
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.kernel.time.clock import MS, US


def lists(columns: dict[str, pa.Array], axis: str, field: str) -> list[list[tuple[int, int]]]:
    """Pairs of instant and increments, by row."""
    parts = (columns[f"{axis}.{field}_{part}"].to_pylist() for part in (FRAME_NS, INCREMENTS))
    return [list(zip(*row, strict=True)) for row in zip(*parts, strict=True)]


def put(values: CyclicValues, axis: str, field: str, *pairs: tuple[int, int]) -> None:
    for frame_ns, increments in pairs:
        noted = values.of(axis, field)
        noted.frame_ns.append(frame_ns)
        noted.increments.append(increments)


def test_each_row_has_the_values_up_to_its_instant_and_each_block_what_none_before_had() -> None:
    values = CyclicValues()
    put(values, "X", TARGET, (5, 1), (10, 2), (11, 3), (31, 4))
    put(values, "X", ACTUAL, (7, -1), (30, -2))
    put(values, "Z", TARGET, (20, 9))
    first = values.take_columns(np.array([10, 20]), is_last=False)
    assert lists(first, "X", TARGET) == [[(5, 1), (10, 2)], [(11, 3)]]
    assert lists(first, "X", ACTUAL) == [[(7, -1)], []]
    assert lists(first, "Z", TARGET) == [[], [(20, 9)]]
    put(values, "X", TARGET, (45, 5))
    put(values, "Z", TARGET, (33, 8))
    second = values.take_columns(np.array([30, 40]), is_last=False)
    assert lists(second, "X", TARGET) == [[], [(31, 4)]]
    assert lists(second, "X", ACTUAL) == [[(30, -2)], []]
    assert lists(second, "Z", TARGET) == [[], [(33, 8)]]
    put(values, "X", ACTUAL, (70, -3))
    last = values.take_columns(np.array([50, 60]), is_last=True)
    assert lists(last, "X", TARGET) == [[(45, 5)], []]
    assert lists(last, "X", ACTUAL) == [[], [(70, -3)]]
    assert lists(last, "Z", TARGET) == [[], []]


@pytest.mark.interpreted
def test_telegrams_of_a_node_are_in_one_row_and_in_no_block_again() -> None:
    """One ends 0.3 ms after each SYNC: it belongs to the row of the next one, or to the last."""
    taken: list[Any] = []
    journal: Any = SimpleNamespace(add=taken.append, drain=lambda: None)
    log = TelegramLog([], journal, NodeTelegrams("can1", 0x194, MS, 99 * US, 600 * US))
    frame = SimpleNamespace(arbitration_id=0x194, data=b"\x01")

    def rows(ends_ms: list[float], times_ms: list[int], *, is_last: bool) -> list[list[int]]:
        taken[0]([(round(at * MS), "can1", frame, False) for at in ends_ms])
        columns = log.take_columns(np.array(times_ms) * MS, is_last=is_last)
        found: list[list[int]] = columns["plc.inputs_frame_ns"].to_pylist()
        return found

    first = rows([0.3, 1.3, 2.3], [0, 1, 2], is_last=False)
    assert first == [[], [300 * US], [1300 * US]]
    assert rows([3.3], [3], is_last=False) == [[2300 * US]]
    assert rows([4.3, 5.3], [4, 5], is_last=True) == [[3300 * US], [4300 * US, 5300 * US]]
