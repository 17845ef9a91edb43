"""The section of sweeps: limits that a picture may show, captions, grids, and what has room.

Samples are made by hand: the section takes them as they are.
"""

import re
from dataclasses import replace
from typing import Any

import pytest
from tests.reports.swept import numbers

from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.sweeps.drawing import DOTS_MAX, Sample
from axisrig.reports.sweeps.section import (
    CELLS_MAX,
    PICTURES_MAX,
    Sweep,
    samples_of,
    sweeps_section,
    with_unit,
)
from axisrig.reports.sweeps.sensitivity import sensitivities, sensitivity_section

NO_RESULTS: Any = None
"""The section needs none where its sweeps are given."""
LIMIT = r'class="sw-limit" x1="([\d.]+)" y1="([\d.]+)" x2="([\d.]+)" y2="([\d.]+)"'
Limits = tuple[float | None, float | None]
THREE = ("plc:V.E.A", "plc:V.E.B", "plc:V.E.C")


def sample(
    at: str, value: float = 0.0, limits: Limits = (None, None), word: str = "pass"
) -> Sample:
    """at: the value of each input, in words."""
    return Sample(f"r{at}", tuple(at.split()), value, 0.0, limits, Verdict.of(word))


def sweep(*samples: Sample, case: str = "p-c", metric: str = "m", unit: str = "um",
          columns: tuple[str, ...] = ()) -> Sweep:  # fmt: skip
    columns = columns or THREE[: len(samples[0].at)]
    return Sweep(case, metric, unit, columns, samples)


def section(*found: Sweep) -> str:
    return sweeps_section(NO_RESULTS, found)


def captions(text: str) -> list[str]:
    return [
        re.sub("<[^>]*>", "", caption)
        for caption in re.findall(r"<figcaption>(.*?)</figcaption>", text)
    ]


def words_of_limits(text: str) -> list[str]:
    return re.findall(r'<text class="sw-word"[^>]*>([≥≤] [^<]*)<', text)


# Samples


@pytest.mark.parametrize(
    ("row", "expected"),
    [
        (CheckRow("m", value="1.5", unit="um", uncertainty="0.25", lower="-1", upper="2",
                  verdict="marginal"),
         ("m", "um", Sample("r", ("7",), 1.5, 0.25, (-1.0, 2.0), Verdict.MARGINAL))),
        (CheckRow("m", value="-2", uncertainty="inf", upper="0", verdict="fail"),
         ("m", "", Sample("r", ("7",), -2.0, 0.0, (None, 0.0), Verdict.FAIL))),
        (CheckRow("m", value="0", verdict="pass"),
         ("m", "", Sample("r", ("7",), 0.0, 0.0, (None, None), Verdict.PASS))),
        # What is no number, and the IDs of alarms, which are none
        (CheckRow("m", value="FREE"), None), (CheckRow("m"), None),
        (CheckRow("alarms", value="50059"), None),
        (CheckRow("alarms_max", value="3"),
         ("alarms_max", "", Sample("r", ("7",), 3.0, 0.0, (None, None), Verdict.PASS))),
    ],
)  # fmt: skip
def test_a_sample_is_a_check_that_is_a_number(row: CheckRow, expected: Any) -> None:
    """With its uncertainty, its limits and the verdict that counts."""
    run = StoredRun({"run": "r", "verdict": "error"}, [], None, None)
    checks = [CheckRow("first", value="9", unit="mm"), row]
    run.__dict__["checks"] = [replace(each, verdict=each.verdict or "pass") for each in checks]
    first, *found = samples_of(run, ("7",))
    assert first[:2] == ("first", "mm")
    assert found == ([] if expected is None else [expected])


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_bar_of_an_uncertainty_is_within_the_frame(side: float) -> None:
    """Of the lowest and of the highest value, however long it is."""
    runs = [Sample(f"r{n}", (str(n),), side * n, 8.0 if n == 2 else 0.0, (None, None), Verdict.PASS)
            for n in range(3)]  # fmt: skip
    text = section(sweep(*runs))
    ((x1, x2, one, other),) = numbers(
        r'class="sw-u" x1="([\d.]+)" x2="([\d.]+)" y1="([-\d.]+)" y2="([-\d.]+)"', text
    )
    ((left, top, width, height),) = numbers(
        r'class="ax-field" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"', text
    )
    assert x1 == x2
    assert left < x1 < left + width
    assert top < other < one < top + height


# Limits


@pytest.mark.parametrize(
    ("limits", "shown"),
    [
        (((-1.0, 1.0),) * 4, ["≥ -1", "≤ 1"]),
        (((-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0), (-1.0, 2.0)), ["≥ -1"]),
        (((-1.0, 1.0), (-2.0, 1.0), (-1.0, 1.0), (-1.0, 1.0)), ["≤ 1"]),
        (((-1.0, 1.0), (None, 1.0), (-1.0, 1.0), (-1.0, None)), []),
        (((None, 0.0),) * 4, ["≤ 0"]),
        (((0.0, None),) * 4, ["≥ 0"]),
        (((None, 1.0), (None, 2.0), (None, 3.0), (None, 4.0)), []),
        (((None, None),) * 4, []),
    ],
)
def test_of_several_inputs_a_picture_has_the_limits_that_hold_for_all_runs(
    limits: tuple[Limits, ...], shown: list[str]
) -> None:
    """Others go with inputs that the picture hides: a line would be wrong for some of its dots."""
    at = ("1 1 1", "2 1 2", "1 2 2", "2 2 1")
    found = sweep(*(sample(a, n, one) for n, (a, one) in enumerate(zip(at, limits, strict=True))))
    text = section(found)
    assert text.count("<svg") == 3
    assert words_of_limits(text) == shown * 3
    assert text.count('class="sw-limit"') == 3 * len(shown)


def test_limits_over_the_only_input_follow_it() -> None:
    text = section(sweep(*(sample(str(n), n, (-n, 2.0 * n)) for n in (1, 2, 3))))
    assert words_of_limits(text) == []
    lines = numbers(LIMIT, text)
    assert len(lines) == 4  # two sides, from one of three dots to the next
    assert [y1 > y2 for _, y1, _, y2 in lines] == [False, False, True, True]


# Captions


@pytest.mark.parametrize(
    ("columns", "unit", "expected"),
    [
        (("plc:V.E.A",), "um", ["p-c: m, um over plc:V.E.A"]),
        (("plc:V.E.A",), "", ["p-c: m over plc:V.E.A"]),
        (("plc:V.E.A", "plc:V.E.B"), "", ["p-c: m over plc:V.E.A and plc:V.E.B"]),
        (THREE, "um", ["p-c: m, um over plc:V.E.A", "over plc:V.E.B", "over plc:V.E.C"]),
        (("plant:probe.trigger_delay_us",), "um",
         ["p-c: m, um over plant:probe.trigger_delay_us in us"]),
    ],
)  # fmt: skip
def test_a_picture_says_what_it_is_and_over_what(
    columns: tuple[str, ...], unit: str, expected: list[str]
) -> None:
    """The further pictures of one metric name the input alone."""
    runs = [sample(" ".join([str(n)] * len(columns)), n) for n in (1, 2, 3)]
    text = section(sweep(*runs, unit=unit, columns=columns))
    assert captions(text) == expected
    assert text.count('<div class="sw-row">') == (len(columns) == 3)


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("plc:V.E.FEED", "plc:V.E.FEED"),
        ("plant:Z.v_max_mm_s", "plant:Z.v_max_mm_s in mm/s"),
        ("plant:Z.mass_kg", "plant:Z.mass_kg in kg"),
        ("set:Z.kenngr.measure.edge", "set:Z.kenngr.measure.edge"),
    ],
)
def test_an_input_has_the_unit_that_its_name_ends_with(column: str, words: str) -> None:
    assert with_unit(column) == words


@pytest.mark.parametrize("count", [DOTS_MAX, DOTS_MAX + 1])
def test_a_picture_with_some_of_its_runs_says_how_many(count: int) -> None:
    text = section(sweep(*(sample(str(n), n % 7) for n in range(count))))
    words = f", {DOTS_MAX} of {count} runs drawn" if count > DOTS_MAX else ""
    assert captions(text) == [f"p-c: m, um over plc:V.E.A{words}"]
    assert text.count('<g class="dot') == DOTS_MAX


# Grids


def test_a_grid_has_a_row_for_the_first_input_and_a_column_for_the_second() -> None:
    """In the order in which they ran; without a run the cell is empty, and so is an empty word."""
    cells = ((("2", "b"), 1.5, "pass"), (("1", ""), 2.25, "fail"),
             (("1", "b"), 123456.7, "marginal"), (("", "b"), -3.0, "error"))  # fmt: skip
    runs = [
        Sample(f"r{n}", at, value, 0.0, (None, None), Verdict.of(word))
        for n, (at, value, word) in enumerate(cells)
    ]
    text = section(sweep(*runs, columns=THREE[:2]))
    heads = re.findall(r'<th scope="(col|row)">([^<]*)</th>', text)
    assert heads == [("col", "b"), ("col", "empty"), ("row", "2"), ("row", "1"), ("row", "empty")]
    assert "plc:V.E.A down, plc:V.E.B across" in text
    rows = [
        [re.sub("<[^>]*>", "", cell) for cell in re.findall(r"<td[^>]*>(.*?)</td>", row)]
        for row in re.findall(r"<tr>(<th scope=\"row\".*?)</tr>", text)
    ]
    signs = [Verdict.of(word) for word in ("pass", "marginal", "fail", "error")]
    good, just, bad, error = (f"{sign.glyph}{sign.word} " for sign in signs)
    assert rows == [
        [f"{good}1.5", ""], [f"{just}1.2346e+05", f"{bad}2.25"], [f"{error}-3", ""],
    ]  # fmt: skip
    assert re.findall(r'href="#(r\d)"', text) == ["r0", "r2", "r1", "r3"]


def test_two_inputs_with_too_many_cells_are_two_pictures_with_common_limits() -> None:
    runs = [sample(f"{n % 2} {n}", n % 5, (None, 1.0 + n % 2)) for n in range(CELLS_MAX + 1)]
    text = section(sweep(*runs))
    assert (text.count("<svg"), text.count("<table")) == (2, 0)
    assert 'class="sw-limit"' not in text


# What has room


def of_case(number: int, count: int = 1, word: str = "pass") -> Sweep:
    """A sweep over `count` inputs."""
    columns = tuple(f"plc:V.E.N{n}" for n in range(count))
    runs = (Sample(f"r{n}", (str(n),) * count, float(n), 0.0, (None, None), Verdict.of(word))
            for n in range(3))  # fmt: skip
    return sweep(*runs, case=f"p-c{number:02}", columns=columns)


@pytest.mark.parametrize(
    ("counts", "drawn"),
    [
        ([12, 12, 12, 12], 4),  # 48 pictures
        ([12, 12, 12, 13], 3),
        ([12, 12, 12, 12, 1], 4),
        ([49], 1),  # the first one always
        ([49, 1], 1),
        ([2] * 13, 12),  # grids are a picture each
        ([1] * PICTURES_MAX, PICTURES_MAX),
        ([4] * 13, 12),
    ],
)
def test_a_page_has_48_pictures_of_12_metrics_at_most(counts: list[int], drawn: int) -> None:
    found = [of_case(n, count) for n, count in enumerate(counts)]
    text = section(*found)
    assert re.findall(r"<b>p-c(\d+)</b>", text) == [f"{n:02}" for n in range(drawn)]
    left = len(counts) - drawn
    words = re.findall(r'<p class="note">([^<]*)</p>', text)
    assert words == ([f"{left} more metrics over swept inputs are not drawn."] if left else [])


def test_metrics_are_drawn_from_the_worst_verdict_on() -> None:
    """Of the same verdict in the order of the results; the worst run of a sweep counts."""
    words = ("pass", "error", "marginal", "fail", "inconclusive", "fail", "aborted")
    found = [of_case(n, 1, word) for n, word in enumerate(words)]
    runs = (sample(str(n), n, word=word) for n, word in enumerate(("pass", "error", "pass")))
    mixed = sweep(*runs, case="p-c99")
    text = section(*found, mixed)
    assert re.findall(r"<b>p-c(\d+)</b>", text) == ["01", "99", "06", "03", "05", "04", "02", "00"]


def grid(number: int, word: str = "pass", metric: str = "m") -> Sweep:
    """m = A + 2 B over A and B of 0 and 1, with a fifth run that has this verdict."""
    at = ((0, 0), (0, 1), (1, 0), (1, 1))
    runs = [sample(f"{a} {b}", a + 2.0 * b) for a, b in at]
    return sweep(*runs, sample("1 1", 3.0, word=word), case=f"p-c{number:02}", metric=metric)


@pytest.mark.parametrize(
    ("words", "drawn"),
    [
        ({13: "fail"}, [13, *range(11)]),
        ({12: "inconclusive", 13: "error", 3: "marginal"},
         [13, 12, 3, 0, 1, 2, 4, 5, 6, 7, 8, 9]),
        ({}, [*range(12)]),
    ],
)  # fmt: skip
def test_pictures_of_sensitivity_are_those_of_the_worst_metrics(
    words: dict[int, str], drawn: list[int]
) -> None:
    """Of 14 metrics 12 are drawn; the tables have all of them in the order of the results."""
    text = sensitivity_section([grid(n, words.get(n, "pass")) for n in range(14)])
    shown = re.findall(r"<figcaption><b>p-c(\d+)</b>", text)
    assert shown == [f"{n:02}" for n in drawn]
    tables = re.findall(r"<caption><b>p-c(\d+)</b>", text)
    assert tables == [f"{n:02}" for n in range(14)]
    assert '<p class="note">2 more metrics are in the tables only.</p>' in text


def test_metrics_of_a_case_are_rows_of_one_table() -> None:
    """Each with what its own inputs explain; n is A + 2 B but for one run, which is 3 beside it."""
    plain = grid(1)
    odd = [*plain.samples[:-1], sample("1 1", 0.0)]
    text = sensitivity_section([plain, sweep(*odd, case="p-c01", metric="n"), grid(2)])
    assert re.findall(r"<caption><b>p-c(\d+)</b>", text) == ["01", "02"]
    first, second = re.findall(r"<tbody>(.*?)</tbody>", text)
    assert re.findall(r'<th scope="row">(\w+)</th>', first) == ["m", "n"]
    assert re.findall(r'<th scope="row">(\w+)</th>', second) == ["m"]
    fits = re.findall(r"<td>(\d+) %</td></tr>", first)
    assert fits[0] == "100"
    assert int(fits[1]) < 100


@pytest.mark.parametrize(
    ("texts", "ends"),
    [
        (("1", "3"), (1.0, 3.0)),
        (("POS", "NEG"), ("POS", "NEG")),
        (("1", "auto"), ("1", "auto")),  # one that is no number makes words of all
        (("auto", "1"), ("auto", "1")),
        (("1", ""), ("1", "")),
        (("", "3"), ("", "3")),
    ],
)
def test_an_input_is_one_of_words_as_soon_as_one_value_is_no_number(
    texts: tuple[str, str], ends: tuple[Any, Any]
) -> None:
    """m is 4 more with the second value; it does not depend on the other input."""
    runs = [Sample("r", (text, str(n)), 4.0 * (text == texts[1]), 0.0, (None, None), Verdict.PASS)
            for text in texts for n in range(3)]  # fmt: skip
    (found,), notes = sensitivities([sweep(*runs)])
    assert notes == []
    first, second = found.effects
    assert (first.low, first.high) == ends
    assert (first.change.value, second.change.value) == pytest.approx((4.0, 0.0))
    assert found.width == 4.0


def test_a_note_is_written_once_and_all_of_them_are() -> None:
    """Inputs that go together; of two cases, and of two metrics of the first."""

    def tied(case: str, metric: str) -> Sweep:
        return sweep(*(sample(f"{n} {n}", n) for n in range(4)), case=case, metric=metric)

    text = sensitivity_section([tied("p-a", "m"), tied("p-a", "m"), tied("p-b", "n")])
    notes = re.findall(r'<p class="note">(p-[^<]*)</p>', text)
    assert [note.partition(" has")[0] for note in notes] == ["p-a: m", "p-b: n"]
    assert "<svg" not in text
    assert "<table" not in text


@pytest.mark.parametrize(
    ("words", "shown"),
    [(("pass", "pass"), "r0"), (("pass", "fail"), "r1"), (("fail", "pass"), "r0"),
     (("fail", "fail"), "r0"), (("marginal", "inconclusive"), "r1")],
)  # fmt: skip
def test_a_cell_of_several_runs_shows_the_first_of_the_worst(
    words: tuple[str, str], shown: str
) -> None:
    runs = [
        Sample(f"r{n}", ("1", "a"), 1.0 + n, 0.0, (None, None), Verdict.of(word))
        for n, word in enumerate(words)
    ]
    other = Sample("r9", ("2", "b"), 5.0, 0.0, (None, None), Verdict.PASS)
    text = section(sweep(*runs, other, columns=THREE[:2]))
    assert re.findall(r'href="#(r\d)"', text) == [shown, "r9"]
