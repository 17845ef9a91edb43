"""What the page prints of a run and its checks: values, notes, words to find it by, sentences."""

import pytest

from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.expectation import EXPECTED, NOT_MET
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError
from axisrig.reports.run import (
    _about,
    _check,
    _failed,
    _failures,
    _find_text,
    _is_unjudged,
    _plot_limits,
    _program_address,
    _sentence,
    _short,
    event_rows,
    probe_rows,
    readable,
)


def row(metric: str = "m", value: str = "1", verdict: str = "pass", **more: str) -> CheckRow:
    texts = {"asked": "<= 2", "unit": "um", "upper": "2", "uncertainty": "0", **more}
    return CheckRow(metric, value=value, verdict=verdict, **texts)


def run(verdict: str = "pass", *rows: CheckRow, **cells: str) -> StoredRun:
    case = {"plan": "p", "case": "c", "run": "p-c", "verdict": verdict, "alarms": "", **cells}
    return StoredRun(case, [each.cells for each in rows], None, None)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("12", "12"), ("-3.0", "-3"), ("1000000000.0", "1000000000"), ("0.5", "0.5"),
        ("1.23456789", "1.234568"), ("-0.123456789", "-0.1234568"), ("0.00012345678", "0.000123"),
        ("-0.00012345678", "-0.000123"), ("123456.789012", "123456.8"), ("1e15", "1e15"),
        ("1000000000000000.0", "1e+15"), ("FREE", "FREE"), ("a longer word", "a longer word"),
        ("nan", "nan"), ("inf", "inf"), ("", ""), ("0.001234567", "0.001234567"),
    ],
)  # fmt: skip
def test_a_value_has_the_digits_that_a_reader_compares(text: str, shown: str) -> None:
    """Seven of them, three below 0.001; what is short stays as it is written."""
    assert _short(text) == shown


def test_a_check_with_its_uncertainty_and_drawing() -> None:
    found = _check(row(value="1.5", uncertainty="0.123"))
    assert (found["value"], found["unit"], found["uncertainty"]) == ("1.5", "µm", "0.12")
    assert "bar-value v-pass" in found["bar"]
    assert "m is 1.5 µm, asked for &lt;= 2" in found["bar"]
    assert _check(row())["uncertainty"] == ""


@pytest.mark.parametrize(
    ("changes", "has_bar"),
    [
        ({}, True),
        ({"lower": "0"}, True),
        ({"lower": "2"}, False),  # equal limits
        ({"upper": ""}, False),
        ({"upper": "", "lower": "0"}, True),
        ({"value": ""}, False),
        ({"value": "inf"}, False),
        ({"value": "FREE"}, False),
        ({"uncertainty": "inf"}, False),
    ],
)
def test_what_has_no_number_or_limit_is_not_drawn(changes: dict[str, str], has_bar: bool) -> None:
    assert bool(_check(row(**changes))["bar"]) is has_bar


@pytest.mark.parametrize(
    ("value", "uncertainty", "note", "shown"),
    [
        ("1", "0.5", "a sample", "uncertainty: a sample"),
        ("1", "0", "a sample", "a sample"),
        ("", "0.5", "no edge", "no edge"),
        ("1", "0.5", "", ""),
        ("1", "0.5", f"{EXPECTED} as it did", f"{EXPECTED} as it did"),
    ],
)
def test_a_note_is_of_the_uncertainty_where_there_is_a_value(
    value: str, uncertainty: str, note: str, shown: str
) -> None:
    assert _check(row(value=value, uncertainty=uncertainty, note=note))["note"] == shown


# Sentences and failures


@pytest.mark.parametrize(
    ("verdict", "rows", "words"),
    [
        ("pass", [row()], "1 check passed"),
        ("pass", [row(), row("n")], "2 checks passed"),
        ("pass", [row(), row("n", "9", "fail", note=f"{EXPECTED} it did")],
         "1 check passed, 1 failed as expected"),
        ("pass", [], "0 checks passed"),
        ("pass", [row("search_good", "3", unit="um"), row("search_bad", "4", unit="um")],
         "holds at 3 µm, not at 4 µm"),
        ("pass", [row("search_good", "3")], "1 check passed"),
        ("marginal", [row(verdict="marginal")], None),
    ],
)  # fmt: skip
def test_a_run_in_a_sentence(verdict: str, rows: list[CheckRow], words: str | None) -> None:
    found = _sentence(run(verdict, *rows), None)
    assert found == words if words else "check passed" not in found and "m " in found


def test_an_error_is_the_sentence_of_a_run_that_was_not_judged() -> None:
    assert _sentence(run("error", row(value="", verdict="error")), "broken") == "no verdict: broken"
    info = RunFindings(error="broken")
    assert _is_unjudged(run("error", row(value="", verdict="error")), info)
    assert not _is_unjudged(run("error", row(value="1", verdict="error"), row(value="")), info)
    assert not _is_unjudged(run("fail", row(value="")), RunFindings())


def test_what_did_not_pass_is_shown_the_worst_first() -> None:
    """Marginal is good; a check that had to fail and did not is a failure though it passed."""
    missed = row("missed", note=f"{NOT_MET}, it passed")
    rows = [row("a"), row("b", verdict="marginal"), row("c", verdict="inconclusive"), missed,
            row("d", verdict="error"), row("e", verdict="fail"),
            row("f", verdict="fail")]  # fmt: skip
    assert [each.metric for each in _failed(run("error", *rows))] == ["d", "e", "f", "c", "missed"]
    found = _failures(run("error", *rows), {"e": "PICTURE"})  # type: ignore[dict-item]
    assert [each["picture"] for each in found] == ["", "PICTURE", "", "", ""]
    assert found[-1]["sentence"] == f"missed {NOT_MET}"
    assert [each["verdict"]["word"] for each in found] == [
        "error", "fail", "fail", "inconclusive", "pass",
    ]  # fmt: skip


def test_a_failure_without_a_value_has_its_note_in_its_sentence() -> None:
    (found,) = _failures(run("fail", row(value="", verdict="fail", note="no edge")), {})
    assert (found["note"], found["bar"]) == ("", "")
    assert "no edge" in found["sentence"]
    (found,) = _failures(run("fail", row(value="3", verdict="fail", note="far")), {})
    assert found["note"] == "far"
    assert found["bar"]


# Words


def test_a_run_is_found_by_all_that_names_it() -> None:
    made = run(
        "pass", row("latch_error_um:Z"), row("latch_error_um:Z"), title="A Title",
        tags="slow demo", requirement="R-7", program="programs/Probe.nc", rig="rigs/z.toml",
        drive_substituted="sercos",
    )  # fmt: skip
    words = _find_text(made, [{"id": "50059", "short": "No Signal"}], [("plc:V.E.FEED", "600")])
    assert words == (
        "p-c a title slow demo r-7 probe.nc z.toml plc:v.e.feed=600 latch_error_um:z"
        " 50059 no signal sercos"
    )
    assert _find_text(run(), [], []) == "p-c"


def test_what_a_run_is_about_leaves_out_what_is_empty() -> None:
    case = {"program": "a.nc", "rig": "z.toml", "requirement": "", "tags": "t", "title": "T"}
    assert _about(case) == [("program", "a.nc"), ("rig", "z.toml"), ("tags", "t")]
    assert _about({"drive_substituted": "sercos"}) == [("CiA 402 drive in place of", "sercos")]


@pytest.mark.parametrize(
    ("links", "path", "address"),
    [
        ([("program", "x", "../plans/a.nc")], "sub.nc", "../plans/sub.nc"),
        ([("rig", "x", "z.toml"), ("program", "x", "a.nc")], "L/sub 1.nc", "L/sub%201.nc"),
        ([("program", "x", "plans/a.nc")], "../b.nc", "b.nc"),
        ([("rig", "x", "z.toml")], "sub.nc", ""),
        ([("program", "x", "")], "sub.nc", ""),
    ],
)
def test_a_file_of_a_program_is_beside_it(
    links: list[tuple[str, str, str]], path: str, address: str
) -> None:
    assert _program_address(links, path) == address


def test_probes_are_in_the_order_of_what_they_try() -> None:
    search = run(**{"search:plc:V.E.A": "1 .. 9 to 1"})
    probes = [
        StoredRun(
            {**run().case, "run": name, "verdict": verdict, "plc:V.E.A": value}, [], None, None
        )
        for name, value, verdict in (("a", "10", "fail"), ("b", "9.5", "pass"), ("c", "", "pass"))
    ]
    found = probe_rows(search, probes)
    assert [(each["id"], each["value"]) for each in found] == [("c", ""), ("b", "9.5"), ("a", "10")]
    assert found[2]["verdict"] == {"word": "fail", "glyph": Verdict.FAIL.glyph}
    assert probe_rows(run(), probes) == []


def test_limits_of_known_metrics_are_drawn() -> None:
    """The lag on both sides; what another version checked is left out."""
    rows = [row("lag_mm_max:Z", asked="<= 0.5"), row("nothing_of_this_version:Z", asked="<= 1"),
            row("latch_error_um:Z", asked="<= 1")]  # fmt: skip
    found = _plot_limits(run("pass", *rows))
    assert [(each["label"], each["value"]) for each in found] == [
        ("lag_mm_max:Z", 0.5), ("lag_mm_max:Z", -0.5),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("error", "words"),
    [(KeyError("time_ns"), "KeyError('time_ns')"), (ValueError("first\nsecond"), "first"),
     (ZeroDivisionError("by 0"), "by 0"), (AttributeError("no x"), "no x")],
)  # fmt: skip
def test_a_part_that_cannot_be_read_is_named(error: Exception, words: str) -> None:
    with pytest.raises(UserError) as refused, readable(run(), "distance"):
        raise error
    message = str(refused.value)
    assert "`distance` of run p-c cannot be read" in message
    assert words in message
    assert "second" not in message
    with pytest.raises(OSError, match="disk"), readable(run(), "distance"):
        raise OSError("disk")


@pytest.mark.parametrize(
    ("events", "since"),
    [
        ("mark@1 contact@2 edge@3 latch@4", ["", "0", "1", "2"]),
        ("edge@2 latch@3 edge@5 alarm@6", ["0", "1", "3", "4"]),  # without a contact the first edge
        ("edge@1 contact@2 latch@4", ["0", "0", "2"]),
        ("contact@2 contact@5 edge@6", ["0", "0", "1"]),  # of each touch its own
        ("mark@1 latch@3 alarm@9", ["", "", ""]),
    ],
)
def test_events_count_from_the_contact_before_them(events: str, since: list[str]) -> None:
    """Else from the first edge; both times are in ms with nanoseconds."""
    pairs = [event.split("@") for event in events.split()]
    made = [Event(int(at) * 1_000_000, kind, f"{kind} here", "Z" if kind == "latch" else None)
            for kind, at in pairs]  # fmt: skip
    found = event_rows(made)
    assert [row["since"] for row in found] == [each and f"{each}.000000" for each in since]
    assert [row["time"] for row in found] == [f"{at}.000000" for _, at in pairs]
    assert [(row["kind"], row["label"], row["axis"]) for row in found] == [
        (kind, f"{kind} here", "Z" if kind == "latch" else "") for kind, _ in pairs
    ]
    (exact,) = event_rows([Event(1_234_567_891, "contact", "x")])
    assert exact["time"] == "1234.567891"
