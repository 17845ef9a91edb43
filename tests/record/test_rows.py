"""Rows of numbers that wait for their block."""

import math
import struct

import numpy as np
import pytest

from axisrig.bench.machine.recording.rows import Rows


def test_numbers_come_back_bit_for_bit_column_by_column() -> None:
    rows = Rows(3)
    given = [(0.1, -0.0, 5e-324), (math.nan, math.inf, 1e308), (True, 7, -math.inf)]
    for row in given:
        rows.add(row)
    columns = rows.take_columns()
    assert columns.shape == (3, 3)
    assert columns.flags.c_contiguous
    assert columns.tobytes() == np.array(given, dtype=np.float64).T.tobytes()


def test_a_block_begins_anew_and_leaves_the_one_before_alone() -> None:
    rows = Rows(1)
    rows.add([1.0])
    first = rows.take_columns()
    rows.add([2.0])
    assert (first.tolist(), rows.take_columns().tolist()) == ([[1.0]], [[2.0]])
    assert rows.take_columns().shape == (1, 0)


def test_rows_without_numbers() -> None:
    rows = Rows(0)
    rows.add([])
    assert rows.take_columns().shape == (0, 1)


def test_a_row_of_another_width_is_a_defect() -> None:
    with pytest.raises(struct.error):
        Rows(2).add([1.0])
