"""How long a function may be: the operations of one call, with everything that it calls."""

import pytest
from tests.fmus.test_function_operations import Made, P, domain, values

from axisrig.fmus.reading import functions
from axisrig.fmus.reading.expressions import Expr, UnsupportedError, apply, const

ONE_CALL = pytest.mark.parametrize(("most", "is_refused"), [(7, False), (6, True)])


def sum_of(made: Made, count: int) -> int:
    """The sum of so many numbers: 2 n - 1 operations."""
    found = made.real(1.0)
    for number in range(2, count + 1):
        found = made.binary("add", found, made.real(float(number)))
    return found


def called(made: Made, results: list[int], is_refused: bool) -> list[Expr]:
    if is_refused:
        with pytest.raises(UnsupportedError, match="a function of this length"):
            made.call(results, P)
        return []
    return made.call(results, P)


@ONE_CALL
def test_a_function_may_have_so_many_operations(
    most: int, is_refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(functions, "MAX_NODES", most)
    made = Made()
    found = called(made, [sum_of(made, 4)], is_refused)
    assert values(found) == ([] if is_refused else [10.0])


def test_calls_of_a_model_are_counted_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """However many there are: 7 operations in each, which are all that a call may have."""
    monkeypatch.setattr(functions, "MAX_NODES", 7)
    made = Made()
    known = made.functions([sum_of(made, 4)])
    for _ in range(5):
        assert values(known.call(0, {0: P}, [0])) == [10.0]


@ONE_CALL
def test_what_is_used_twice_counts_once(
    most: int, is_refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two results of the same sum of three: 5 operations and two products."""
    monkeypatch.setattr(functions, "MAX_NODES", most)
    made = Made()
    whole = sum_of(made, 3)
    results = [made.binary("multiply", whole, whole) for _ in range(2)]
    found = called(made, results, is_refused)
    assert values(found) == ([] if is_refused else [36.0, 36.0])


@pytest.mark.parametrize(("most", "is_refused"), [(12, False), (11, True)])
def test_each_pass_of_a_loop_counts(
    most: int, is_refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """{10*i for i in 1:n} of 5 passes: the array, one number, and two operations in each."""
    monkeypatch.setattr(functions, "MAX_NODES", most)
    made = Made()
    made.domains = [domain((1, 5, 1))]
    i = made.add("coordinate", 0, coordinate={"kind": "binder", "domain": 0, "ordinal": 0})
    body = made.binary("multiply", made.real(10.0), i, 0)
    found = called(made, [made.add("comprehension", domain=0, body=body)], is_refused)
    assert values(found) == ([] if is_refused else [10.0, 20.0, 30.0, 40.0, 50.0])


def test_an_argument_that_moves_stays_in_every_call(monkeypatch: pytest.MonkeyPatch) -> None:
    """What one call was given is not what the next one has."""
    monkeypatch.setattr(functions, "MAX_NODES", 3)
    made = Made()
    known = made.functions([made.binary("multiply", made.real(3.0), made.argument())])
    assert known.call(0, {0: P}, [0]) == [apply("Mul", const(3.0), P)]
    assert values(known.call(0, {0: const(2.0)}, [0])) == [6.0]
    assert values(known.call(0, {5: const(4.0)}, [5])) == [12.0]
