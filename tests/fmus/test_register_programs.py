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
