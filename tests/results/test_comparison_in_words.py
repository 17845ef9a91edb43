"""The lines of `axisrig diff`: which kinds there are, in which order, and where they end."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.plan.verdict import Verdict
from axisrig.results.compare.pairs import CaseShift, Comparison, MetricPair, RunPair
from axisrig.results.compare.words import diff_lines

SHOWN_MAX = 40  # docs/compare.md


def run(name: str, verdict: Verdict = Verdict.PASS, frames: str = "f") -> Any:
    return SimpleNamespace(run=name, verdict=verdict, case={"frame_log_sha256": frames})


def metric(name: str, shift: float, u: float, unit: str = "um") -> MetricPair:
    """A value of 10 that shifts; u: uncertainty before, and none after."""
    both = (Verdict.PASS, Verdict.PASS)
    return MetricPair(name, "m:Z", unit, 10.0, 10.0 + shift, u, 0.0, (None, None), both)


def pair(
    name: str, *metrics: MetricPair, verdicts: tuple[Verdict, Verdict] = (Verdict.PASS,) * 2,
    frames: tuple[str, str] = ("f", "f"), before: str = "",
) -> RunPair:  # fmt: skip
    """before: the id that the run had then, where it is another."""
    runs = run(before or name, verdicts[0], frames[0]), run(name, verdicts[1], frames[1])
    return RunPair(*runs, bool(before), metrics)


def lines(comparison: Comparison, *kinds: str) -> list[str]:
    return [line for line in diff_lines(comparison) if line.startswith(kinds)]


def test_the_surest_shift_is_the_first_line_of_its_kind() -> None:
    """En is the shift by its uncertainty: 2, 4, infinite where both are exact; 1 is no shift."""
    runs = [pair("a", metric("a", 2.0, 1.0)), pair("b", metric("b", -4.0, 1.0, unit="")),
            pair("c", metric("c", 1.0, 1.0), metric("c", 0.5, 0.0))]  # fmt: skip
    assert lines(Comparison(runs, [], [], []), "shifted") == [
        "shifted: c: m:Z 10 -> 10.5 um (En inf)",
        "shifted: b: m:Z 10 -> 6 (En 4)",
        "shifted: a: m:Z 10 -> 12 um (En 2)",
    ]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [(1234.5678, 1230.12345, "1234.568 -> 1230.123"),
     (-0.12345678, 2.5e-7, "-0.1234568 -> 2.5e-07"), (100000.04, 100000.14, "100000 -> 100000.1"),
     (0.0, 1e-12, "0 -> 1e-12")],
)  # fmt: skip
def test_both_values_of_a_shift_have_seven_digits(before: float, after: float, words: str) -> None:
    both = (Verdict.PASS, Verdict.PASS)
    one = MetricPair("r", "m:Z", "um", before, after, 0.0, 0.0, (None, None), both)
    found = lines(Comparison([pair("r", one)], [], [], []), "shifted")
    assert found == [f"shifted: r: m:Z {words} um (En inf)"]


@pytest.mark.parametrize("count", [SHOWN_MAX, SHOWN_MAX + 1, SHOWN_MAX + 9])
def test_of_each_kind_forty_lines_are_shown_and_the_rest_is_counted(count: int) -> None:
    names = [f"r{number:02}" for number in range(count)]
    both = (Verdict.FAIL, Verdict.PASS)
    comparison = Comparison(
        [pair(name, metric(name, 2.0, 1.0), verdicts=both, before=f"o-{name}") for name in names],
        [run(f"new-{name}") for name in names], [run(f"gone-{name}") for name in names], [],
    )  # fmt: skip
    rest = count - SHOWN_MAX
    firsts = {
        "worse": "gone-r00: is missing, was pass",
        "better": "o-r00 -> r00: fail -> pass",
        "shifted": "r00: m:Z 10 -> 12 um (En 2)",
        "matched by equal inputs": "o-r00 -> r00",
        "new": "new-r00 (pass)",
    }
    for kind, first in firsts.items():
        found = lines(comparison, f"{kind}: ")
        assert found[0] == f"{kind}: {first}"
        assert found[SHOWN_MAX:] == ([f"{kind}: {rest} more"] if rest else [])
    *_, last = diff_lines(comparison)
    assert last == (
        f"{count} runs in both ({count} matched by equal inputs), {count} new, {count} missing;"
        f" frames: {count} equal; {count} worse"
    )


@pytest.mark.parametrize(
    ("p_value", "is_said"), [(0.0, True), (0.0499, True), (0.05, False), (0.9, False)]
)
def test_the_mean_of_a_case_is_another_below_a_p_of_five_hundredths(
    p_value: float, is_said: bool
) -> None:
    shift = CaseShift("p-c", "m:Z", "um", (3, 5), (1.5, 2.25), p_value)
    found = lines(Comparison([], [], [], [shift]), "case")
    words = "case: p-c: mean of m:Z 1.5 -> 2.25 um (n 3 and 5"
    assert found == ([f"{words}, p {p_value:.2g})"] if is_said else [])


def test_what_changed_comes_before_what_came_of_it_and_the_count_is_last() -> None:
    """Worse, better, shifted, case, matched, new."""
    runs = [
        pair("up", verdicts=(Verdict.FAIL, Verdict.PASS), frames=("f", "g")),
        pair("down", verdicts=(Verdict.PASS, Verdict.FAIL), frames=("", "f")),
        pair("moved", metric("moved", 2.0, 1.0), before="old"),
    ]
    shift = CaseShift("p-c", "m", "", (2, 2), (1.0, 2.0), 0.01)
    comparison = Comparison(runs, [run("fresh")], [], [shift])
    found = list(
        diff_lines(comparison, [("rig z.toml", ("axis.Z.kv", "axis.Z.feed")), ("seed", ())])
    )
    assert found == [
        "changed: rig z.toml", "  axis.Z.kv", "  axis.Z.feed", "changed: seed",
        "worse: down: pass -> fail",
        "better: up: fail -> pass",
        "shifted: moved: m:Z 10 -> 12 um (En 2)",
        "case: p-c: mean of m 1 -> 2 (n 2 and 2, p 0.01)",
        "matched by equal inputs: old -> moved",
        "new: fresh (pass)",
        "3 runs in both (1 matched by equal inputs), 1 new, 0 missing;"
        " frames: 1 equal, 1 changed, 1 no hash; 1 worse",
    ]  # fmt: skip


def test_folders_without_a_run_in_both_have_no_frames() -> None:
    assert list(diff_lines(Comparison([], [], [], []))) == [
        "0 runs in both (0 matched by equal inputs), 0 new, 0 missing; frames: none; 0 worse"
    ]


def test_a_value_that_is_no_number_has_not_shifted() -> None:
    lacking = MetricPair("r", "m", "", None, 1.0, 0.0, 0.0, (None, None), (Verdict.PASS,) * 2)
    assert (lacking.shift, lacking.en) == (0.0, 0.0)
    assert not lines(Comparison([pair("r", lacking)], [], [], []), "shifted")
    assert math.isinf(metric("r", 1.0, 0.0).en)
