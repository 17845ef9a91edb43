"""What counts as a use of a parameter, and what an early return, a line and a licence are of."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_documents_of_an_fmu import HEAD, OWN, documents
from tests.fmus.test_icons import drawn
from tests.fmus.test_parameters_behind_others import folded as behind
from tests.fmus.test_parameters_that_are_read import ROWS, row
from tests.fmus.test_variables_of_models import shown

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import apply, const, parameter
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.writing.early import early_levels
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
    """With it goes what it is made of; one that nothing mentions has the effect that it has."""
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


@pytest.mark.parametrize(
    ("given", "is_level"),
    [
        ({}, True), ({"elements": ("b[1]", "b[2]")}, False), ({"type": "Int32"}, False),
        ({"vector": "y"}, False), ({"causality": "local"}, False), ({"causality": "input"}, False),
    ],
)  # fmt: skip
def test_an_early_return_is_of_one_boolean_output(given: Any, is_level: bool) -> None:
    """Of an array, of a number or of a variable nobody else sees there is no instant to report."""
    text = 'model M\n  annotation(__axisrig(returns_early = " b ,, "));\nend M;\n'
    ir = Ir("M", {}, {}, {}, {1: (Path("/lib/M.mo"), text)}, Path("/lib"))
    one: Any = {"name": "b", "type": "Boolean", "vector": "p", "index": 7, "elements": ("b",)}
    variables = [shown(**(one | given)), shown(name="a", type="Boolean", vector="p", index=3)]
    if is_level:
        assert early_levels(ir, variables) == [7]
    else:
        with pytest.raises(BuildError, match=r"^M: returns_early: b is no .*; there are a$"):
            early_levels(ir, variables)


@pytest.mark.parametrize("kind", ["Line", "Polygon"])
def test_a_line_has_nothing_inside(kind: str) -> None:
    at = drawn(
        f"{kind}(points = {{{{-60, -60}}, {{60, -60}}, {{0, 60}}}}, fillColor = {{255, 0, 0}},"
        " fillPattern = FillPattern.Solid)"
    )
    assert at(0, -20) == ((255, 0, 0) if kind == "Polygon" else None)
    assert at(0, -60) is not None


def test_a_model_of_another_author_has_no_licence_of_ours() -> None:
    name = "documentation/licenses/license.txt"
    for head, is_own in ((OWN, True), (HEAD, False), (HEAD | {"author": "somebody"}, False)):
        text = documents(head=head)[name].decode()
        assert ("its licence is its author's to say" not in text) is is_own
