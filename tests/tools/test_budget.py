"""The budget of a measured value: shares, their sum, the cause that is named."""

import base64
import csv
import gzip
import random
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.cli.main import app
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.tools.budget.budget import budget_lines, causes, make_budget
from axisrig.kernel.errors import UserError
from axisrig.reports.build import build_report
from axisrig.results.budget.page import add_budget, write_budget

PLAN = Path(__file__).parents[2] / "testplans" / "latch_accuracy.csv"
SPEED_MM_S = -10.0
PROBE = {"pretravel_um": "8", "trigger_delay_us": "120"}


def row(*texts: str) -> Case:
    plan = read_plan(PLAN).with_inputs([parse_assignment(text) for text in texts])
    return only(plan.cases, "f600")


def probe_row() -> Case:
    return row(*(f"plant:probe.{name}={value}" for name, value in PROBE.items()))


def calculated(cases: Sequence[Case]) -> Iterator[CaseResult]:
    """A measured value made of its causes, rounded to 20 bit on 10 mm."""
    for case in cases:
        value = {name: float(case.inputs.get(f"plant:probe.{name}", 0)) for name in PROBE}
        late_us = value["trigger_delay_us"] + float(
            case.inputs.get("drive:servo.input_delay_us", 4)
        )
        error_um = -value["pretravel_um"] + SPEED_MM_S * late_us * 1e-3
        bits = int(case.inputs.get("drive:servo.encoder_increments", 2**20))
        error_um = round(error_um * bits / 1e4) / bits * 1e4
        values = (error_um, SPEED_MM_S, late_us / 1e3)
        checks = [judge(check, found) for check, found in zip(case.checks, values, strict=True)]
        yield CaseResult(case, Verdict.PASS, checks)


def test_the_shares_add_up_and_each_is_its_closed_form() -> None:
    budget = make_budget(probe_row(), None, calculated)
    assert [share.cause.cause for share in budget.shares] == [
        "pre-travel",
        "trigger",
        "input",
        "encoder",
    ]
    total = sum(share.in_turn_um for share in budget.shares) + budget.left_um
    assert total == pytest.approx(budget.error_um, abs=1e-9)
    expected = {"pre-travel": -8.0, "trigger": -1.2, "input": -0.04}
    for share in budget.shares:
        if share.cause.cause in expected:
            assert share.expected_um == pytest.approx(expected[share.cause.cause], rel=1e-9)
            assert share.in_turn_um == pytest.approx(share.expected_um, abs=2e-4)
        else:
            assert abs(share.in_turn_um) <= (share.bound_um or 0.0)
    assert budget.left_um == pytest.approx(0.0, abs=1e-4)
    assert budget.largest is not None
    assert budget.largest.cause.cause == "pre-travel"
    assert budget.interacting == ()


def test_each_run_is_made_once() -> None:
    seen: list[str] = []

    def counted(cases: Sequence[Case]) -> Iterator[CaseResult]:
        seen.extend(case.run for case in cases)
        return calculated(cases)

    make_budget(probe_row(), None, counted)
    assert len(seen) == len(set(seen)) == 1 + 4 + 3  # whole, four alone, three more in turn


def test_causes_that_act_on_each_other_are_named() -> None:
    def multiplied(cases: Sequence[Case]) -> Iterator[CaseResult]:
        for case in cases:
            both = [float(case.inputs.get(f"plant:probe.{name}", 0)) for name in PROBE]
            values = (both[0] * both[1] / 100, SPEED_MM_S, 0.0)
            checks = [judge(check, found) for check, found in zip(case.checks, values, strict=True)]
            yield CaseResult(case, Verdict.PASS, checks)

    budget = make_budget(probe_row(), None, multiplied)
    assert [share.cause.cause for share in budget.interacting] == ["pre-travel"]
    assert "act on each other" in budget_lines(budget)[-1]


def test_a_row_without_a_value_says_why() -> None:
    def nothing(cases: Sequence[Case]) -> Iterator[CaseResult]:
        for case in cases:
            checks = [judge(check, None, note="the probe met nothing") for check in case.checks]
            yield CaseResult(case, Verdict.INCONCLUSIVE, checks)

    with pytest.raises(UserError, match="the probe met nothing"):
        make_budget(probe_row(), None, nothing)


def test_an_axis_that_is_not_there_is_refused() -> None:
    with pytest.raises(UserError, match="which axis") as caught:
        make_budget(probe_row(), "X", calculated)
    assert "Z" in str(caught.value)


def test_the_table_and_the_page(tmp_path: Path) -> None:
    budget = make_budget(probe_row(), None, calculated)
    with write_budget(tmp_path / "a.csv", budget).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [entry["cause"] for entry in rows][-1] == "left with all causes off"
    assert sum(float(entry["in_turn_um"]) for entry in rows) == pytest.approx(budget.error_um)
    page = write_budget(tmp_path / "a.html", budget).read_text(encoding="utf-8")
    assert "pre-travel" in page
    assert page.count("<rect") == len(budget.shares) + 2  # what is left, and the whole
    with pytest.raises(UserError, match="no kind of a budget"):
        write_budget(tmp_path / "a.pdf", budget)


def report_of(folder: Path, frames: str) -> str:
    """Write tables and report of the row of the budget; return what the page has of runs."""
    head = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256"
    run = f"latch_accuracy,f600,latch_accuracy-f600,pass,1,1,1,,{frames}"
    (folder / "cases.csv").write_text(f"{head}\n{run}\n", encoding="utf-8")
    (folder / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    page = build_report(folder).read_text(encoding="utf-8")
    packed = re.search(r'class="stored" data-run="latch_accuracy-f600">(\S+)', page)
    assert packed is not None
    return gzip.decompress(base64.b64decode(packed[1])).decode("utf-8")


def test_a_budget_in_a_results_folder_is_in_the_card_of_its_run(tmp_path: Path) -> None:
    budget = replace(make_budget(probe_row(), None, calculated), frame_log_sha256="ab" * 32)
    assert "fall" not in report_of(tmp_path, "ab" * 32)
    path = add_budget(tmp_path, budget)
    assert path == tmp_path / "budgets" / "latch_accuracy-f600.csv"
    shown = report_of(tmp_path, "ab" * 32)
    assert shown.count('<rect class=\\"fall-') == len(budget.shares) + 2
    assert "pre-travel" in shown
    assert "systematic" in shown
    # The row was run again, with other settings
    assert "made of other frames" in report_of(tmp_path, "cd" * 32)
    assert "fall-" not in report_of(tmp_path, "cd" * 32)
    with pytest.raises(UserError, match="other frames"):
        add_budget(tmp_path, budget)
    path.write_text(path.read_text(encoding="utf-8").replace("-8.", "x8."), encoding="utf-8")
    with pytest.raises(UserError, match="`budget` of run"):
        report_of(tmp_path, "ab" * 32)


def test_a_budget_of_a_row_that_the_folder_lacks_is_refused(tmp_path: Path) -> None:
    report_of(tmp_path, "ab" * 32)
    budget = replace(make_budget(probe_row(), None, calculated), run="latch_accuracy-f60")
    with pytest.raises(UserError, match="no such run"):
        add_budget(tmp_path, budget)


def test_results_may_come_in_any_order() -> None:
    """Runs end in another order than they were asked for when several processes run them."""
    budget = make_budget(probe_row(), None, lambda cases: reversed(list(calculated(cases))))
    assert budget == make_budget(probe_row(), None, calculated)


def test_every_cause_has_a_place_and_says_what_it_is() -> None:
    for cause in causes():
        assert cause.place in ("probe", "axis", "drive", "set")
        assert cause.form in ("", "time", "minus_time", "length", "drawn", "rounding", "sampling")
        assert cause.effect in ("systematic", "random")
        assert (cause.form in ("drawn", "rounding", "sampling")) <= (cause.effect == "random")
        assert cause.meaning
        assert cause.source


def test_one_case_is_asked_for() -> None:
    result = CliRunner().invoke(app, ["budget", str(PLAN), "-k", "feed"])
    assert result.exit_code == 2
    assert "has to name one case" in result.output


SETTINGS = {
    "pre-travel": lambda draw: f"plant:probe.pretravel_um={draw.uniform(0.5, 20):.3f}",
    "trigger": lambda draw: f"plant:probe.trigger_delay_us={draw.uniform(20, 400):.2f}",
    "input": lambda draw: f"drive:servo.input_delay_us={draw.uniform(20, 400):.2f}",
    "filter": lambda draw: f"drive:servo.input_filter_us={draw.uniform(20, 400):.2f}",
    "compensation": lambda draw: f"drive:servo.delay_compensation_us={draw.uniform(20, 400):.2f}",
    "input jitter": lambda draw: f"drive:servo.input_jitter_us={draw.uniform(200, 900):.2f}",
    "dead time": lambda draw: f"set:Z.kenngr.probe_actuation_time_delay={draw.randint(20, 400)}",
}


@pytest.mark.long
def test_of_120_runs_with_one_cause_it_names_the_right_one() -> None:
    """A share is named when it is above an increment; a drawn delay may be smaller than that."""
    draw = random.Random(20)
    short = [
        f"plant:z.position_start_mm={100.6}",
        "plc:V.E.FEED=600",
        "plant:z.kv=40",
        "plant:z.feed_forward=1",
    ]
    run = partial(run_cases, files_of=lambda _: RunFiles())
    right = 0
    for _ in range(120):
        name = draw.choice(list(SETTINGS))
        quiet = [] if name == "input" else ["drive:servo.input_delay_us=0"]
        case = row(*short, *quiet, SETTINGS[name](draw))
        program = case.program.with_name("touch-once.nc")
        case = replace(case, program=program, seed=draw.randint(1, 10**6))
        budget = make_budget(case, None, run)
        share = budget.largest
        right += share is not None and share.cause.cause == name
        total = sum(each.in_turn_um for each in budget.shares) + budget.left_um
        assert total == pytest.approx(budget.error_um, abs=1e-9)
        assert abs(budget.left_um) <= budget.increment_um
        for each in budget.shares:
            if each.expected_um is not None:
                allowed = 0.01 * abs(each.expected_um) + 2e-4
                assert each.in_turn_um == pytest.approx(each.expected_um, abs=allowed), each
    assert right >= 114  # 95 %
