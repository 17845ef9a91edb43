"""Programs of an initial residual: the compiler's own form becomes that of a plan."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import Expr, UnsupportedError, choice, const, parameter
from axisrig.fmus.reading.programs import plain_programs, read_program

P = [parameter(number) for number in range(8)]
SPAN = {"source": 1, "start": 5, "end": 9}


def residual(*programs: Sequence[Any], indices: Sequence[int], **more: Any) -> Mapping[str, Any]:
    content = {"programs": list(programs), "output_indices": list(indices), **more}
    return {"nodes": [{"ScalarPrograms": content}]}


def load(dst: int, index: int) -> dict[str, Any]:
    return {"LoadP": {"dst": dst, "index": index}}


def store(src: int) -> dict[str, Any]:
    return {"StoreOutput": {"src": src}}


def store_range(start: int, count: int, stride: int = 1) -> dict[str, Any]:
    return {"StoreOutputRange": {"start": start, "count": count, "stride": stride}}


def _unused(*_: object) -> Any:
    raise AssertionError


def outputs(found: Mapping[str, Any]) -> dict[int, Expr]:
    """What a program gives, read as that of a plan."""
    return read_program(found["ops"], _unused, _unused)


def test_outputs_are_numbered_through_all_programs_of_a_node() -> None:
    """One, a range of two and one more; the second program goes on where the first has ended."""
    first = [load(0, 0), load(1, 1), load(2, 2), store(2), store_range(0, 2)]
    second = [load(0, 3), store(0)]
    one, other = plain_programs(residual(first, second, indices=(7, 3, 5, 9)))
    assert outputs(one) == {7: P[2], 3: P[0], 5: P[1]}
    assert outputs(other) == {9: P[3]}


def test_a_range_takes_every_so_many_th_register() -> None:
    program = [*(load(k, k) for k in range(5)), store_range(0, 3, stride=2)]
    (found,) = plain_programs(residual(program, indices=(0, 1, 2)))
    assert outputs(found) == {0: P[0], 1: P[2], 2: P[4]}


def test_nodes_have_numbers_of_their_own_and_come_in_their_order() -> None:
    nodes = [residual([load(0, k), store(0)], indices=(k + 4,))["nodes"][0] for k in (2, 1)]
    assert [outputs(one) for one in plain_programs({"nodes": nodes})] == [{6: P[2]}, {5: P[1]}]
    assert plain_programs({"nodes": []}) == []


@pytest.mark.parametrize(
    ("given", "spans"),
    [({"program_spans": [SPAN, None]}, [SPAN, None]), ({"program_spans": []}, [None, None]),
     ({}, [None, None])],
)  # fmt: skip
def test_a_program_has_its_place_where_the_compiler_gives_it(given: Any, spans: list[Any]) -> None:
    programs = [[load(0, k), store(0)] for k in range(2)]
    found = plain_programs(residual(*programs, indices=(0, 1), **given))
    assert [one["span"] for one in found] == spans


@pytest.mark.parametrize(
    ("value", "expected"),
    [(2.5, 2.5), (3, 3.0), (0.0, 0.0), ("positive_infinity", math.inf),
     ("negative_infinity", -math.inf)],
)  # fmt: skip
def test_a_number_is_finite_or_of_a_class(value: Any, expected: float) -> None:
    program = [{"Const": {"dst": 0, "value": value}}, store(0)]
    (found,) = plain_programs(residual(program, indices=(0,)))
    assert outputs(found) == {0: const(expected)}


def test_what_is_no_number_stays_one() -> None:
    program = [{"Const": {"dst": 0, "value": "nan"}}, store(0)]
    (found,) = plain_programs(residual(program, indices=(0,)))
    assert math.isnan(outputs(found)[0].value)


def test_an_operator_keeps_its_name() -> None:
    ops = [load(0, 0), load(1, 1),
           {"Binary": {"dst": 2, "op": "Sub", "lhs": 0, "rhs": 1}},
           {"Unary": {"dst": 3, "op": "Neg", "arg": 2}},
           {"Compare": {"dst": 4, "op": "Lt", "lhs": 3, "rhs": 0}}, store(4)]  # fmt: skip
    (found,) = plain_programs(residual(ops, indices=(0,)))
    difference = Expr("Sub", (P[0], P[1]))
    assert outputs(found) == {0: Expr("Lt", (Expr("Neg", (difference,)), P[0]))}


def test_a_call_is_that_of_its_site() -> None:
    """The number of the function, not of the place."""
    ops = [load(4, 6), {"PureCall": {"dst_start": 8, "site": {"owner": 3, "call": 9},
                                     "input_starts": [4]}}, store(8), store(9)]  # fmt: skip
    (found,) = plain_programs(residual(ops, indices=(1, 0)))

    def call(owner: int, registers: Mapping[int, Expr], starts: Sequence[int]) -> list[Expr]:
        assert (owner, [registers[start] for start in starts]) == (3, [P[6]])
        return [P[1], P[2]]

    assert read_program(found["ops"], call, _unused) == {1: P[1], 0: P[2]}


def captured(*places: int) -> list[dict[str, Any]]:
    """A program of a branch whose results are captured values."""
    kind = "LoadFunctionConditionalCapture"
    loads = [{kind: {"dst": k, "index": place}} for k, place in enumerate(places)]
    return [*loads, *(store(k) for k in range(len(places)))]


def conditional(results: int, *arms: tuple[Any, Any], fallback: Any, dst: int = 30) -> Any:
    """It captures parameters 1 to 6."""
    program = {
        "arms": [{"condition": condition, "result": result} for condition, result in arms],
        "fallback": fallback,
        "target_widths": [results],
    }
    return {"FunctionConditional": {"dst_start": dst, "capture_start": 11, "capture_count": 6,
                                    "program": program}}  # fmt: skip


LOADED = [load(10 + k, k) for k in range(8)]


@pytest.mark.parametrize("before", [0, 1, 2])
def test_results_of_a_branch_have_numbers_of_their_own(before: int) -> None:
    """Each arm and the end count from 0; outputs beside the branch go on without them."""
    branch = conditional(2, (captured(0), captured(1, 2)), (captured(3), captured(4, 5)),
                         fallback=captured(5, 0))  # fmt: skip
    ops = [*LOADED, *(store(10) for _ in range(before)), branch, store(30), store(31), store(17)]
    indices = [9, 8, 7, 6, 5][: before + 3]
    (found,) = plain_programs(residual(ops, indices=indices))
    results = [
        choice(P[1], P[2], choice(P[4], P[5], P[6])),
        choice(P[1], P[3], choice(P[4], P[6], P[1])),
    ]
    expected = [*[P[0]] * before, *results, P[7]]
    assert outputs(found) == dict(zip(indices, expected, strict=True))


def test_the_end_alone_is_what_a_branch_without_arms_gives() -> None:
    ops = [*LOADED, store(12), conditional(1, fallback=captured(3)), store(30)]
    (found,) = plain_programs(residual(ops, indices=(0, 1)))
    assert outputs(found) == {0: P[2], 1: P[4]}


def test_a_branch_inside_a_branch_is_read_too() -> None:
    """It takes the captures of the arm that it is in."""
    program = {"arms": [{"condition": captured(0), "result": captured(1)}],
               "fallback": captured(0), "target_widths": [1]}  # fmt: skip
    loads = [{"LoadFunctionConditionalCapture": {"dst": k, "index": k + 3}} for k in range(2)]
    inner = {"FunctionConditional": {"dst_start": 5, "capture_start": 0, "capture_count": 2,
                                     "program": program}}  # fmt: skip
    for at in ("arm", "end"):
        deep, flat = [*loads, inner, store(5)], captured(2)
        arm, end = (deep, flat) if at == "arm" else (flat, deep)
        ops = [*LOADED, store(10), conditional(1, (captured(0), arm), fallback=end), store(30)]
        (found,) = plain_programs(residual(ops, indices=(4, 2)))
        chosen = choice(P[4], P[5], P[4])
        parts = (chosen, P[3]) if at == "arm" else (P[3], chosen)
        assert outputs(found) == {4: P[0], 2: choice(P[1], *parts)}


def test_another_form_stops_the_build() -> None:
    with pytest.raises(UnsupportedError, match="a residual of the form TensorPrograms"):
        plain_programs({"nodes": [{"TensorPrograms": {}}]})


def test_what_is_given_stays_as_it_is() -> None:
    """The representation is read several times: calls are matched with it too."""
    ops = [*LOADED, {"Unary": {"dst": 1, "op": "Neg", "arg": 10}},
           conditional(1, (captured(0), captured(1)), fallback=captured(2)), store(30)]  # fmt: skip
    given = residual(ops, indices=(0,))
    first = plain_programs(given)
    assert plain_programs(given) == first
