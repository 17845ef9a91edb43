"""Which runs fail in the same way, what their card says, and what it draws."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.failures.groups import FailureGroup, failure_groups
from axisrig.reports.failures.section import Cards

INPUTS = ("plc:V.E.A", "plc:V.E.B")


def check(value: str, verdict: str = "fail", metric: str = "m", **more: str) -> CheckRow:
    """By itself a length that may be 1 um at most."""
    cells = {"unit": "um", "upper": "1", "uncertainty": "0", "asked": "<= 1", **more}
    return CheckRow(metric, value=value, verdict=verdict, **cells)


def text(value: str, verdict: str = "fail", note: str = "") -> CheckRow:
    return CheckRow("state", "== ON", value, verdict=verdict, note=note, uncertainty="0")


def run(name: str, *checks: CheckRow, at: tuple[str, ...] = (), case: str = "c",
        verdict: str = "", **cells: str) -> StoredRun:  # fmt: skip
    """at: its inputs. verdict: by default the worst of its checks."""
    word = verdict or max((row.outcome for row in checks), default=Verdict.PASS).word
    row = {"run": name, "plan": "p", "case": case, "verdict": word, **cells}
    made = StoredRun(row | dict(zip(INPUTS, at, strict=False)), [], None, None)
    made.__dict__["checks"] = list(checks)
    return made


def groups(*runs: StoredRun) -> list[FailureGroup]:
    return failure_groups(StoredResults(Path(), runs, {}))


def names(found: Sequence[FailureGroup]) -> list[str]:
    return ["".join(each.run for each in group.runs) for group in found]


def test_the_worst_verdict_comes_first() -> None:
    """Cases of one verdict stay in the order in which they ran; what passed only just is none."""
    words = {"a": "inconclusive", "b": "fail", "c": "error", "d": "marginal", "e": "aborted",
             "f": "fail", "g": "pass"}  # fmt: skip
    found = groups(*(run(name, check("2", word), case=name) for name, word in words.items()))
    assert names(found) == ["c", "e", "b", "f", "a"]
    assert [group.verdict.word for group in found] == [
        "error", "aborted", "fail", "fail", "inconclusive",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("one", "other", "is_alike"),
    [
        (text("OFF"), text("OFF"), True),
        (text("OFF"), text("FREEZE"), False),  # another value is another failure
        (text("OFF", note="at 3 ms"), text("OFF", note="at the end"), True),
        (text("", note="no run in block 30"), text("", note="no run in block 40"), True),
        (text("", note="no run"), text("", note="no signal"), False),
        (text("OFF"), text("", note="OFF"), True),
        (check("2"), check("3"), True),
        (check("2"), check("-2", lower="-1", upper="1"), False),
        (check("2"), check("2", metric="n"), False),
    ],
)
def test_runs_fail_alike_where_value_side_or_reason_are_the_same(
    one: CheckRow, other: CheckRow, is_alike: bool
) -> None:
    """Of a number the side of its limits, of a text its value, of none the note but for numbers.

    Both runs have another check with a value: they were judged.
    """
    good = check("0", "pass", "k")
    found = groups(run("a", good, one), run("b", good, other))
    assert names(found) == (["ab"] if is_alike else ["a", "b"])


@pytest.mark.parametrize(
    ("bad", "every", "leading"),
    [
        (["3"], ["1", "2", "3"], "plc:V.E.A"),
        (["2"], ["1", "2"], ""),  # two values are no course
        (["x"], ["1", "2", "x"], ""),
        (["3"], ["1", "", "3"], ""),
        (["3"], ["-1.5", "2e1", "3"], "plc:V.E.A"),
    ],
)
def test_a_card_is_drawn_over_an_input_of_three_numbers_at_least(
    bad: list[str], every: list[str], leading: str
) -> None:
    runs = (run(f"r{n}", check("2" if at in bad else "0.5", "fail" if at in bad else "pass"),
                at=(at, "1")) for n, at in enumerate(every))  # fmt: skip
    (group,) = groups(*runs)
    assert group.leading == leading


@pytest.mark.parametrize(
    ("bad", "every", "where"),
    [
        ("1 2 3 4", "1 2 3 4 5 6", "V.E.A up to 4"),
        ("1 2 3 4", "1 2 3 4 5 x", "4 of 6 values of V.E.A"),  # a word has no place among numbers
        ("1 2 3 x", "1 2 3 4 5 x", "4 of 6 values of V.E.A"),
        ("1 2 x", "1 2 3 x", "V.E.A 1, 2, x"),
        ("3 4 5 6", "1 2 3 4 5 6", "V.E.A from 3"),
        ("2 3 4 5", "1 2 3 4 5 6", "V.E.A 2 to 5"),
        ("2 3 5 6", "1 2 3 4 5 6 7", "V.E.A 2 to 6 (4 of 5 values)"),
        ("1 2 4 5", "1 2 3 4 5 6", "V.E.A up to 5 (4 of 5 values)"),
        ("2 3 5 6", "1 2 3 4 5 6", "V.E.A from 2 (4 of 5 values)"),
        ("1 2 5 6", "1 2 3 4 5 6", "4 of 6 values of V.E.A"),
        ("-4 -3 -2 -1", "-5 -4 -3 -2 -1", "V.E.A from -4"),
        ("9 10 11 12", "8 9 10 11 12 13", "V.E.A 9 to 12"),  # as numbers, not as texts
    ],
)
def test_where_runs_fail_among_the_values_of_an_input(bad: str, every: str, where: str) -> None:
    failed = bad.split()
    runs = (run(f"r{n}", check("2" if at in failed else "0.5", "fail" if at in failed else "pass"),
                at=(at, "1")) for n, at in enumerate(every.split()))  # fmt: skip
    (group,) = groups(*runs)
    assert group.where == (where,)


# What a card says


def cards(*runs: StoredRun, **views: Any) -> list[Mapping[str, Any]]:
    """The cards; views: what differs from the view of a run, by its name."""
    made: list[Mapping[str, Any]] = []

    def render(card: Mapping[str, Any]) -> str:
        made.append(card)
        return str(card["id"])

    found = Cards(StoredResults(Path(), runs, {}), render)
    for each in runs:
        view = {
            "id": each.run,
            "verdict": {"word": each.verdict.word},
            "case": f"c-{each.run}",
            "title": f"title of {each.run}",
            "sentence": f"sentence of {each.run}",
            "unjudged": False,
            "failures": [{"bar": "<bar>", "picture": "<picture>"}],
        }
        found.add(view | views.get(each.run, {}))
    assert [str(one) for one in found.made] == [group.worst.run for group in groups(*runs)]
    return made


def test_a_card_of_one_run_has_its_name_and_its_sentence() -> None:
    """That of several has the name of their case, and what they have in common."""
    good = run("g", check("0.5", "pass"))
    (lone,) = cards(run("a", check("2")), good)
    assert (lone["name"], lone["case"], lone["title"]) == ("card-1", "c-a", "title of a")
    assert (lone["sentence"], lone["count"], lone["worst"], lone["besides"]) == (
        "sentence of a", "", "", "",
    )  # fmt: skip
    (both,) = cards(run("a", check("2")), run("b", check("2.5")), good)
    assert (both["id"], both["case"], both["title"]) == ("b", "c", "title of b")
    assert both["sentence"] == "m is above its upper limit 1 µm"
    assert both["count"]
    assert both["worst"] == "2.5 µm"


def test_the_sentence_is_of_the_checks_that_failed() -> None:
    """A metric may be checked twice: 2 um is within 9 um and beyond 1 um."""
    runs = [run(name, check("2", "pass", lower="0", upper="9"), check("2"),
                check("2", "inconclusive", upper="2.1")) for name in "ab"]  # fmt: skip
    (card,) = cards(*runs)
    assert card["sentence"] == "m is above its upper limit 1 µm"


def test_what_else_did_not_pass_is_named_with_its_runs() -> None:
    """The most frequent first; what passed only just did pass."""

    def others(*words: str) -> list[CheckRow]:
        return [check("0", word, metric) for metric, word in zip("klno", words, strict=True)]

    runs = [run("a", check("3"), *others("pass", "fail", "inconclusive", "marginal")),
            run("b", check("2"), *others("pass", "pass", "fail", "marginal")),
            run("c", check("2"), *others("inconclusive", "fail", "fail", "pass"))]  # fmt: skip
    (card,) = cards(*runs)
    assert card["besides"] == "n in 3, l in 2, k in 1"


@pytest.mark.parametrize(
    ("view", "drawn"),
    [
        ({}, ["<bar>", "<picture>"]),
        ({"unjudged": True}, []),
        ({"failures": []}, []),
        ({"failures": [{"bar": "", "picture": "<p>"}]}, ["<p>"]),
        ({"failures": [{"bar": "<b>", "picture": ""}, {"bar": "<c>", "picture": "<d>"}]}, ["<b>"]),
    ],
)
def test_a_card_draws_the_first_check_that_failed(view: dict[str, Any], drawn: list[str]) -> None:
    """Where it is not drawn over an input. A run that was not judged has no value to draw."""
    (card,) = cards(run("a", check("2")), a=view)
    assert card["drawings"] == drawn


def test_over_an_input_the_limit_is_drawn_that_was_broken() -> None:
    runs = [run(f"r{n}", check(str(n), "fail" if n > 1 else "pass", lower="-5"), at=(str(n), "1"))
            for n in range(4)]  # fmt: skip
    (card,) = cards(*runs)
    (drawn,) = card["drawings"]
    assert "≤ 1" in drawn
    assert "≥" not in drawn
    assert drawn.count('<g class="dot') == 4
    same = [run(f"r{n}", check("2"), at=(str(n), "1")) for n in range(4)]
    (card,) = cards(*same)  # a value that never changes has no course
    assert card["drawings"] == ["<bar>", "<picture>"]
    two = [run(f"r{n}", check(value), at=(str(n), "1")) for n, value in enumerate("2223")]
    (card,) = cards(*two)
    (drawn,) = card["drawings"]
    assert drawn.count('<g class="dot') == 4


def test_a_row_about_several_runs_is_a_card_of_its_own() -> None:
    """Its case has the inputs of its runs, which are none of its own."""
    runs = [run(f"r{n}", check("0.5", "pass"), at=(str(n), "1")) for n in range(3)]
    about = run("all", check("2", metric="mean(m)"), runs="3")
    (card,) = cards(*runs, about)
    assert (card["id"], card["where"], card["count"]) == ("all", "", "")
    assert card["drawings"] == ["<bar>", "<picture>"]
