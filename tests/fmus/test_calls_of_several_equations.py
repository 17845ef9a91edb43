"""Which function a call means where equations, statements and sources share their calls."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_function_operations import pure_call

from axisrig.fmus.reading.calls import read_owners
from axisrig.fmus.reading.errors import BuildError


def named(start: int, end: int, function: int, source: int = 1, **more: Any) -> dict[str, Any]:
    """A call in the text."""
    span = {"source": source, "start": start, "end": end}
    return {"operation": {"kind": "call", "function": function}, "variability": "continuous",
            "provenance": {"span": span}, **more}  # fmt: skip


def program(span: tuple[int, int] | None, *numbers: int, source: int = 1) -> dict[str, Any]:
    made = None if span is None else {"source": source, "start": span[0], "end": span[1]}
    return {"span": made, "ops": [pure_call(number) for number in numbers]}


def owners(
    calls: Sequence[Mapping[str, Any]],
    programs: Sequence[Mapping[str, Any]],
    *texts: str,
    at_start: Sequence[Any] = (),
) -> dict[int, int]:
    """at_start: nodes of the residual of the start."""

    def error(span: Mapping[str, int] | None, message: str) -> BuildError:
        return BuildError("M.mo", None if span is None else span["start"], message)

    ir: Any = SimpleNamespace(
        dae={"expressions": list(calls)},
        solve={"continuous": {"deep": [list(programs)]},
               "initialization": {"residual": {"nodes": list(at_start)}}},
        files={number: (Path("M.mo"), text) for number, text in enumerate(texts, 1)},
        error=error,
    )  # fmt: skip
    return read_owners(ir)


def test_calls_that_only_the_start_has_are_known_too() -> None:
    site = {"PureCall": {"dst_start": 0, "site": {"owner": 7}, "input_starts": []}}
    content = {"programs": [[site]], "output_indices": [],
               "program_spans": [{"source": 1, "start": 30, "end": 40}]}  # fmt: skip
    calls = [named(5, 8, 3), named(31, 35, 4)]
    found = owners(calls, [program((0, 10), 1)], at_start=[{"ScalarPrograms": content}])
    assert found == {1: 3, 7: 4}


@pytest.mark.parametrize(
    ("span", "is_inside"),
    [((10, 15), True), ((9, 16), True), ((11, 15), False), ((10, 14), False), ((0, 12), False)],
)
def test_a_call_is_in_an_equation_with_both_of_its_ends(
    span: tuple[int, int], is_inside: bool
) -> None:
    if is_inside:
        assert owners([named(10, 15, 5)], [program(span, 0)]) == {0: 5}
        return
    with pytest.raises(BuildError, match="several functions"):
        owners([named(10, 15, 5)], [program(span, 0)])


def test_calls_that_the_compiler_has_done_do_not_count() -> None:
    calls = [named(10, 15, 5, variability="constant"), named(20, 25, 6)]
    assert owners(calls, [program((0, 30), 4)]) == {4: 6}
    other = named(10, 15, 5)
    other["operation"] = {"kind": "builtin", "function": 5}
    nowhere = named(10, 15, 5, provenance={})
    assert owners([other, nowhere, named(20, 25, 6)], [program((0, 30), 4)]) == {4: 6}


def test_of_a_loop_only_calls_that_no_equation_has_are_left_for_a_name() -> None:
    """The span of `v[i]` is a name; both other equations of the loop have spans of their own."""
    text = "for i in 1:2 loop v[i] = h(i); w = f(1); x = g(2); end for;"
    at = {name: text.index(f"{name}(") for name in "hfg"}
    calls = [named(start, start + 4, 5 + n) for n, start in enumerate(at.values())]
    whole = [program((text.index(f"{left} = "), at[name] + 4), number)
             for left, name, number in (("w", "f", 8), ("x", "g", 9))]  # fmt: skip
    name = program((text.index("v["), text.index("v[") + 1), 3)
    for programs in ([*whole, name], [name, *whole[::-1]]):
        assert owners(calls, programs, text) == {3: 5, 8: 6, 9: 7}


def test_calls_that_are_known_stay_what_they_are_beside_a_name() -> None:
    """Equations know calls 8 and 9, whose program the name has too; one more is left for it."""
    text = "when c then v = h(1) + f(2) + g(3); end when;"
    at = {name: text.index(f"{name}(") for name in "hfg"}
    calls = [named(start, start + 4, 5 + n) for n, start in enumerate(at.values())]
    place = text.index("v =")
    whole = [program((at[name], at[name] + 4), 8 + n) for n, name in enumerate("fg")]
    for programs in (
        [program((place, place + 1), 3, 8), *whole],
        [*whole, program((place, place + 1), 3)],
        [*whole[::-1], program((place, place + 1), 3, 8, 9)],
    ):
        assert owners(calls, programs, text) == {3: 5, 8: 6, 9: 7}


def test_calls_at_one_place_of_two_sources_are_two() -> None:
    """The first source knows its call; the second has only a name for one that begins there too."""
    first, second = "a = f(1);       ", "when c then b = g(2); end when;"
    start = second.index("g(")
    calls = [named(start, start + 4, 5), named(start, start + 4, 6, source=2)]
    place = second.index("b =")
    programs = [program((0, 20), 1), program((place, place + 1), 2, source=2)]
    assert owners(calls, programs, first, second) == {1: 5, 2: 6}


def test_the_place_of_calls_that_nobody_can_tell_apart_is_that_of_their_equation() -> None:
    calls = [named(10, 15, 5), named(20, 25, 6)]
    with pytest.raises(BuildError) as error:
        owners(calls, [program((7, 30), 1)])
    assert error.value.line == 7
    with pytest.raises(BuildError) as error:
        owners(calls, [program(None, 1)])
    assert error.value.line is None


def test_a_statement_goes_on_until_a_semicolon_after_its_span() -> None:
    """A span of two statements has the calls of both; the last one may end with the source."""
    text = "if a then b := f(1); c := f(2); end if; d := g(3)"
    start, end = text.index("b :="), text.index("c :=") + 1
    calls = [named(text.index(word), text.index(word) + 4, number)
             for word, number in (("f(1)", 5), ("f(2)", 5), ("g(3)", 6))]  # fmt: skip
    last = text.index("d :=")
    programs = [program((start, end), 1, 2), program((last, last + 1), 3)]
    names = [
        {**each, "span": {**each["span"], "end": each["span"]["start"] + 1}} for each in programs
    ]
    assert owners(calls, programs, text) == {1: 5, 2: 5, 3: 6}
    assert owners([calls[0], calls[2]], [names[0], names[1]], text) == {1: 5, 2: 5, 3: 6}
