"""Why a run is worse or changed: the checks that fell, limits that are met exactly, frames."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from tests.results.test_pairs import compared, runs_of_a_case

RUN = [{"run": "r"}]
BELOW = {"upper": "", "lower": "-5"}


def sides(
    before: Mapping[str, str], after: Mapping[str, str], verdict: str = "fail"
) -> list[dict[str, Any]]:
    """A run in both folders with one check, that passed before; verdict: of the run after."""
    return [
        {"runs": RUN, "checks": [before]},
        {"runs": [{"run": "r", "verdict": verdict}], "checks": [after]},
    ]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ({"value": "4"}, {"value": "7"},
         "m is 2 um beyond its limit, it was 1 um inside its limit"),
        ({"value": "5"}, {"value": "7"}, "m is 2 um beyond its limit, it was on its limit"),
        ({"value": "7"}, {"value": "5"}, "m is on its limit, it was 2 um beyond its limit"),
        ({"value": "4"}, {"value": "5"}, "m is on its limit, it was 1 um inside its limit"),
        # The same value with another limit: there is no other margin of it to name
        ({"value": "4"}, {"value": "4", "upper": "3"}, "m is 1 um beyond its limit"),
        ({"value": "4", "unit": ""}, {"value": "7", "unit": ""},
         "m is 2 beyond its limit, it was 1 inside its limit"),
        ({**BELOW, "value": "-3"}, {**BELOW, "value": "-7.25"},
         "m is 2.25 um beyond its limit, it was 2 um inside its limit"),
        # However near it is, and four digits of whatever it is
        ({"value": "4.9995"}, {"value": "5.00025"},
         "m is 0.00025 um beyond its limit, it was 0.0005 um inside its limit"),
        ({"value": "-1234.56"}, {"value": "1239.56"},
         "m is 1235 um beyond its limit, it was 1240 um inside its limit"),
    ],
)  # fmt: skip
def test_a_run_that_fell_says_where_its_value_is_and_was(
    tmp_path: Path, before: Mapping[str, str], after: Mapping[str, str], words: str
) -> None:
    """The limit is 5."""
    limit = {"upper": "5"}
    both = sides({**limit, **before}, {**limit, **after, "verdict": "fail"})
    assert compared(tmp_path, *both).worse() == [f"r: pass -> fail: {words}"]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ({"value": ""}, {"value": "7"}),
        ({"value": "4", "upper": ""}, {"value": "7"}),
        ({"value": "4"}, {"value": ""}),
        ({"value": "4"}, {"value": "7", "upper": ""}),
    ],
)
def test_a_check_without_a_margin_in_either_folder_is_no_reason(
    tmp_path: Path, before: Mapping[str, str], after: Mapping[str, str]
) -> None:
    limit = {"upper": "5"}
    both = sides({**limit, **before}, {**limit, **after, "verdict": "fail"})
    assert compared(tmp_path, *both).worse() == ["r: pass -> fail"]


def test_the_reasons_are_the_checks_that_fell_and_have_limits(tmp_path: Path) -> None:
    """One got better, one stayed bad, one has no limit, one has no value any more."""

    def checks(**verdicts: tuple[str, str]) -> list[dict[str, str]]:
        return [
            {"metric": name, "value": value, "upper": "5", "verdict": verdict}
            for name, (value, verdict) in verdicts.items()
        ]

    before = checks(fell=("4", "pass"), rose=("7", "fail"), bad=("8", "fail"), gone=("1", "pass"),
                    fell_too=("2", "marginal"))  # fmt: skip
    after = checks(fell=("6", "fail"), rose=("3", "pass"), bad=("9", "fail"), gone=("", "error"),
                   fell_too=("9", "fail"))  # fmt: skip
    for rows in (before, after):
        rows.append({"metric": "free", "value": "1", "verdict": "pass" if rows is before
                     else "fail"})  # fmt: skip
    found = compared(
        tmp_path,
        {"runs": [{"run": "r", "verdict": "fail"}], "checks": before},
        {"runs": [{"run": "r", "verdict": "error"}], "checks": after},
    )
    assert found.worse() == [
        "r: fail -> error: fell is 1 um beyond its limit, it was 1 um inside its limit;"
        " fell_too is 4 um beyond its limit, it was 3 um inside its limit"
    ]
    (lone,) = compared(tmp_path / "b", *sides({"value": "1"}, {"value": "2"})).worse()
    assert lone == "r: pass -> fail"


def test_values_that_came_nearer_are_one_line_of_their_run_unless_it_fell(tmp_path: Path) -> None:
    before = [{"metric": name, "value": "1", "upper": "5"} for name in "ab"]
    values = {"a": "2", "b": "4.5"}
    after = [{"metric": name, "value": value, "upper": "5"} for name, value in values.items()]
    passed = {"runs": RUN, "checks": after}
    assert compared(tmp_path / "a", {"runs": RUN, "checks": before}, passed).worse() == [
        "r: a is 3 um inside its limit, it was 4 um inside its limit;"
        " b is 0.5 um inside its limit, it was 4 um inside its limit"
    ]
    fell = {"runs": [{"run": "r", "verdict": "marginal"}], "checks": after}
    assert compared(tmp_path / "b", {"runs": RUN, "checks": before}, fell).worse() == [
        "r: pass -> marginal"
    ]


def test_what_only_one_folder_has_is_worse_where_it_is_missing_or_bad(tmp_path: Path) -> None:
    """A new run that passed only just is none of these."""
    words = ("pass", "marginal", "inconclusive", "fail", "error")
    old = {"runs": [{"run": f"old-{word}", "verdict": word} for word in words]}
    new = {"runs": [{"run": f"new-{word}", "verdict": word} for word in words]}
    assert compared(tmp_path, old, new).worse() == [
        *(f"old-{word}: is missing, was {word}" for word in words),
        *(f"new-{word}: new, {word}" for word in ("inconclusive", "fail", "error")),
    ]


@pytest.mark.parametrize(
    ("hashes", "frames", "is_changed"),
    [
        (("a", "a"), "equal", False),
        (("a", "b"), "changed", True),
        (("", ""), "no hash", False),  # as of a real bus: nothing is known to be another
        (("a", ""), "no hash", False),
        (("", "b"), "no hash", False),
    ],
)
def test_a_run_has_changed_with_its_frames_where_both_are_known(
    tmp_path: Path, hashes: tuple[str, str], frames: str, is_changed: bool
) -> None:
    both = [{"runs": [{"run": "r", "frame_log_sha256": one}]} for one in hashes]
    (found,) = compared(tmp_path, *both).pairs
    assert (found.frames.value, found.is_changed) == (frames, is_changed)


@pytest.mark.parametrize(
    ("value", "uncertainty", "verdict", "is_changed"),
    [
        ("1", "0.0", "pass", False), ("1.5", "0.0", "pass", True), ("1.5", "0.5", "pass", False),
        ("2", "0.5", "pass", True), ("1", "0.0", "marginal", True), ("0.5", "0.0", "pass", True),
    ],
)  # fmt: skip
def test_a_run_has_changed_with_a_value_or_its_verdict(
    tmp_path: Path, value: str, uncertainty: str, verdict: str, is_changed: bool
) -> None:
    """From 1 um, known to as much."""
    before = {"value": "1", "uncertainty": uncertainty}
    after = {"value": value, "uncertainty": uncertainty}
    for number, pair in enumerate(((before, after), (after, before))):
        both = sides(*pair, verdict)
        (found,) = compared(tmp_path / str(number), *both).pairs
        assert found.is_changed is is_changed


@pytest.mark.parametrize(("few", "many"), [(1, 3), (0, 3), (1, 1)])
def test_a_case_with_one_value_in_a_folder_has_no_shift(
    tmp_path: Path, few: int, many: int
) -> None:
    def side(count: int) -> dict[str, Any]:
        return runs_of_a_case([float(n) for n in range(count)], 3)

    assert compared(tmp_path / "a", side(few), side(many)).shifts == []
    assert compared(tmp_path / "b", side(many), side(few)).shifts == []
    assert len(compared(tmp_path / "c", side(2), side(3)).shifts) == 1
