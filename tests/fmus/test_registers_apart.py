"""Registers that are some apart: what an operation reads and stores lies in steps of a stride."""

from collections.abc import Sequence
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import Expr, apply, parameter
from axisrig.fmus.reading.programs import read_program

LOADED = [{"kind": "LoadP", "dst": 10 + number, "index": number} for number in range(12)]


def _unused(*_: object) -> Any:
    raise AssertionError


def read(*ops: Any) -> dict[int, Expr]:
    """Register 10 + n holds parameter n."""
    return read_program([*LOADED, *ops], _unused, _unused)


@pytest.mark.parametrize(
    ("start", "stride", "places", "stored"),
    [
        (10, 1, (0, 1, 2), (0, 1, 2)),
        (10, 2, (0, 1, 2), (0, 2, 4)),
        (13, 3, (4, 7), (3, 6)),
        (11, 4, (2, 0, 1), (1, 5, 9)),
        (15, 0, (0, 1), (5, 5)),
    ],
)
def test_a_range_is_stored_in_steps_of_its_stride(
    start: int, stride: int, places: Sequence[int], stored: Sequence[int]
) -> None:
    found = read({"kind": "StoreOutputRange", "start": start, "stride": stride,
                  "output_indices": list(places)})  # fmt: skip
    assert found == {place: parameter(number) for place, number in zip(places, stored, strict=True)}


@pytest.mark.parametrize(
    ("lhs", "rhs"), [((10, 1), (13, 1)), ((10, 2), (11, 2)), ((10, 0), (14, 3)), ((18, 1), (10, 4))]
)
def test_both_sides_of_an_array_operation_have_a_stride(
    lhs: tuple[int, int], rhs: tuple[int, int]
) -> None:
    """0: one number goes with each."""
    op = {"kind": "TensorBinary", "operator": "Sub", "count": 3, "dst_start": 40,
          "lhs_start": lhs[0], "lhs_stride": lhs[1], "rhs_start": rhs[0],
          "rhs_stride": rhs[1]}  # fmt: skip
    store = {"kind": "StoreOutputRange", "start": 40, "stride": 1, "output_indices": [0, 1, 2]}
    assert read(op, store) == {
        k: apply("Sub", parameter(lhs[0] - 10 + k * lhs[1]), parameter(rhs[0] - 10 + k * rhs[1]))
        for k in range(3)
    }


@pytest.mark.parametrize("stride", [1, 2])
@pytest.mark.parametrize(("row", "column"), [(1, 1), (1, 3), (2, 1), (2, 2), (2, 3)])
def test_an_element_of_a_matrix_counts_its_rows_and_columns_from_1(
    row: int, column: int, stride: int
) -> None:
    """Of 2 rows with 3 columns each, row by row."""
    op = {"kind": "LoadIndexedRegister", "base": 10, "stride": stride, "dimensions": [2, 3],
          "indices": [{"Constant": row}, {"Constant": column}], "dst": 40}  # fmt: skip
    found = read(op, {"kind": "StoreOutput", "src": 40, "output_index": 0})
    assert found == {0: parameter(((row - 1) * 3 + column - 1) * stride)}
