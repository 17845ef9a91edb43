"""`-k EXPR`: Python's own boolean expressions are the reference."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from axisrig.bench.plan.case import Case
from axisrig.bench.plan.select import chosen, matches, only
from axisrig.kernel.errors import UserError


def _case(run: str = "latch-slow", tags: tuple[str, ...] = (), title: str = "") -> Case:
    return Case(
        plan="latch",
        case="slow",
        run=run,
        index=0,
        program=Path("p.nc"),
        rig=Path("r.toml"),
        inputs={},
        checks=(),
        title=title,
        tags=tags,
        requirement="",
        seed=0,
        repeat=0,
        file=Path("latch.csv"),
        line=2,
        places={},
    )


@pytest.mark.parametrize(
    "expression",
    [
        "aa",
        "not aa",
        "not not aa",
        "aa and bb",
        "aa or bb",
        "aa or bb and cc",
        "(aa or bb) and cc",
        "not aa and bb",
        "not (aa and bb)",
        "aa and not bb or not cc",
        "aa and (bb or not (cc and aa))",
        "((aa))",
        "not aa or bb and not (aa or cc)",
        "aa or bb or cc",
        "aa and bb and cc",
        "cc or aa and bb or not cc and bb",
        "not aa and not bb and not cc",
        "(aa or bb or cc) and (cc or bb or not aa)",
    ],
)
def test_expressions_mean_what_they_mean_in_python(expression: str) -> None:
    for values in product([False, True], repeat=3):
        present = dict(zip(("aa", "bb", "cc"), values, strict=True))
        case = _case(run="x", tags=tuple(word for word, there in present.items() if there))
        assert matches(expression, case) is eval(expression, {}, present)


@pytest.mark.parametrize(
    ("expression", "hit"),
    [
        ("latch-slow", True),
        ("slow", True),
        ("LATCH", True),
        ("nightly", True),
        ("ramp", True),
        ("Braking", True),
        ("fast", False),
        ("(slow)and(nightly)", True),
    ],
)
def test_a_word_is_looked_for_in_run_tags_and_title(expression: str, hit: bool) -> None:
    case = _case(tags=("nightly",), title="Edge inside the braking ramp")
    assert matches(expression, case) is hit


@pytest.mark.parametrize(
    ("expression", "at"),
    [
        ("", "the end"),
        ("not", "the end"),
        ("aa and", "the end"),
        ("(aa", "the end"),
        ("and aa", "and"),
        ("aa or or bb", "or"),
        ("aa)", ")"),
        ("()", ")"),
        ("aa bb", "bb"),
        ("(aa bb", "bb"),
        ("aa not bb", "not"),
    ],
)
def test_what_cannot_be_read_is_told_with_the_place(expression: str, at: str) -> None:
    with pytest.raises(UserError) as caught:
        matches(expression, _case())
    assert repr(expression) in caught.value.message
    assert caught.value.message.endswith(f"at {at!r}")


RUNS = (
    replace(_case("p-drill"), case="drill"),
    replace(_case("p-drill-2"), case="drill-2"),
    replace(_case("p-mill", title="a drill comes before"), case="mill"),
)


@pytest.mark.parametrize(
    ("expression", "runs"),
    [
        ("drill", ["p-drill"]),  # its name alone
        ("p-drill-2", ["p-drill-2"]),
        ("p-drill", ["p-drill"]),
        ("rill", ["p-drill", "p-drill-2", "p-mill"]),
        ("drill and not mill", ["p-drill", "p-drill-2"]),
        ("lathe", []),
    ],
)
def test_a_whole_name_chooses_its_case_alone(expression: str, runs: list[str]) -> None:
    assert [case.run for case in chosen(RUNS, expression)] == runs
    if len(runs) == 1:
        assert only(RUNS, expression).run == runs[0]
        return
    with pytest.raises(UserError, match=f"has to name one case, {len(runs)} fit") as caught:
        only(RUNS, expression)
    for case in RUNS:
        assert (case.run in str(caught.value)) is (not runs or case.run in runs)
