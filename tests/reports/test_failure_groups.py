"""Equal failures are one card: how many, where, and which is the worst."""

import re
from html import unescape
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.reports.swept import folder

from axisrig.bench.campaign.results.stored import read_results
from axisrig.reports.build import build_report
from axisrig.reports.failures import section
from axisrig.reports.failures.groups import failure_groups
from axisrig.reports.failures.legend import legend
from axisrig.reports.parts.bar import bar

CASES = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,plc:V.E.A,plc:V.E.B"
CHECKS = "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference,note"


def written(place: Path, rows: list[tuple[str, str, str, float]], more: str = "") -> Path:
    """rows: case, V.E.A, V.E.B, value of m, whose limits are -1 .. 1; what is beyond fails."""
    cases, checks = [CASES], [CHECKS]
    for number, (case, a, b, value) in enumerate(rows):
        verdict = "fail" if abs(value) > 1 else "pass"
        cases.append(f"p,{case},r{number},{verdict},1,1,1,,,{a},{b}")
        checks.append(f"p,{case},r{number},-1 .. 1,m,{value},um,-1,1,0,{verdict},p.csv:2,")
        checks.append(f"p,{case},r{number},<= 9,n,{value},mm,,9,0,{more or 'pass'},p.csv:2,")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    return place


def cards(place: Path) -> list[str]:
    """The text of each card, without signs."""
    page = build_report(place).read_text(encoding="utf-8")
    found = re.findall(r'<article class="card.*?</article>', page, re.DOTALL)
    return [unescape(" ".join(re.sub(r"<[^>]*>", " ", card).split())) for card in found]


@pytest.mark.interpreted
def test_runs_without_a_card_are_counted_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Groups of 3, 2, 4 and 5 runs on a page of two cards: 9 of 14 runs have none."""
    names = iter("abcdefghijklmn")
    runs = [[SimpleNamespace(run=next(names)) for _ in range(many)] for many in (3, 2, 4, 5)]
    groups = [SimpleNamespace(runs=each, worst=each[0]) for each in runs]
    monkeypatch.setattr(section, "failure_groups", lambda _results: groups)
    monkeypatch.setattr(section, "CARDS", 2)
    results: Any = None
    made = section.Cards(results, lambda _card: "")
    assert (made.failed, made.left_out) == (14, 9)
    assert [made.name_of(run) for run in "acdef"] == ["card-1", "card-1", "card-2", "card-2", ""]
    assert [run for run in "abcdefghijklmn" if made.is_example(run)] == ["a", "d"]


@pytest.mark.long
def test_failures_of_a_sweep_are_one_card_that_says_where(tmp_path: Path) -> None:
    """Eleven values of A with two of B: with the second one m is -A / 50, below -1 from 60 on."""
    rows = [
        ("c", str(a), b, -a / 100 * (b == "1.9")) for a in range(10, 111, 10) for b in ("0", "1.9")
    ]
    rows[-1] = ("c", "110", "1.9", -2.5)
    (group,) = failure_groups(read_results(written(tmp_path, rows)))
    assert (len(group.runs), len(group.members)) == (1, 22)
    rows = [(case, a, b, value * 2 if value > -2 else value) for case, a, b, value in rows]
    (group,) = failure_groups(read_results(written(tmp_path, rows)))
    assert len(group.runs) == 6  # 60 to 110
    assert group.held == {"plc:V.E.B": "1.9"}
    assert group.where == ("V.E.B 1.9", "V.E.A from 60")
    assert (group.worst.run, group.at) == ("r21", ("V.E.A 110",))
    assert group.leading == "plc:V.E.A"
    (card,) = cards(tmp_path)
    assert "m is below its lower limit -1 µm in 6 of 22 runs" in card
    assert "where: V.E.B 1.9; V.E.A from 60" in card
    assert "worst: -2.5 µm at V.E.A 110" in card
    assert "passed" in card
    assert "failed" in card


@pytest.mark.parametrize(
    ("bad", "where"),
    [
        ({10, 20, 30, 40}, "V.E.A up to 40"),
        ({40, 50, 60, 70}, "V.E.A 40 to 70"),
        ({20, 40}, "V.E.A 20, 40"),
        ({40, 50, 70, 80}, "V.E.A 40 to 80 (4 of 5 values)"),
        ({10, 30, 50, 90}, "4 of 9 values of V.E.A"),
    ],
)
def test_where_is_said_as_a_reader_would(tmp_path: Path, bad: set[int], where: str) -> None:
    rows = [("c", str(a), "1", 2.0 if a in bad else 0.5) for a in range(10, 100, 10)]
    (group,) = failure_groups(read_results(written(tmp_path, rows)))
    assert group.where == (where,)


def test_one_failure_has_no_value_that_it_shares(tmp_path: Path) -> None:
    """Its own values are where it is, and A, which has more than two, is what to draw over."""
    rows = [
        ("c", str(a), b, 2.0 if (a, b) == (30, "1.9") else 0.5)
        for a in range(10, 60, 10)
        for b in ("0", "1.9")
    ]
    (group,) = failure_groups(read_results(written(tmp_path, rows)))
    assert ([run.run for run in group.runs], len(group.members)) == (["r5"], 10)
    assert (group.held, group.where) == ({}, ())
    assert group.at == ("V.E.A 30", "V.E.B 1.9")
    assert (group.leading, len(group.alike)) == ("plc:V.E.A", 10)


def test_a_failure_at_every_value_of_one_input_is_drawn_over_it(tmp_path: Path) -> None:
    """B is the same in all failures: A is drawn, of the runs with that B alone."""
    rows = [
        ("c", str(a), b, 2.0 if b == "1.9" else 0.5)
        for a in range(10, 60, 10)
        for b in ("0", "1", "1.9")
    ]
    (group,) = failure_groups(read_results(written(tmp_path, rows)))
    assert (len(group.runs), len(group.alike), len(group.members)) == (5, 5, 15)
    assert (group.held, group.leading) == ({"plc:V.E.B": "1.9"}, "plc:V.E.A")
    assert group.where == ("V.E.B 1.9",)


def test_an_input_that_all_failures_share_is_drawn_where_nothing_else_differs(
    tmp_path: Path,
) -> None:
    """Two failures at one A of five; B has two values, too few to draw over."""
    rows = [
        ("c", str(a), b, 2.0 if a == 30 else 0.5) for a in range(10, 60, 10) for b in ("0", "1.9")
    ]
    (group,) = failure_groups(read_results(written(tmp_path, rows)))
    assert group.held == {"plc:V.E.A": "30"}
    assert (group.leading, group.at) == ("plc:V.E.A", ("V.E.B 0",))


def test_both_sides_other_metrics_and_other_cases_are_cards_of_their_own(tmp_path: Path) -> None:
    rows = [("c", str(a), "1", value) for a, value in enumerate((-2.0, -3.0, 0.0, 2.0, 3.0, 4.0))]
    rows += [("d", "1", "1", 2.0)]
    groups = failure_groups(read_results(written(tmp_path, rows)))
    assert [[run.run for run in group.runs] for group in groups] == [
        ["r0", "r1"],
        ["r3", "r4", "r5"],
        ["r6"],
    ]
    assert [group.worst.run for group in groups] == ["r1", "r5", "r6"]


@pytest.mark.long
def test_a_card_draws_the_limit_that_was_broken_and_not_the_other_one(tmp_path: Path) -> None:
    """Below -1 at A = 0 and 1, above 1 from 3 on: each card has the limit of its own side."""
    rows = [("c", str(a), "1", value) for a, value in enumerate((-2.0, -3.0, 0.0, 2.0, 3.0, 4.0))]
    below, above = cards(written(tmp_path, rows))
    assert ("\u2265 -1" in below, "\u2264 1" in below) == (True, False)
    assert ("\u2265 -1" in above, "\u2264 1" in above) == (False, True)


def test_a_card_draws_the_runs_that_an_input_leads_through(tmp_path: Path) -> None:
    """Over A, which goes on while B is held: those with this B. Over B itself: all of the case."""
    free = [("c", str(a), b, 3.0 if b == "1" and a > 2 else 0.5) for a in range(5) for b in "01"]
    held = [("c", "xyz"[n % 3], str(n // 3), 3.0 if n > 8 else 0.5) for n in range(12)]
    for rows, leading, drawn in ((free, "plc:V.E.A", 5), (held, "plc:V.E.B", 12)):
        (group,) = failure_groups(read_results(written(tmp_path, rows)))
        assert (group.leading, [*group.held]) == (leading, ["plc:V.E.B"])
        picture = section._swept(group)
        assert picture.count('<g class="dot') == drawn
        assert f"m, µm over {leading.removeprefix('plc:')}" in picture


TABLE = "plan,case,run,verdict,runs"
ROWS = "plan,case,run,metric,value,lower,upper,verdict,note"


@pytest.mark.parametrize(
    ("other", "groups"),
    [
        ("p,c,b,fail,|-3,fail", [["a", "b"]]),
        ("q,c,b,fail,|-3,fail", [["a"], ["b"]]),  # a case of another plan
        ("p,d,b,fail,|-3,fail", [["a"], ["b"]]),
        ("p,c,b,fail,4|-3,fail", [["a"], ["b"]]),  # a row about several runs is none of them
        ("p,c,b,inconclusive,|-3,inconclusive", [["a"], ["b"]]),
        ("p,c,b,fail,|3,fail", [["a"], ["b"]]),  # above its upper limit
    ],
)
def test_runs_are_one_card_if_case_kind_verdict_and_side_are_the_same(
    tmp_path: Path, other: str, groups: list[list[str]]
) -> None:
    of_case, _, of_check = other.partition("|")
    value, _, verdict = of_check.partition(",")
    plan, case, *_ = of_case.split(",")
    cases = [TABLE, "p,c,a,fail,", of_case, "p,c,good,pass,", ""]
    checks = [ROWS, "p,c,a,m,-2,-1,1,fail,", f"{plan},{case},b,m,{value},-1,1,{verdict},", ""]
    (tmp_path / "cases.csv").write_text("\n".join(cases), encoding="utf-8")
    (tmp_path / "results.csv").write_text("\n".join(checks), encoding="utf-8")
    found = failure_groups(read_results(tmp_path))
    assert sorted([run.run for run in group.runs] for group in found) == groups


@pytest.mark.long
def test_what_else_failed_is_counted(tmp_path: Path) -> None:
    rows = [("c", str(a), "1", 2.0 + a) for a in range(3)]
    (card,) = cards(written(tmp_path, rows, more="inconclusive"))
    assert "in all 3 runs" in card
    assert "besides: n in 3" in card
    assert "where" not in card
    (card,) = cards(written(tmp_path, rows, more="marginal"))  # it passed, near its limit
    assert "besides" not in card


def test_errors_that_differ_in_numbers_alone_are_equal(tmp_path: Path) -> None:
    cases = ["run,verdict", *(f"a{n},error" for n in range(3)), "b,error"]
    checks = ["run,metric,verdict,note"]
    checks += [f"a{n},m,error,step {n}0{n} failed" for n in range(3)] + ["b,m,error,no file"]
    (tmp_path / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (tmp_path / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    groups = failure_groups(read_results(tmp_path))
    # Without a case each run is one of its own; equal ones of a case are together
    assert len(groups) == 4
    cases = ["case,run,verdict", *(f"c,a{n},error" for n in range(3)), "c,b,error"]
    (tmp_path / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    groups = failure_groups(read_results(tmp_path))
    assert sorted(len(group.runs) for group in groups) == [4]


@pytest.mark.long
def test_many_cards_are_folded_and_the_runs_are_near(tmp_path: Path) -> None:
    rows = [(f"c{n}", "1", "1", 2.0) for n in range(30)]
    page = build_report(folder_of(tmp_path, rows)).read_text(encoding="utf-8")
    shown, folded = page.split('<details class="folded">')
    assert shown.count('<article class="card') == 9
    assert folded.count('<article class="card') == 21
    assert "<summary>21 more</summary>" in folded


def folder_of(place: Path, rows: list[tuple[str, str, str, float]]) -> Path:
    return folder(place, [(case, a, b, value, "fail") for case, a, b, value in rows])


def test_a_legend_names_what_is_drawn_and_no_more() -> None:
    words = re.sub(r"<[^>]*>", " ", legend('<g class="dot sw-fail"><line class="sw-limit" x1="1"'))
    assert words.split() == ["failed", "limit"]
    assert legend("<svg></svg>") == ""


BANDS = bar(0.5, 0.1, 0.0, 1.0, "fail", "x")


@pytest.mark.parametrize(
    ("drawn", "words"),
    [
        (BANDS, ["allowed", "marginal", "inconclusive", "value"]),
        (bar(0.5, 0.0, 0.0, 1.0, "fail", "x"), ["allowed", "value"]),
        (f'<g class="dot sw-marginal">{BANDS}', ["marginal", "allowed", "inconclusive", "value"]),
        ('<line class="pic-limit"/>', ["limit"]),
        ('<rect class="sw-unsure"/><rect class="bar-inconclusive"/>', ["inconclusive"]),
        ('<line class="sw-u wide"/><rect class="bar-in"/>', ["uncertainty", "allowed"]),
        ('<line class="sw-limit"/><line class="pic-limit"/>', ["limit"]),
    ],
    ids=[
        "bands",
        "no bands",
        "dot and bands",
        "one limit",
        "names that begin alike",
        "a further class",
        "two limits",
    ],
)
def test_a_word_has_a_key_once_whichever_sign_of_it_is_drawn(drawn: str, words: list[str]) -> None:
    assert re.sub(r"<[^>]*>", " ", legend(drawn)).split() == words
