"""Which parameters have no effect in an FMU: those that nothing reads, whoever may read them."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import TIME, apply, const, parameter, variable
from axisrig.fmus.writing.fixed_parameters import folded_slots

READ = apply("Mul", parameter(0), variable(0))
ROWS = ("derivatives", "algebraics", "runtime", "updates", "whens", "conditions", "reinits")


def row(value: Any, vector: str = "y", index: int = 0) -> Any:
    return SimpleNamespace(vector=vector, index=index, value=value)


def when(target: str, *conditions: str) -> Any:
    """A when-clause whose value is chosen by parameters, a branch for each."""
    branches = [[{"VarRef": {"name": {"name": name}}}, {"Real": 1.0}] for name in conditions]
    return {"target": target, "value": {"If": {"branches": branches}}}


def folded(*chains: Any, **parts: Any) -> set[int]:
    """Slots of the parameters a (0), b (1), c[] (2, 3); n (7), m[] (8, 9) and mm are discrete."""
    slots = {"a": 0, "b": 1, "c[1]": 2, "c[2]": 3, "n": 7, "m[1]": 8, "m[2]": 9, "mm": 10}
    names = {"a": ["a"], "b": ["b"], "c": ["c[1]", "c[2]"]}
    ir: Any = SimpleNamespace(
        solve={"layout": {"bindings": {name: {"P": {"index": at}} for name, at in slots.items()}}},
        dae={
            "variables": [
                {"name": name, "role": "parameter", "scalar_names": elements}
                for name, elements in names.items()
            ]
            + [{"name": "n", "role": "discrete_value", "scalar_names": ["n"]}]
        },
        flat={"when_chains": list(chains)},
    )
    empty = dict.fromkeys(
        (*ROWS, "initial", "relations", "actions", "schedules", "blocks", "previous"), ()
    )
    system: Any = SimpleNamespace(**empty | parts)
    return set(folded_slots(ir, system))


def action(condition: Any = TIME, value: Any = TIME) -> Any:
    return SimpleNamespace(condition=condition, values=[("Real", TIME), ("Real", value)])


def schedule(offset: Any = TIME, interval: Any = TIME) -> Any:
    return 5, SimpleNamespace(offset=offset, interval=interval)


def block(residuals: Any = (), inputs: Any = ()) -> Any:
    return SimpleNamespace(residuals=residuals, inputs=inputs)


@pytest.mark.parametrize(
    "parts",
    [
        *({name: [row(TIME), row(READ)]} for name in ROWS),
        {"initial": [row(TIME), row(READ)]},
        {"initial": [row(READ, "p", 7)]},
        {"relations": [SimpleNamespace(function=TIME), SimpleNamespace(function=READ)]},
        {"actions": [action(), action(condition=READ)]}, {"actions": [action(value=READ)]},
        {"schedules": [schedule(), schedule(offset=READ)]},
        {"schedules": [schedule(interval=READ)]},
        {"blocks": [block(), block(residuals=[TIME, READ])]}, {"blocks": [block(inputs=[READ])]},
        {"previous": [(9, "y", 1), (8, "p", 0)]},
    ],
)  # fmt: skip
def test_a_parameter_has_an_effect_wherever_it_is_read(parts: dict[str, Any]) -> None:
    assert folded(**parts) == {1, 2, 3}


def test_a_state_before_an_event_is_no_parameter() -> None:
    assert folded(previous=[(9, "y", 0)]) == {0, 1, 2, 3}


def test_a_parameter_that_another_one_follows_acts_through_it() -> None:
    """b = 2 a: whoever reads b reads a; c[2] = 3 c[1]. Each element speaks for itself."""
    follows = [
        row(apply("Mul", const(2), parameter(0)), "p", 1),
        row(apply("Mul", const(3), parameter(2)), "p", 3),
    ]
    reads_b = [row(apply("Sub", parameter(1), variable(0)))]
    assert folded(initial=follows, algebraics=reads_b) == set()
    assert folded(algebraics=reads_b) == {0, 2, 3}


@pytest.mark.parametrize(
    ("conditions", "reads", "found"),
    [
        (("a",), (0, 1, 2, 3), set()), (("a",), (1, 2, 3), {0}), (("a", "b"), (0, 1, 2, 3), set()),
        (("a", "a"), (0, 1, 2, 3), {0}), (("b", "a", "b"), (0, 1, 2, 3), {1}),
        (("c",), (0, 1, 2, 3), set()), (("c",), (0, 1), {2, 3}), (("n",), (0, 1, 2, 3), set()),
    ],
)  # fmt: skip
def test_a_parameter_that_decides_in_a_when_clause_acts_where_its_program_has_it_once(
    conditions: tuple[str, ...], reads: tuple[int, ...], found: set[int]
) -> None:
    """The compiler has decided what its program does not read, and one of two that look alike.

    An equation beside it reads all of them: it is the clause that makes a parameter folded.
    """
    value = TIME
    for slot in reads:
        value = apply("Add", value, parameter(slot))
    every = apply("Add", apply("Add", parameter(0), parameter(1)), parameter(2))
    beside = row(apply("Add", apply("Add", every, parameter(3)), TIME))
    whens = [row(value, "p", 7)]
    assert folded(when("n", *conditions), whens=whens, algebraics=[beside]) == found


@pytest.mark.parametrize(
    ("reads", "found"), [((0, 1, 2, 3), set()), ((1, 2, 3), {0}), ((0, 2, 3), set())]
)
def test_a_parameter_that_decides_what_a_state_jumps_to_acts_where_its_program_has_it(
    reads: tuple[int, ...], found: set[int]
) -> None:
    """reinit(n, if a then ...): the same as of a discrete variable of a when-clause."""
    value = TIME
    for slot in reads:
        value = apply("Add", value, parameter(slot))
    every = apply("Add", apply("Add", parameter(0), parameter(1)), parameter(2))
    beside = row(apply("Add", apply("Add", every, parameter(3)), TIME))
    chain = when("n", "a")
    chain["state"] = chain.pop("target")
    assert folded(chain, reinits=[row(value, "p", 7)], algebraics=[beside]) == found


@pytest.mark.parametrize(("slot", "found"), [(8, set()), (9, set()), (7, {0}), (10, {0})])
def test_the_program_of_an_array_is_that_of_each_of_its_elements(
    slot: int, found: set[int]
) -> None:
    """m := if a then ...: the program of either element may read a; n and mm are other ones."""
    every = apply("Add", apply("Add", parameter(0), parameter(1)), parameter(2))
    beside = row(apply("Add", apply("Add", every, parameter(3)), TIME))
    whens = [row(READ if at == slot else TIME, "p", at) for at in (7, 8, 9, 10)]
    assert folded(when("m", "a"), whens=whens, algebraics=[beside]) == found
