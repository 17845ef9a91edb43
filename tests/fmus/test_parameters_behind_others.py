"""Parameters that act only through others, over several steps, and in clauses of arrays."""

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_parameters_that_are_read import ROWS, row, when

from axisrig.fmus.reading.expressions import TIME, Expr, apply, const, parameter, variable
from axisrig.fmus.writing.fixed_parameters import folded_slots

NAMES = ("a", "b", "c", "d", "e")
SLOTS = {name: at for at, name in enumerate(NAMES)}


def folded(
    follows: Mapping[str, Sequence[str]], read: Sequence[str], mentioned: Sequence[str]
) -> str:
    """Names of parameters without an effect.

    follows: calculated parameters and those that they are made of. read: those that an equation of
    the FMU reads. mentioned: those that equations of the model name.
    """

    def sum_of(names: Sequence[str]) -> Expr:
        value = TIME
        for name in names:
            value = apply("Add", value, parameter(SLOTS[name]))
        return value

    ir: Any = SimpleNamespace(
        solve={"layout": {"bindings": {name: {"P": {"index": at}} for name, at in SLOTS.items()}}},
        dae={"variables": [
            {"name": name, "role": "parameter", "scalar_names": [name]} for name in NAMES
        ]},
        flat={
            "when_chains": [],
            "equations": [{"VarRef": {"name": {"name": name}}} for name in mentioned],
        },
    )  # fmt: skip
    empty = dict.fromkeys(
        (*ROWS, "initial", "relations", "actions", "schedules", "blocks", "previous"), ()
    )
    system: Any = SimpleNamespace(**empty)
    system.initial = [row(sum_of(of), "p", SLOTS[name]) for name, of in follows.items()]
    system.algebraics = [row(sum_of(read))]
    return "".join(name for name in NAMES if SLOTS[name] in folded_slots(ir, system))


@pytest.mark.parametrize(
    ("follows", "read", "mentioned", "without"),
    [
        # e is made of d, d of c, c of b, b of a: an equation named e, and none reads it
        ({"e": "d", "d": "c", "c": "b", "b": "a"}, "", "e", "abcde"),
        ({"e": "d", "d": "c", "c": "b", "b": "a"}, "e", "e", ""),
        ({"e": "d", "d": "c"}, "ab", "e", "cde"),
        ({"e": "cd", "d": "ab"}, "", "e", "abcde"),
        # What nobody names has the effect that the model says: on the parameters made of it
        ({"e": "d", "d": "c"}, "ab", "", ""),
        ({"b": "a"}, "bcde", "b", ""),
        ({}, "abcde", "abcde", ""),
        ({}, "ace", "abcde", "bd"),
    ],
)
def test_a_parameter_is_without_effect_when_all_that_follows_from_it_is(
    follows: Mapping[str, Sequence[str]], read: str, mentioned: str, without: str
) -> None:
    """Over any number of steps."""
    assert folded(follows, read, mentioned) == without


@pytest.mark.parametrize(
    ("targets", "reads", "is_folded"),
    [
        (("n",), {"n": "a"}, False),
        (("n",), {"n": ""}, True),
        (("m",), {"m[1]": "a", "m[2]": ""}, False),
        (("m",), {"m[1]": "", "m[2]": "a"}, False),
        (("m",), {"m[1]": "", "m[2]": ""}, True),
        (("m",), {"m[1]": "", "m[2]": "", "mm": "a"}, True),  # another variable
        (("n", "m"), {"n": "a", "m[1]": "", "m[2]": ""}, True),
    ],
)
def test_a_clause_of_an_array_has_the_programs_of_its_elements(
    targets: Sequence[str], reads: Mapping[str, str], is_folded: bool
) -> None:
    """A condition on `a` is decided where no program of the variable reads it."""
    slots = {"a": 0} | {name: 5 + at for at, name in enumerate(reads)}
    ir: Any = SimpleNamespace(
        solve={"layout": {"bindings": {name: {"P": {"index": at}} for name, at in slots.items()}}},
        dae={"variables": [{"name": "a", "role": "parameter", "scalar_names": ["a"]}]},
        flat={"when_chains": [when(target, "a") for target in targets]},
    )
    empty = dict.fromkeys(
        (*ROWS, "initial", "relations", "actions", "schedules", "blocks", "previous"), ()
    )
    system: Any = SimpleNamespace(**empty)
    system.whens = [
        row(parameter(0) if of else const(1.0), "p", slots[name]) for name, of in reads.items()
    ]
    system.algebraics = [row(apply("Mul", parameter(0), variable(0)))]
    assert (0 in folded_slots(ir, system)) is is_folded
