"""Register programs that branch: what an arm takes from around it, and which arm wins.

Programs are written in the compiler's form: an operation each, registers in a row.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import (
    ONE,
    TIME,
    ZERO,
    Expr,
    UnsupportedError,
    choice,
    const,
    parameter,
    variable,
)
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


# --- leaves, and what is refused


def test_arrays_are_loaded_from_parameters_or_variables_one_after_the_other() -> None:
    for source, leaf in (("P", parameter), ("Y", variable)):
        load = {"kind": "TensorLoad", "input": source, "input_start": 5, "count": 3}
        assert read({**load, "dst_start": 30}, 3) == [leaf(5), leaf(6), leaf(7)]
    assert read({"kind": "LoadY", "index": 4, "dst": 30}, 1) == [variable(4)]
    assert read({"kind": "LoadTime", "dst": 30}, 1) == [TIME]
    assert read({"kind": "Move", "src": 13, "dst": 30}, 1) == [P[3]]


def test_filled_and_identity_arrays() -> None:
    assert read({"kind": "TensorFill", "value_start": 12, "count": 3, "dst_start": 30}, 3) == [
        P[2], P[2], P[2],
    ]  # fmt: skip
    found = read({"kind": "TensorIdentity", "size": 3, "dst_start": 30}, 9)
    assert found == [ONE if k in (0, 4, 8) else ZERO for k in range(9)]


def test_an_element_is_found_by_the_stride_of_its_array() -> None:
    """Every other register: (p0 p2; p4 p6), its second row and second column."""
    op = {"kind": "LoadIndexedRegister", "base": 10, "stride": 2, "dimensions": [2, 2], "dst": 30}
    for row, column, number in ((1, 1, 0), (1, 2, 2), (2, 1, 4), (2, 2, 6)):
        assert read({**op, "indices": [{"Constant": row}, {"Constant": column}]}, 1) == [P[number]]


def test_a_system_of_three_has_nine_numbers_and_three() -> None:
    loaded = [{"kind": "LoadP", "dst": 40 + k, "index": k} for k in range(12)]
    places = {"matrix_start": 40, "rhs_start": 49, "n": 3}
    solve = {"kind": "LinearSolveComponent", **places, "component": 2, "dst": 60}
    store = {"kind": "StoreOutput", "src": 60, "output_index": 0}

    def linear(matrix: Sequence[Expr], right: Sequence[Expr]) -> Expr:
        assert list(matrix) == [parameter(k) for k in range(9)]
        assert list(right) == [parameter(k) for k in (9, 10, 11)]
        return Expr("System", [*matrix, *right])

    (found,) = read_program([*loaded, solve, store], _unused, linear).values()
    assert (found.kind, found.index, found.args[0].kind) == ("Component", 2, "System")


@pytest.mark.parametrize(
    ("a", "b", "is_modulo"),
    [(P[0], P[1], True), (P[0], const(2.0), True), (variable(3), P[1], False)],
)
def test_a_difference_to_whole_multiples_is_a_modulo_unless_it_moves(
    a: Expr, b: Expr, is_modulo: bool
) -> None:
    """a - floor(a/b)*b. Where a moves, the floor is an event of its own."""
    made = {0: a, 1: b}
    whole = Expr("Floor", (Expr("Div", (a, b)),))
    known = [*(_load(dst, value) for dst, value in made.items())]
    ops = [
        *known, {"kind": "Binary", "operator": "Div", "lhs": 0, "rhs": 1, "dst": 2},
        {"kind": "Unary", "operator": "Floor", "arg": 2, "dst": 3},
        {"kind": "Binary", "operator": "Mul", "lhs": 3, "rhs": 1, "dst": 4},
        {"kind": "Binary", "operator": "Sub", "lhs": 0, "rhs": 4, "dst": 5},
        {"kind": "StoreOutput", "src": 5, "output_index": 0},
    ]  # fmt: skip
    (found,) = read_program(ops, _unused, _unused).values()
    assert found == (Expr("Mod", (a, b)) if is_modulo else Expr("Sub", (a, mul(whole, b))))


def _load(dst: int, value: Expr) -> Op:
    if value.kind == "const":
        return {"kind": "Const", "value": value.value, "value_class": "finite", "dst": dst}
    return {"kind": {"p": "LoadP", "y": "LoadY"}[value.kind], "index": value.index, "dst": dst}


@pytest.mark.parametrize(
    ("floor_of", "times"),
    [((0, 2), 1), ((1, 0), 0), ((0, 1), 2), ((2, 1), 1)],  # of another quotient or divisor
)
def test_any_other_product_of_whole_numbers_is_taken_away_as_it_is(
    floor_of: tuple[int, int], times: int
) -> None:
    ops = [
        *LOADED,
        {"kind": "Binary", "operator": "Div", "lhs": 10 + floor_of[0], "rhs": 10 + floor_of[1],
         "dst": 20},
        {"kind": "Unary", "operator": "Floor", "arg": 20, "dst": 21},
        {"kind": "Binary", "operator": "Mul", "lhs": 21, "rhs": 10 + times, "dst": 22},
        {"kind": "Binary", "operator": "Sub", "lhs": 10, "rhs": 22, "dst": 23},
        {"kind": "StoreOutput", "src": 23, "output_index": 0},
    ]  # fmt: skip
    (found,) = read_program(ops, _unused, _unused).values()
    whole = Expr("Floor", (Expr("Div", (P[floor_of[0]], P[floor_of[1]])),))
    assert found == Expr("Sub", (P[0], mul(whole, P[times])))


@pytest.mark.parametrize(
    ("op", "words"),
    [
        ({"kind": "Unary", "operator": "Turn", "arg": 10}, "the operation Unary Turn of"),
        ({"kind": "Miracle"}, "the operation Miracle of"),
        ({"kind": "Move", "src": 10, "lanes": 2}, "the operation Move of"),
        ({"kind": "Const", "value": 7, "value_class": "huge"}, "a number of the class huge"),
        *(({"kind": "TensorLoad", "input": word, "input_start": 0, "count": 1},
           f"an array from {word}") for word in ("T", "X", "y")),
        ({"kind": "LoadIndexedRegister", "base": 10, "stride": 1, "dimensions": [2],
          "indices": [{"Range": 1}]}, "an array index of the form Range"),
        ({"kind": "TensorBinary", "operator": "Lt", "lhs_start": 10, "lhs_stride": 1,
          "rhs_start": 12, "rhs_stride": 1, "count": 2}, "the array operation Lt"),
    ],
)  # fmt: skip
def test_what_is_not_known_is_named(op: Op, words: str) -> None:
    with pytest.raises(UnsupportedError, match=words):
        read({**op, "dst": 30}, 1)


def test_one_lane_is_an_operation_like_any_other() -> None:
    assert read({"kind": "Move", "src": 12, "lanes": 1, "dst": 30}, 1) == [P[2]]
