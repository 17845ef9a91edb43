"""The note on parameters that cannot be changed: scalars, and arrays by each of their elements."""

from collections.abc import Collection
from typing import Any

import pytest

from axisrig.fmus.writing.fixed_parameters import NOTE, with_notes
from axisrig.fmus.writing.variables import Variable, scalars


def variable(count: int = 1, **changed: Any) -> Variable:
    """A parameter in the slots of p from 3 on."""
    given: dict[str, Any] = {
        "reference": 2, "name": "k", "type": "Float64", "causality": "parameter",
        "variability": "fixed", "initial": "exact", "dimensions": (count,) if count > 1 else (),
        "elements": tuple(f"k[{n + 1}]" for n in range(count)) if count > 1 else ("k",),
        "start": (1.0,) * count, "unit": None, "minimum": None, "maximum": None, "nominal": None,
        "description": "Rates", "vector": "p", "index": 3, **changed,
    }  # fmt: skip
    return Variable(**given)


def described(one: Variable, folded: Collection[int]) -> str:
    (found,) = with_notes([one], folded)
    return found.description


def test_the_note_says_what_happens() -> None:
    assert NOTE == "(no effect in this FMU: the compiler has used its value)"


@pytest.mark.parametrize(
    ("count", "folded", "has_note"),
    [
        (1, {3}, True), (1, {2, 4}, False), (1, set(), False),
        # an array is marked where any element is fixed: the first, a middle one, the last, several
        (3, {3}, True), (3, {4}, True), (3, {5}, True), (3, {3, 5}, True), (3, {3, 4, 5}, True),
        (3, {2}, False), (3, {6}, False), (3, {0, 1, 2, 6, 7}, False), (3, set(), False),
    ],
)  # fmt: skip
def test_any_element_that_is_fixed_marks_its_array(
    count: int, folded: set[int], has_note: bool
) -> None:
    assert described(variable(count), folded) == (f"Rates {NOTE}" if has_note else "Rates")


@pytest.mark.parametrize(
    ("folded", "marked"),
    [({3}, [True, False, False]), ({5}, [False, False, True]), ({3, 4}, [True, True, False])],
)
def test_scalars_of_an_array_are_marked_one_by_one(folded: set[int], marked: list[bool]) -> None:
    """FMI 2.0 has no arrays."""
    found = with_notes(scalars([variable(3)]), folded)
    assert [one.name for one in found] == ["k[1]", "k[2]", "k[3]"]
    assert [one.description.endswith(NOTE) for one in found] == marked


@pytest.mark.parametrize(
    "changed",
    [
        {"vector": "y"},  # the slots are those of another vector
        {"variability": "constant"}, {"initial": "calculated"}, {"initial": None},
        {"initial": "approx"},
    ],
)  # fmt: skip
def test_what_nobody_can_set_has_no_note(changed: dict[str, Any]) -> None:
    assert described(variable(3, **changed), {3, 4, 5}) == "Rates"


def test_an_input_can_be_set_whatever_its_start() -> None:
    assert described(variable(causality="input", initial=None), {3}) == f"Rates {NOTE}"
    assert described(variable(causality="input", variability="constant"), {3}) == "Rates"


def test_without_a_description_the_note_stands_alone() -> None:
    assert described(variable(description=""), {3}) == NOTE
    assert described(variable(description=""), {9}) == ""


def test_variables_stay_in_their_order_and_nothing_else_of_them_changes() -> None:
    first, second, third = variable(2), variable(index=9, name="b"), variable(index=5, name="c")
    found = with_notes([first, second, third], {9})
    assert found[0] == first
    assert found[2] == third
    assert found[1].description == f"Rates {NOTE}"
    assert {k: v for k, v in vars(found[1]).items() if k != "description"} == {
        k: v for k, v in vars(second).items() if k != "description"
    }
