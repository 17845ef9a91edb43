"""Samples on the page: sentences, values with their limits, and the runs that they are of."""

import re
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import IN_PLAN, PROBE, StoredResults, StoredRun
from axisrig.bench.plan.check_row import CheckRow
from axisrig.reports.statistics import section
from axisrig.reports.statistics.section import SampleView, statistics_section

NOTHING = {"mean": None, "spread": None, "cpk": None, "outlier": None, "first_sample": None,
           "drift": None}  # fmt: skip


def about(value: float, lower: float, upper: float) -> Any:
    return SimpleNamespace(value=value, lower=lower, upper=upper)


def apart(run: str, ratio: float) -> Any:
    return SimpleNamespace(run=run, ratio=ratio, is_apart=ratio > 1.0)


def drift(p_value: float) -> Any:
    return SimpleNamespace(slope=about(0.25, 0.1, 0.4), rank=SimpleNamespace(p_value=p_value))


def sentences(unit: str = " um", equal: tuple[str, ...] = (), **found: Any) -> list[str]:
    known: Any = SimpleNamespace(n=12, is_small=False)
    known.__dict__.update(NOTHING, **found)
    view = SampleView("r", "", "m", unit.strip(), equal, (), known)
    return list(section._sentences(view, unit))


@pytest.mark.parametrize(
    ("found", "words"),
    [
        ({}, []),
        ({"mean": about(1.5, 1.0, 2.0)}, ["mean 1.5 (1 to 2) um"]),
        ({"spread": about(0.5, 0.25, 1.0)}, ["s 0.5 (0.25 to 1) um", "2 s 1 um"]),
        ({"cpk": about(1.33, 1.0, 1.66)}, ["Cpk 1.33 (1 to 1.66)"]),
        ({"outlier": apart("p-7", 1.25)}, ["outlier: p-7, 1.25 times its limit"]),
        ({"outlier": apart("p-7", 1.0)}, []),
        ({"first_sample": apart("p-1", 2.0)}, ["first value apart: p-1, 2 times its limit"]),
        ({"first_sample": apart("p-1", 0.5)}, []),
        ({"drift": drift(0.049)}, ["drift 0.25 um for each value, p 0.049"]),
        ({"drift": drift(0.05)}, []),
        ({"equal": ("p-2", "p-3")}, ["not counted, same frames as an earlier run: p-2, p-3"]),
    ],
)
def test_each_answer_of_a_sample_has_its_sentence(found: dict[str, Any], words: list[str]) -> None:
    assert sentences(**found) == ["n 12", *words]


def test_a_small_sample_says_so_and_numbers_of_no_unit_have_none() -> None:
    assert sentences(n=9, is_small=True) == ["n 9, a small sample"]
    assert sentences("", mean=about(1.0, 0.0, 2.0), spread=about(0.5, 0.2, 1.0)) == [
        "n 12", "mean 1 (0 to 2)", "s 0.5 (0.2 to 1)", "2 s 1",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [("1.23456789", "um", "1.234568 um"), ("7", "", "7"), ("", "um", "no value"),
     ("many", "um", "no value"), ("-0.5", "mm", "-0.5 mm")],
)  # fmt: skip
def test_a_value_has_seven_digits_and_its_unit(value: str, unit: str, words: str) -> None:
    assert section._value(CheckRow("m", value=value, unit=unit)) == words


def test_the_block_of_a_sample_has_a_line_for_each_statistic(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rows = (CheckRow("mean(m)", value="1", unit="um", verdict="pass", asked="<= 2"),
            CheckRow("spread(m)", unit="um", verdict="error", asked="< 1 & 2"))  # fmt: skip
    known: Any = SimpleNamespace(n=3, is_small=True, **NOTHING)
    monkeypatch.setattr(section, "drawings", lambda _, words: [f"<svg>{words}</svg>"])
    text = section._block(SampleView("p-a", "the <title>", "m:Z", "um", (), rows, known))
    assert "<h3>p-a: m:Z, um</h3>" in text
    assert '<p class="note">the &lt;title&gt;</p>' in text
    assert "<figure><svg>m:Z, um</svg></figure>" in text
    assert re.findall(r"<li>([^<]*)</li>", text) == [
        "pass: mean(m) = 1 um, asked for &lt;= 2",
        "error: spread(m) = no value, asked for &lt; 1 &amp; 2",
    ]
    monkeypatch.setattr(section, "drawings", lambda *_: [])
    bare = section._block(SampleView("p-a", "", "m", "", (), (), known))
    assert bare.startswith("<h3>p-a: m</h3><p>n 3, a small sample</p><ul></ul>")


# Whose runs


def run_of(run: str, plan: str = "p", case: str = "a", *limits: tuple[str, str, str],
           **more: str) -> StoredRun:  # fmt: skip
    """limits: metric, lower and upper limit of each check."""
    made = StoredRun({"run": run, "plan": plan, "case": case, "verdict": "pass", **more}, [], None,
                     None)  # fmt: skip
    made.__dict__["checks"] = [
        CheckRow(metric, lower=lower, upper=upper) for metric, lower, upper in limits
    ]
    return made


def test_a_row_of_statistics_is_about_the_runs_of_its_case_alone() -> None:
    """Of the same plan; neither a probe nor a run that the plan has no more; a run about itself."""
    row = run_of("p-a", runs="2")
    own = [run_of("p-a-1"), run_of("p-a-2")]
    others = [run_of("q-a", plan="q"), run_of("p-b", case="b"), run_of("p-a-3", **{IN_PLAN: "no"}),
              run_of("p-a-s01", **{PROBE: "p-a"})]  # fmt: skip
    results = StoredResults(SimpleNamespace(), [*own, *others, row], {})  # type: ignore[arg-type]
    assert section._members(results, row) == own
    assert section._members(results, own[1]) == [own[1]]


@pytest.mark.parametrize(
    ("limits", "found"),
    [
        ([("m", "-1", "2"), ("m", "-1", "2")], (-1.0, 2.0)),
        ([("m", "", "0"), ("m", "", "0")], (None, 0.0)),
        ([("m", "-1", "2"), ("m", "-1", "3")], (None, None)),
        ([("m", "-1", "2"), ("other", "0", "9")], (-1.0, 2.0)),
        ([("other", "0", "9")], (None, None)),
        ([], (None, None)),
    ],
)
def test_limits_are_those_that_all_runs_check(
    limits: list[tuple[str, str, str]], found: tuple[float | None, float | None]
) -> None:
    runs = [run_of(f"p-a-{number}", "p", "a", one) for number, one in enumerate(limits)]
    assert section._limits(runs, "m") == found


def test_a_folder_without_samples_has_no_section() -> None:
    assert statistics_section(StoredResults(SimpleNamespace(), [run_of("p-a")], {})) == ""  # type: ignore[arg-type]
