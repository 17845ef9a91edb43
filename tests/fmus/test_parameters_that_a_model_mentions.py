"""Parameters that no program reads: the model mentions them, or others are computed from them."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_parameters_behind_others import folded as behind
from tests.fmus.test_parameters_that_are_read import ROWS, row

from axisrig.fmus.reading.expressions import apply, const, parameter
from axisrig.fmus.writing.fixed_parameters import folded_slots


def reference(name: str) -> Any:
    return {"VarRef": {"name": {"name": name}}}


def without_effect(**flat: Any) -> set[str]:
    """b = 2 a and s.b = 3 a follow; no program reads any of them."""
    slots = {"a": 0, "b": 1, "s.b": 2}
    ir: Any = SimpleNamespace(
        solve={"layout": {"bindings": {name: {"P": {"index": at}} for name, at in slots.items()}}},
        dae={"variables": [
            {"name": name, "role": "parameter", "scalar_names": [name]} for name in slots
        ]},
        flat={"when_chains": [], **flat},
    )  # fmt: skip
    empty: dict[str, Any] = dict.fromkeys(
        (*ROWS, "relations", "actions", "schedules", "blocks", "previous"), ()
    )
    twice, thrice = (apply("Mul", const(n), parameter(0)) for n in (2.0, 3.0))
    system: Any = SimpleNamespace(**empty, initial=[row(twice, "p", 1), row(thrice, "p", 2)])
    found = folded_slots(ir, system)
    return {name for name, at in slots.items() if at in found}


@pytest.mark.parametrize(
    "place", ["equations", "initial_equations", "algorithms", "initial_algorithms", "when_chains"]
)
@pytest.mark.parametrize("name", ["b", "s.b"])
def test_a_parameter_that_the_model_mentions_was_used_by_the_compiler(
    place: str, name: str
) -> None:
    """Its value went into the equations, and so did that of a, from which it is computed."""
    assert without_effect(**{place: [{"rhs": [reference(name)]}]}) == {"a", name}
    assert without_effect(**{place: [{"rhs": [reference("other")]}]}) == set()
    assert without_effect(variables=[{"binding": reference(name)}]) == set()


@pytest.mark.parametrize(
    ("references", "found"),
    [
        ([["b"]], {"a", "b"}), ([["s", "b"]], {"a", "s.b"}), ([["q", "b"]], set()),
        ([["b"], ["s", "b"]], {"a", "b", "s.b"}), ([], set()),
    ],
)  # fmt: skip
def test_what_decides_the_structure_is_mentioned_by_its_whole_name(
    references: list[list[str]], found: set[str]
) -> None:
    assert without_effect(parameter_branch_selections=[{"references": references}]) == found
    several = [{"references": [each]} for each in references]
    assert without_effect(parameter_branch_selections=several) == found


def test_a_parameter_that_others_follow_acts_through_them_though_it_is_mentioned() -> None:
    """c = b, b = a: an equation reads c, and the model mentions b, which c reads anew."""
    chain = {"b": ["a"], "c": ["b"]}
    assert behind(chain, ["c", "d", "e"], ["b"]) == ""
    assert behind(chain, ["c", "d", "e"], []) == ""
    assert behind(chain, ["d", "e"], ["c"]) == "abc"
