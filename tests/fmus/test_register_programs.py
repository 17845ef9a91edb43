"""Register programs that branch: what an arm takes from around it, and which arm wins.

Programs are written in the compiler's form: an operation each, registers in a row.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import Expr, UnsupportedError, choice, parameter
from axisrig.fmus.reading.programs import read_program

P = [parameter(number) for number in range(8)]
LOADED = [{"kind": "LoadP", "dst": 10 + number, "index": number} for number in range(8)]
Op = Mapping[str, Any]


def _unused(*_: object) -> Any:
    raise AssertionError


def captured(*places: int) -> dict[str, Any]:
    """A program whose results are captured values of these places."""
    kind = "LoadFunctionConditionalCapture"
    loads = [{"kind": kind, "dst": k, "index": place} for k, place in enumerate(places)]
    stores = [{"kind": "StoreOutput", "src": k, "output_index": k} for k in range(len(places))]
    return {"ops": [*loads, *stores]}


def in_a_row(start: int, count: int) -> dict[str, Any]:
    """A program whose results are captured values in a row."""
    kind = "LoadFunctionConditionalCaptureRange"
    load = {"kind": kind, "dst_start": 5, "index_start": start, "count": count}
    indices = list(range(count))
    store = {"kind": "StoreOutputRange", "start": 5, "stride": 1, "output_indices": indices}
    return {"ops": [load, store]}


def read(op: Op, results: int) -> Sequence[Expr]:
    stores = [{"kind": "StoreOutput", "src": 30 + k, "output_index": k} for k in range(results)]
    found = read_program([*LOADED, op, *stores], _unused, _unused)
    return [found[k] for k in range(results)]


def conditional(*arms: tuple[Any, Any], fallback: Any, widths: Sequence[int]) -> Op:
    """It captures parameters 2 to 6."""
    return {
        "kind": "FunctionConditional", "dst_start": 30, "capture_start": 12, "capture_count": 5,
        "arms": [{"condition": condition, "result": result} for condition, result in arms],
        "fallback": fallback, "target_widths": list(widths),
    }  # fmt: skip


def test_the_first_true_arm_gives_every_result_from_what_it_has_captured() -> None:
    first = captured(0), captured(1, 2)
    second = captured(3), in_a_row(2, 2)
    found = read(conditional(first, second, fallback=captured(4, 0), widths=(1, 1)), 2)
    assert found == [
        choice(P[2], P[3], choice(P[5], P[4], P[6])),
        choice(P[2], P[4], choice(P[5], P[5], P[2])),
    ]


def test_an_arm_has_captures_of_its_own_branch_only() -> None:
    """A branch inside takes the captures of the arm that it is in, by their new places."""
    inner = {
        "kind": "FunctionConditional", "dst_start": 3, "capture_start": 0, "capture_count": 2,
        "arms": [{"condition": captured(0), "result": captured(1)}],
        "fallback": captured(0), "target_widths": [1],
    }  # fmt: skip
    loads = [
        {"kind": "LoadFunctionConditionalCapture", "dst": k, "index": place}
        for k, place in enumerate((4, 3))
    ]
    store = {"kind": "StoreOutput", "src": 3, "output_index": 0}
    outer = conditional(
        (captured(0), {"ops": [*loads, inner, store]}), fallback=captured(1), widths=(1,)
    )
    assert read(outer, 1) == [choice(P[2], choice(P[6], P[5], P[6]), P[3])]


def test_another_number_of_results_stops_the_build() -> None:
    for widths in ((1,), (2, 1)):
        with pytest.raises(UnsupportedError, match="a conditional of another shape"):
            read(conditional(fallback=captured(0, 1), widths=widths), 1)
    (found,) = read(conditional(fallback=captured(3), widths=(1,)), 1)
    assert found == P[5]


# --- arrays: expected nodes by hand, element by element


def mul(a: Expr, b: Expr) -> Expr:
    return Expr("Mul", (a, b))


def test_each_operand_of_an_array_operation_has_its_own_stride() -> None:
    """A stride of 0 is one number for all elements, on either side."""
    places = {"lhs_start": 10, "rhs_start": 14, "count": 3, "dst_start": 30}
    for strides, expected in (
        ((1, 1), [(0, 4), (1, 5), (2, 6)]),
        ((1, 0), [(0, 4), (1, 4), (2, 4)]),
        ((0, 1), [(0, 4), (0, 5), (0, 6)]),
        ((2, 1), [(0, 4), (2, 5), (4, 6)]),
    ):
        steps = dict(zip(("lhs_stride", "rhs_stride"), strides, strict=True))
        found = read({"kind": "TensorBinary", "operator": "Sub", **places, **steps}, 3)
        assert found == [Expr("Sub", (P[a], P[b])) for a, b in expected]


def test_products_of_arrays() -> None:
    """(p0 p1; p2 p3) (p4; p5), p0 p4 + p2 p5 over every other element, and p0..2 x p4..6."""
    matrix = {
        "lhs_start": 10,
        "rhs_start": 14,
        "rows": 2,
        "inner": 2,
        "columns": 1,
        "dst_start": 30,
    }
    assert read({"kind": "MatrixMultiply", **matrix}, 2) == [
        Expr("Add", (mul(P[0], P[4]), mul(P[1], P[5]))),
        Expr("Add", (mul(P[2], P[4]), mul(P[3], P[5]))),
    ]
    dot = {"lhs_start": 10, "rhs_start": 14, "count": 2, "lhs_stride": 2, "dst": 30}
    assert read({"kind": "DotProduct", **dot}, 1) == [
        Expr("Add", (mul(P[0], P[4]), mul(P[2], P[5])))
    ]
    assert read({"kind": "TensorCross", "lhs_start": 10, "rhs_start": 14, "dst_start": 30}, 3) == [
        Expr("Sub", (mul(P[i], P[4 + j]), mul(P[j], P[4 + i]))) for i, j in ((1, 2), (2, 0), (0, 1))
    ]


@pytest.mark.parametrize(
    ("shape", "order"),
    [
        ((2, 3, 1), [0, 3, 1, 4, 2, 5]),
        ((3, 1, 2), [0, 1, 2, 3, 4, 5]),
        ((2, 2, 2), [0, 1, 4, 5, 2, 3, 6, 7]),
    ],
)
def test_a_transposed_array_keeps_its_elements_whole(
    shape: tuple[int, int, int], order: list[int]
) -> None:
    names = dict(zip(("rows", "columns", "element_width"), shape, strict=True))
    found = read({"kind": "TensorTranspose", "src_start": 10, **names, "dst_start": 30}, len(order))
    assert found == [P[k] for k in order]


@pytest.mark.parametrize(
    ("axis", "dimensions", "order"),
    [
        (0, ([2, 2], [1, 2]), [0, 1, 2, 3, 4, 5]),
        (1, ([2, 1], [2, 2]), [0, 2, 3, 1, 4, 5]),
        (1, ([2, 2], [2, 1]), [0, 1, 4, 2, 3, 5]),
    ],
)
def test_arrays_side_by_side(axis: int, dimensions: Sequence[list[int]], order: list[int]) -> None:
    first, second = dimensions
    result = list(first)
    result[axis] += second[axis]
    sources = [
        {"start": 10, "dimensions": first},
        {"start": 10 + first[0] * first[1], "dimensions": second},
    ]
    op = {"kind": "TensorConcatenate", "axis": axis, "dimensions": result, "sources": sources}
    assert read({**op, "dst_start": 30}, 6) == [P[k] for k in order]


def test_an_element_by_a_number_and_by_an_index_that_moves() -> None:
    """Of (p0 p1; p2 p3) the row 2, column p7; no number where the index is outside."""
    op = {"kind": "LoadIndexedRegister", "base": 10, "stride": 1, "dimensions": [2, 2], "dst": 30}
    (found,) = read({**op, "indices": [{"Constant": 2}, {"Runtime": 17}]}, 1)
    first, second = (Expr("Eq", (P[7], Expr("const", value=n))) for n in (1.0, 2.0))
    nothing = Expr("const", value=float("nan"))
    assert found is choice(first, P[2], choice(second, P[3], nothing))
    (found,) = read({**op, "indices": [{"Constant": 1}, {"Constant": 2}]}, 1)
    assert found is P[1]
    (found,) = read({"kind": "LoadIndexedP", "base": 3, "count": 2, "index_ref": 17, "dst": 30}, 1)
    first, second = (Expr("Eq", (P[7], Expr("const", value=n))) for n in (0.0, 1.0))
    assert found is choice(first, P[3], choice(second, P[4], nothing))


def test_two_systems_of_equations_with_one_matrix_have_their_own_right_sides() -> None:
    """(p0 p1; p2 p3) x = (p4; p5), the same matrix with (p6; p7), and the first one's other part.

    What the linear equations mean is asked once for each system.
    """
    asked: list[tuple[list[Expr], list[Expr]]] = []

    def linear(matrix: Sequence[Expr], right: Sequence[Expr]) -> Expr:
        asked.append((list(matrix), list(right)))
        return Expr("System", [*matrix, *right], index=len(asked))

    def part(dst: int, right: int, component: int) -> Op:
        places = {"matrix_start": 10, "rhs_start": right, "n": 2}
        return {"kind": "LinearSolveComponent", **places, "component": component, "dst": dst}

    stores = [{"kind": "StoreOutput", "src": 30 + k, "output_index": k} for k in range(3)]
    ops = [*LOADED, part(30, 14, 0), part(31, 16, 0), part(32, 14, 1), *stores]
    found = read_program(ops, _unused, linear)
    assert asked == [(P[:4], P[4:6]), (P[:4], P[6:8])]
    first, second = (Expr("System", [*P[:4], *P[k : k + 2]], index=n) for k, n in ((4, 1), (6, 2)))
    expected = [(first, 0), (second, 0), (first, 1)]
    assert [found[k] for k in range(3)] == [Expr("Component", (s,), index=n) for s, n in expected]
