"""A campaign that ends at its first failure: that run is written and shown as any other."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import campaign
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.talk import Manner
from axisrig.bench.plan.verdict import Verdict

GOOD = (Verdict.PASS, Verdict.MARGINAL)


class Kept:
    """What is open beside the runs; keeps the order in which all is done."""

    def __init__(self, done: list[str], name: str, fails: str = "") -> None:
        self._done, self._name, self._fails = done, name, fails

    def __enter__(self) -> "Kept":
        self._done.append(f"{self._name} opens")
        return self

    def __exit__(self, *_: object) -> None:
        self._done.append(f"{self._name} closes")

    def add(self, one: CaseResult) -> None:
        self._done.append(f"writes {one.case.case}")
        if one.case.case == self._fails:
            raise OSError("full")

    def show(self, one: CaseResult) -> None:
        self._done.append(f"shows {one.case.case}")


def written(
    verdicts: dict[str, Verdict], *, ends_at_first: bool, fails: str = ""
) -> tuple[list[str], list[str], OSError | None]:
    """What is done of runs with these verdicts, which results there are, and what went wrong."""
    done: list[str] = []
    results: list[CaseResult] = []

    def running() -> Iterator[CaseResult]:
        try:
            for name, verdict in verdicts.items():
                done.append(f"runs {name}")
                yield CaseResult(case_of(name), verdict, [])
        finally:
            done.append("runs end")

    watch: Any = SimpleNamespace(beside=lambda _: Kept(done, "watch"))
    writer: Any = Kept(done, "folder", fails)
    progress: Any = Kept(done, "progress")
    manner = Manner(ends_at_first=ends_at_first)

    def end() -> None:
        done.append("ends")

    error = campaign._write(running(), writer, results, progress, watch, manner, end)
    return done, [one.case.case for one in results], error


@pytest.mark.parametrize("verdict", Verdict)
def test_the_run_that_ends_a_campaign_is_shown_and_none_after_it(verdict: Verdict) -> None:
    done, results, error = written(
        {"a": Verdict.PASS, "b": verdict, "c": Verdict.PASS}, ends_at_first=True
    )
    wanted = ["a", "b", "c"] if verdict in GOOD else ["a", "b"]
    for word in ("runs", "writes", "shows"):
        of_runs = [one.removeprefix(f"{word} ") for one in done if one.startswith(word)]
        assert [one for one in of_runs if one != "end"] == wanted
    assert (results, error) == (wanted, None)


@pytest.mark.parametrize("verdict", [Verdict.FAIL, Verdict.ERROR])
def test_without_the_option_all_runs_are_run(verdict: Verdict) -> None:
    _, results, _ = written(dict.fromkeys("abc", verdict), ends_at_first=False)
    assert results == ["a", "b", "c"]


@pytest.mark.parametrize("fails", ["", "a"])
def test_what_is_beside_the_runs_closes_before_their_folder(fails: str) -> None:
    """The time is noted before the folder is closed; no process of a run is left at the end.

    A run that a full disk kept from its place is neither counted nor shown.
    """
    done, results, error = written({"a": Verdict.PASS}, ends_at_first=False, fails=fails)
    assert done[:4] == ["folder opens", "progress opens", "watch opens", "runs a"]
    order = ["watch closes", "progress closes", "ends", "folder closes"]
    assert [one for one in done if one in order] == order
    assert done.count("runs end") == 1
    assert ("shows a" in done) is (results == ["a"]) is (not fails)
    assert (str(error) if error else "") == ("full" if fails else "")
