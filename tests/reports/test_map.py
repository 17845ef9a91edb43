"""The map of a campaign: a character for each run and metric, in JSON inside the page."""

import json
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.reports.campaign_map.section import METRICS_MAX, CampaignMap


def run(name: str, verdict: str, plan: str = "p", **checks: str) -> StoredRun:
    rows = [{"metric": metric, "verdict": word} for metric, word in checks.items()]
    return StoredRun({"plan": plan, "run": name, "verdict": verdict}, rows, None, None)


def data(*runs: StoredRun) -> dict[str, Any]:
    campaign = CampaignMap()
    for one in runs:
        campaign.add(one)
    found: dict[str, Any] = json.loads(campaign.data())
    return found


def test_a_run_has_a_character_for_itself_and_for_each_metric_of_its_plan() -> None:
    found = data(
        run("p-a", "fail", a="pass", b="fail"),
        run("p-b", "error", c="error"),
        run("q-a", "marginal", plan="q", z="marginal"),
    )
    assert [word for word, _ in found["verdicts"]] == [
        *("pass", "marginal", "inconclusive", "fail", "aborted", "error")
    ]
    first, second = found["plans"]
    assert (first["name"], first["metrics"], first["left_out"]) == ("p", ["a", "b", "c"], 0)
    assert first["runs"] == [["p-a", "303-"], ["p-b", "5--5"]]
    assert second["runs"] == [["q-a", "11"]]


def test_of_several_checks_of_a_metric_the_worst_counts() -> None:
    one = run("p-a", "fail")
    rows = [{"metric": "m", "verdict": word} for word in ("pass", "fail", "marginal")]
    found = data(StoredRun(one.case, rows, None, None))
    assert found["plans"][0]["runs"] == [["p-a", "33"]]


@pytest.mark.parametrize(
    ("verdict", "checks", "cells"),
    [
        ("error", {"m": "pass"}, "50"),
        ("aborted", {}, "4-"),
        ("pass", {"m": "fail"}, "03"),  # a check that had to fail
        ("inconclusive", {"m": "marginal"}, "21"),
        ("fail", {"m": "fail"}, "33"),
    ],
)
def test_the_first_character_is_the_verdict_of_the_run_itself(
    verdict: str, checks: dict[str, str], cells: str
) -> None:
    """Whatever its checks have: a run may end with an error after all of them passed."""
    (plan,) = data(run("p-a", verdict, **checks), run("p-z", "pass", m="pass"))["plans"]
    assert plan["runs"] == [["p-a", cells], ["p-z", "00"]]


@pytest.mark.parametrize("count", [METRICS_MAX - 1, METRICS_MAX, METRICS_MAX + 1])
def test_so_many_metrics_of_a_plan_are_drawn_and_the_others_counted(count: int) -> None:
    """Of plans each for itself; runs without a metric have no check in its place."""
    checks = {f"m{n}": "pass" for n in range(count)}
    first, second = data(run("p-a", "pass", **checks), run("p-b", "pass", m0="marginal"),
                         run("q-a", "pass", plan="q", m9="pass"))["plans"]  # fmt: skip
    drawn = min(count, METRICS_MAX)
    assert (len(first["metrics"]), first["left_out"]) == (drawn, count - drawn)
    assert first["runs"] == [["p-a", "0" * (drawn + 1)], ["p-b", "01" + "-" * (drawn - 1)]]
    assert (second["metrics"], second["left_out"]) == (["m9"], 0)


def test_of_many_metrics_the_worst_are_kept_in_their_order() -> None:
    verdicts = {f"m{n}": "pass" for n in range(METRICS_MAX + 5)}
    verdicts[f"m{METRICS_MAX + 3}"] = "fail"
    (plan,) = data(run("p-a", "fail", **verdicts))["plans"]
    assert plan["left_out"] == 5
    assert plan["metrics"][0] == "m0"
    assert plan["metrics"][-1] == f"m{METRICS_MAX + 3}"


@pytest.mark.parametrize("turn", [1, -1])
def test_a_metric_that_failed_in_any_run_is_kept(turn: int) -> None:
    """m34 has failed in one run and passed in the others, whichever came last."""
    last = f"m{METRICS_MAX + 4}"
    passed = {f"m{n}": "pass" for n in range(METRICS_MAX + 5)}
    runs = [run("p-a", "fail", **(passed | {last: "fail"})), run("p-b", "pass", **passed)]
    (plan,) = data(*runs[::turn])["plans"]
    assert plan["metrics"][-1] == last


def test_text_of_others_cannot_end_the_element() -> None:
    campaign = CampaignMap()
    hostile = "</script><script>alert(1)</script><!--&amp;"
    campaign.add(run("p-a", "pass", plan=hostile, **{hostile: "pass"}))
    text = campaign.data()
    assert not set("<>&") & set(text)
    (plan,) = json.loads(text)["plans"]
    assert (plan["name"], plan["metrics"]) == (hostile, [hostile])


@pytest.mark.long
def test_ten_thousand_cells_are_small() -> None:
    checks = {f"metric_{n}_um:Z": "pass" for n in range(9)}
    runs = [run(f"p-touch-{n:04}", "pass", **checks) for n in range(1000)]
    campaign = CampaignMap()
    for one in runs:
        campaign.add(one)
    assert len(campaign.data()) < 40_000
