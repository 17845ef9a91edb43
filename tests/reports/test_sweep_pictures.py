"""What a picture of a sweep shows of a sample: signs, bars, limits, words; and what is swept."""

import re
from pathlib import Path

import pytest
from tests.reports.swept import CASES, CHECKS, folder, numbers

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.sweeps.drawing import DOTS_MAX, WIDTH, Mark, Sample, drawing, shown
from axisrig.reports.sweeps.section import CELLS_MAX, Sweep, sweeps, sweeps_section
from axisrig.reports.sweeps.sensitivity import sensitivities, sensitivity_section

Limits = tuple[float | None, float | None]


def sample(
    at: str, value: float, u: float = 0.0, limits: Limits = (None, None), word: str = "pass"
) -> Sample:
    return Sample(f"r{at}", (at,), value, u, limits, Verdict.of(word))


CIRCLE = r'<circle cx="([\d.]+)" cy="([\d.]+)"'
LIMIT = r'class="sw-limit" x1="([\d.]+)" y1="([\d.]+)" x2="([\d.]+)" y2="([\d.]+)"'
WORD = r'<text class="sw-word" x="[\d.]+" text-anchor="end" y="([\d.]+)">([^<]+)<'
BAR = r'class="sw-u" x1="([\d.]+)" x2="([\d.]+)" y1="([\d.]+)" y2="([\d.]+)"'


@pytest.mark.parametrize("verdict", Verdict)
def test_what_did_not_pass_has_another_sign(verdict: Verdict) -> None:
    """A circle where it passed, if only just; a cross for each worse verdict."""
    text = drawing([sample("1", 1.0), sample("2", 2.0, word=verdict.word)], "t", "")
    is_good = verdict in (Verdict.PASS, Verdict.MARGINAL)
    assert text.count("<circle") == 1 + is_good
    assert text.count("<path d=") == (not is_good)
    assert f'class="dot sw-{verdict.word}"' in text


def test_a_value_has_a_bar_of_its_uncertainty() -> None:
    """1 and 3 stand for two units up; the bar of 3 goes from 2.5 to 3.5."""
    text = drawing([sample("1", 1.0), sample("2", 3.0, u=0.5)], "t", "um")
    (_, low), (x, high) = numbers(CIRCLE, text)
    per_unit = (low - high) / 2
    ((x1, x2, begin, end),) = numbers(BAR, text)
    assert (x1, x2) == (x, x)
    assert sorted((begin, end)) == pytest.approx(
        [high - per_unit / 2, high + per_unit / 2], abs=0.11
    )
    assert ">µm</text>" in text


@pytest.mark.parametrize("lower", [0.0, -2.0])
def test_limits_that_are_the_same_go_across_and_say_their_value(lower: float) -> None:
    """A limit of 0 is one; the word of the lower one is above its line, of the upper one below."""
    text = drawing([sample(a, v, 0, (lower, 5.0)) for a, v in (("1", 1.0), ("2", 3.0))], "t", "")
    (_, low), (_, high) = numbers(CIRCLE, text)
    per_unit = (low - high) / 2
    lines = numbers(LIMIT, text)
    heights = [line[1] for line in lines]
    assert all(line[1] == line[3] and line[0] < line[2] for line in lines)
    expected = [low + (1.0 - lower) * per_unit, low - 4.0 * per_unit]
    assert heights == pytest.approx(expected, abs=0.2)
    words = re.findall(WORD, text)
    assert [word for _, word in words] == [f"≥ {lower:g}", "≤ 5"]
    assert float(words[0][0]) < heights[0]
    assert float(words[1][0]) > heights[1]


def test_limits_that_go_with_the_input_connect_their_samples() -> None:
    """Upper limits 2, 4 and none at 1, 2 and 3; a lower one of the first alone is no line."""
    text = drawing(
        [
            sample("1", 1.0, 0, (0.5, 2.0)),
            sample("2", 3.0, 0, (None, 4.0)),
            sample("3", 3.0, 0, (None, None)),
        ],
        "t",
        "",
    )
    circles = numbers(CIRCLE, text)
    per_unit = (circles[0][1] - circles[1][1]) / 2
    ((x1, y1, x2, y2),) = numbers(LIMIT, text)
    assert (x1, x2) == (circles[0][0], circles[1][0])
    expected = (circles[0][1] - per_unit, circles[1][1] - per_unit)
    assert (y1, y2) == pytest.approx(expected, abs=0.2)
    assert "sw-word" not in text


def test_a_limit_of_0_that_goes_with_the_input_connects_its_samples_too() -> None:
    """The upper limits go from -1 by 0 to 1, the lower ones from 0 to -2."""
    rows = [sample("1", -2.0, 0, (0.0, -1.0)), sample("2", 0.0, 0, (-1.0, 0.0)),
            sample("3", 2.0, 0, (-2.0, 1.0))]  # fmt: skip
    text = drawing(rows, "t", "")
    circles = numbers(CIRCLE, text)
    per_unit = (circles[0][1] - circles[2][1]) / 4
    zero = circles[1][1]
    lines = [(y1, y2) for _, y1, _, y2 in numbers(LIMIT, text)]
    values = [(0, -1), (-1, -2), (-1, 0), (0, 1)]
    wanted = [zero - value * per_unit for pair in values for value in pair]
    assert [each for pair in lines for each in pair] == pytest.approx(wanted, abs=0.2)


def test_samples_are_in_the_order_of_their_input() -> None:
    """Whichever ran first: the limits connect neighbours."""
    rows = [sample(a, 1.0, 0, (None, float(a))) for a in ("3", "1", "2")]
    text = drawing(rows, "t", "")
    assert [line[0] < line[2] for line in numbers(LIMIT, text)] == [True, True]
    assert re.findall(r"<title>r(\d)", text) == ["1", "2", "3"]


def test_words_of_an_input_are_side_by_side_in_their_order() -> None:
    """As soon as one is no number; an empty one says so."""
    for texts in (("10", "NEG", "2"), ("POS", "", "NEG")):
        text = drawing([sample(a, n) for n, a in enumerate(texts)], "t", "")
        places = [x for x, _ in numbers(CIRCLE, text)]
        assert places == sorted(places)
        assert places[1] - places[0] == pytest.approx(places[2] - places[1], abs=0.11)
        named = re.findall(r'text-anchor="middle">([^<]*)<', text)
        assert named == [each or "empty" for each in texts]


def test_a_mark_is_at_its_value_with_its_words_where_there_is_room() -> None:
    """The samples are at 0 and 100; of two marks the second has its words a line lower."""
    rows = [sample("0", 1.0), sample("100", 2.0)]
    text = drawing(rows, "t", "", marks=[Mark("25", "good", "<a>"), Mark("75", "bad", "b")])
    (left, _), (right, _) = numbers(CIRCLE, text)
    found = re.findall(
        r'sw-mark sw-(\w+)" x1="([\d.]+)".*?x="([\d.]+)" y="([\d.]+)" text-anchor="(\w+)">([^<]*)<',
        text,
    )
    (kind, x, at, y, anchor, words), second = found
    assert (kind, anchor, words) == ("good", "start", "&lt;a&gt;")
    assert float(x) == pytest.approx(left + (right - left) / 4, abs=0.11)
    assert float(at) > float(x)
    assert (second[0], second[4], second[5]) == ("bad", "end", "b")
    assert float(second[2]) < float(second[1])
    assert float(second[3]) - float(y) >= 10
    assert float(x) < WIDTH / 2 < float(second[1])


def many(bad: int, good: int) -> list[Sample]:
    rows = [sample(str(n), float(n), word="fail") for n in range(bad)]
    return rows + [sample(str(n), float(n), word="marginal") for n in range(1000, 1000 + good)]


@pytest.mark.parametrize(
    ("bad", "good", "kept_bad"),
    [(0, 300, 0), (300, 0, 300), (150, 150, 150), (0, 301, 0), (50, 400, 50), (500, 500, 200)],
)
def test_of_300_that_are_drawn_200_may_have_failed(bad: int, good: int, kept_bad: int) -> None:
    drawn = shown(many(bad, good))
    assert len(drawn) == min(DOTS_MAX, bad + good)
    assert sum(one.verdict is Verdict.FAIL for one in drawn) == kept_bad


@pytest.mark.parametrize("verdict", Verdict)
def test_of_many_each_verdict_is_drawn_first_or_among_the_rest(verdict: Verdict) -> None:
    """400 passed; 20 others are all there where they are worse than marginal."""
    others = [sample(str(n), float(n), word=verdict.word) for n in range(20)]
    passed = [sample(str(n), float(n)) for n in range(100, 500)]
    drawn = shown([*others, *passed])
    assert len(drawn) == DOTS_MAX
    kept = [one for one in drawn if one.value < 100]
    if verdict > Verdict.MARGINAL:
        assert kept == others
    else:
        assert 0 < len(kept) < 20  # evenly over 420 values: about 14


def test_both_ends_of_many_are_drawn() -> None:
    values = {one.value for one in shown(many(500, 500))}
    assert {0.0, 499.0, 1000.0, 1499.0} <= values
    assert len(values) == DOTS_MAX


# Which inputs are swept


def results(place: Path, columns: str, cases: list[str], checks: list[str]) -> list[Sweep]:
    head = f"{CASES.split(',plc')[0]},{columns}"
    (place / "cases.csv").write_text("\n".join([head, *cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([CHECKS, *checks, ""]), encoding="utf-8")
    return sweeps(read_results(place))


def case(run: str, *inputs: str, plan: str = "p", name: str = "c") -> str:
    return f"{plan},{name},{run},pass,1,1,1,,,{','.join(inputs)}"


def check(run: str, value: str, metric: str = "m", plan: str = "p", name: str = "c") -> str:
    return f"{plan},{name},{run},,{metric},{value},um,,,0,pass,p.csv:2"


def test_columns_of_inputs_that_differ_are_swept(tmp_path: Path) -> None:
    """Not those that are the same, of other kinds, or without a colon."""
    columns = "plc:V.E.A,set:Z.b,fault:probe,title,note:x,search:plc:V.E.A"
    cases = [case(f"r{n}", str(n), "1", f"f{n % 2}", f"t{n}", f"n{n}", f"s{n}") for n in range(3)]
    (sweep,) = results(tmp_path, columns, cases, [check(f"r{n}", str(n)) for n in range(3)])
    assert sweep.columns == ("plc:V.E.A", "fault:probe")
    assert [one.at for one in sweep.samples] == [("0", "f0"), ("1", "f1"), ("2", "f0")]


def test_cases_of_the_same_name_in_two_plans_are_two(tmp_path: Path) -> None:
    """Two runs of one and three of the other: three are a sweep."""
    cases = [case(f"p{n}", str(n)) for n in range(2)]
    cases += [case(f"q{n}", str(n), plan="q") for n in range(3)]
    checks = [check(f"p{n}", str(n)) for n in range(2)]
    checks += [check(f"q{n}", str(n), plan="q") for n in range(3)]
    assert [one.case for one in results(tmp_path, "plc:V.E.A", cases, checks)] == ["q-c"]


def test_a_metric_is_drawn_with_the_runs_that_have_it(tmp_path: Path) -> None:
    """k is in one run alone, w is no number in the second, the same value in all is nothing."""
    cases = [case(f"r{n}", str(n)) for n in range(3)]
    checks = [check(f"r{n}", str(n)) for n in range(3)]
    checks += [check("r0", "1", "k"), check("r0", "1", "w"), check("r1", "FREE", "w")]
    checks += [check("r2", "5", "w")] + [check(f"r{n}", "7", "same") for n in range(3)]
    found = {one.metric: len(one.samples) for one in results(tmp_path, "plc:V.E.A", cases, checks)}
    assert found == {"m": 3, "w": 2}


def test_runs_of_no_case_and_statistics_are_no_sweep(tmp_path: Path) -> None:
    cases = [f"{case(f'r{n}', str(n), name='')}," for n in range(3)]
    cases += [f"{case(f's{n}', str(n))},3" for n in range(3)]
    checks = [check(f"r{n}", str(n), name="") for n in range(3)]
    checks += [check(f"s{n}", str(n)) for n in range(3)]
    assert results(tmp_path, "plc:V.E.A,runs", cases, checks) == []


def grid(count: int) -> Sweep:
    rows = tuple(
        Sample(f"r{n}", (str(n % 2), str(n)), float(n), 0.0, (None, None), Verdict.PASS)
        for n in range(count)
    )
    return Sweep("p-c", "m", "um", ("plc:V.E.A", "plc:V.E.B"), rows)


def test_two_inputs_are_a_grid_up_to_400_cells_then_two_pictures() -> None:
    assert (grid(CELLS_MAX).is_grid, grid(CELLS_MAX).pictures) == (True, 1)
    assert (grid(CELLS_MAX + 1).is_grid, grid(CELLS_MAX + 1).pictures) == (False, 2)


def test_the_worst_metric_comes_first(tmp_path: Path) -> None:
    rows = [(name, str(a), "1", float(a), word) for name, word in (("a", "pass"), ("b", "fail"))
            for a in (1, 2, 3)]  # fmt: skip
    text = sweeps_section(read_results(folder(tmp_path, rows)))
    assert text.index("p-b") < text.index("p-a")


def test_two_inputs_have_a_sensitivity_and_one_has_none(tmp_path: Path) -> None:
    """m = 3 A - B over A 1 .. 2, B 10 .. 30: 3 and -20; the first largest less smallest is 23."""
    rows = [("two", a, b, 3.0 * int(a) - int(b), "pass") for a in "12" for b in ("10", "20", "30")]
    rows += [("one", a, "1", float(a), "pass") for a in "123"]
    found = sweeps(read_results(folder(tmp_path, rows)))
    made, notes = sensitivities(found)
    assert notes == []
    (one,) = made
    assert one.sweep.case == "p-two"
    assert [effect.change.value for effect in one.effects] == pytest.approx([3.0, -20.0])
    assert one.width == pytest.approx(23.0)
    text = sensitivity_section(found)
    assert "▼ -87 %" in text
    assert "▲ +13 %" in text
    assert sensitivity_section([each for each in found if each.case == "p-one"]) == ""


@pytest.mark.parametrize("places", [("1", "2"), ("10", "20", "50"), ("-3", "400")])
def test_the_first_and_the_last_value_are_10_px_inside_the_field(places: tuple[str, ...]) -> None:
    text = drawing([sample(at, float(n)) for n, at in enumerate(places)], "t", "")
    ((left, width),) = numbers(r'class="ax-field" x="([\d.]+)" y="[\d.]+" width="([\d.]+)"', text)
    across = [x for x, _ in numbers(CIRCLE, text)]
    assert across[0] == pytest.approx(left + 10.0, abs=0.06)
    assert across[-1] == pytest.approx(left + width - 10.0, abs=0.06)


@pytest.mark.parametrize(("place", "words"), [(0, ("1", "2")), (1, ("30", "-5"))])
def test_the_pointer_shows_the_input_that_is_drawn(place: int, words: tuple[str, str]) -> None:
    """Of two swept inputs the one that goes across, with seven digits of the value."""
    samples = [
        Sample("a", ("1", "30"), 1.2345678, 0.0, (None, None), Verdict.PASS),
        Sample("b", ("2", "-5"), 2.0, 0.0, (None, None), Verdict.FAIL),
    ]
    titles = re.findall(r"<title>([^<]*)</title>", drawing(samples, "t", "", place))
    assert sorted(titles) == [f"a: 1.234568 at {words[0]}, pass", f"b: 2 at {words[1]}, fail"]
