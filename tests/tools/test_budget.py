"""The budget of a measured value: shares, their sum, the cause that is named."""

import base64
import csv
import gzip
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from tests.tools.near import near
from typer.testing import CliRunner

from axisrig import fmus
from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.cli.main import app
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.tools.budget.budget import CYCLES, Share, make_budget
from axisrig.bench.tools.budget.causes import active_causes, causes
from axisrig.bench.tools.budget.closed_forms import BOUNCE_MS, STIFFNESS_N_M, STRIBECK_M_S
from axisrig.bench.tools.budget.combining import Runs as CausesOff
from axisrig.bench.tools.budget.combining import combined, groups
from axisrig.bench.tools.budget.observed_run import METRICS, Seen, Track
from axisrig.bench.tools.budget.words import budget_lines, budget_table
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS
from axisrig.reports.build import build_report
from axisrig.results.budget.page import add_budget, write_budget

PLAN = Path(__file__).parents[2] / "testplans" / "latch_accuracy.csv"
SPEED_MM_S = -10.0
FORMS = (
    *("time", "minus_time", "length", "edge", "first", "drift", "drawn", "rest", "source"),
    *("rounding", "sampling", "jitter", "twist", "viscous", "half", "led_back"),
    *("seat", "contact", "noise", "handed", "pdo", "motion"),
    *("assumed", "line", "drifted"),
)
PLACES = ("probe", "axis", "drive", "set", "plc", "line", "variable", "fault", "motion")
PROBE = {"pretravel_um": "8", "trigger_delay_us": "120"}


def row(*texts: str) -> Case:
    plan = read_plan(PLAN).with_inputs([parse_assignment(text) for text in texts])
    return only(plan.cases, "f600")


def probe_row() -> Case:
    return row(*(f"plant:probe.{name}={value}" for name, value in PROBE.items()))


def yielded(case: Case, *values: float | None) -> CaseResult:
    """A result with error um, velocity mm/s, latch ms, source error um, as they are asked for."""
    there = dict(zip(METRICS, values, strict=True))
    checks = [judge(check, there[check.name]) for check in case.checks]
    return CaseResult(case, Verdict.PASS, checks)


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
        yield yielded(case, error_um, SPEED_MM_S, late_us / 1e3, None)


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


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("in_turn_um", "expected_um", "bound_um", "off_um"),
    [
        (5.0, 5.0, None, None),
        (5.04, 5.0, None, None),  # within 1 %
        (5.12, 5.0, None, 0.12),  # beyond 1 %, and beyond an increment: not both together
        (100.9, 100.0, None, None),
        (101.05, 100.0, None, 1.05),
        (5.2, 5.0, None, 0.2),
        (0.09, 0.0, None, None),  # within an increment
        (0.2, 0.0, None, 0.2),
        (3.0, None, None, None),  # nobody knows how large it is
        (2.9, None, 3.0, None),
        (3.05, None, 3.0, None),
        (3.4, None, 3.0, 0.4),
        (3.4, 0.0, 3.0, 0.4),  # a bound goes before a closed form
    ],
)
def test_a_share_differs_from_its_closed_form_or_its_bound_in_either_direction(
    sign: int,
    in_turn_um: float,
    expected_um: float | None,
    bound_um: float | None,
    off_um: float | None,
) -> None:
    """A bound is one of the amount: how far it is beyond it has no sign."""
    form = None if expected_um is None else sign * expected_um
    found = Share(CYCLES, "", 9.0, sign * in_turn_um, form, bound_um).differs_um(0.1)
    if off_um is None:
        assert found is None
    else:
        assert found == pytest.approx(off_um if bound_um is not None else sign * off_um)


def test_each_run_is_made_once() -> None:
    seen: list[str] = []

    def counted(cases: Sequence[Case]) -> Iterator[CaseResult]:
        seen.extend(case.run for case in cases)
        return calculated(cases)

    make_budget(probe_row(), None, counted)
    # Whole, four alone, three more in turn; of three that are no rounding the last two and one
    assert len(seen) == len(set(seen)) == 1 + 4 + 3 + 2


def multiplied(cases: Sequence[Case]) -> Iterator[CaseResult]:
    """Neither of two causes has a share without the other."""
    for case in cases:
        first, second = (float(case.inputs.get(f"plant:probe.{name}", 0)) for name in PROBE)
        yield yielded(case, first * second / 100, SPEED_MM_S, 0.0, None)


def test_causes_that_act_on_each_other_have_shares_over_all_orders() -> None:
    budget = make_budget(probe_row(), None, multiplied)
    assert [share.cause.cause for share in budget.interacting] == ["pre-travel", "trigger"]
    # Two causes, two orders: each adds 0 where it comes first and 9.6 where it comes last
    assert [share.combined_um for share in budget.interacting] == [pytest.approx(4.8)] * 2
    total = sum(share.combined_um or 0.0 for share in budget.shares) + budget.left_um
    assert total == pytest.approx(budget.error_um, abs=1e-9)
    assert "act on each other" in budget_lines(budget)[-1]


def causes_off(
    count: int, of_on: Callable[[set[int]], float], made: set[frozenset[int]] | None = None
) -> CausesOff:
    """Runs whose error is a function of the causes that are on."""
    made = set() if made is None else made
    return CausesOff(count, made.update, lambda off: of_on(set(range(count)) - set(off)))


def test_at_most_so_many_causes_are_combined_and_the_sum_closes() -> None:
    made: set[frozenset[int]] = set()

    def error_um(on: set[int]) -> float:
        return len(on) ** 2 + 3.0 * (0 in on)

    found = combined(causes_off(10, error_um, made), 1e-6, 256)
    assert len(made) <= 2**8 + 6 * 10
    assert sum(found.shares_um.values()) == pytest.approx(error_um(set(range(10))))
    assert len(found.left_out) == 2
    # The others come after the eight, which have alike shares: 64 um of eight
    alike = [found.shares_um[place] for place in range(1, 10) if place not in found.left_out]
    assert alike == [pytest.approx(8.0)] * len(alike)
    few = combined(causes_off(10, error_um), 1e-6, 1)
    assert few.left_out == frozenset(range(10))
    assert few.shares_um[9] == pytest.approx(100.0 - 81.0)  # in turn
    assert sum(few.shares_um.values()) == pytest.approx(error_um(set(range(10))))


def test_causes_that_do_not_act_on_each_other_are_in_groups_of_their_own() -> None:
    """1 and 2 multiply; 4 and 5 need each other; 0 and 3 add up."""

    def error_um(on: set[int]) -> float:
        return 1.0 * (0 in on) + 4.0 * ({1, 2} <= on) + 2.0 * (3 in on) + 6.0 * ({4, 5} <= on)

    made: set[frozenset[int]] = set()
    runs = causes_off(6, error_um, made)
    assert groups(runs, 1e-6) == [[0], [1, 2], [3], [4, 5]]
    assert len(made) <= 2 * 6
    found = combined(runs, 1e-6)
    assert found.interacting == {1, 2, 4, 5}
    assert [found.shares_um[place] for place in range(6)] == [1.0, 2.0, 2.0, 2.0, 3.0, 3.0]
    assert len(made) <= 2 * 6 + 4  # all 2^6 are not needed


def test_what_is_not_combined_is_said() -> None:
    budget = make_budget(probe_row(), None, multiplied, 1)
    assert budget.not_combined == ("pre-travel", "trigger")
    assert budget_lines(budget)[-1].endswith("--combinations allows more runs: pre-travel, trigger")
    assert make_budget(probe_row(), None, multiplied).not_combined == ()


def test_a_rest_above_an_increment_is_said() -> None:
    def with_rest(cases: Sequence[Case]) -> Iterator[CaseResult]:
        for case in cases:
            yield yielded(case, 0.5, SPEED_MM_S, 0.0, None)

    budget = make_budget(probe_row(), None, with_rest)
    assert not budget.is_explained
    assert any(line.startswith("not explained: +0.5000 um") for line in budget_lines(budget))
    assert str(budget_table(budget)[-1]["meaning"]).startswith("not explained: +0.5000 um")
    # No share has what its closed form has
    assert [share.cause.cause for share in budget.differing] == ["pre-travel", "trigger", "input"]
    assert "differs by +8.0000" in "\n".join(budget_lines(budget))
    good = make_budget(probe_row(), None, calculated)
    assert good.is_explained
    assert good.differing == ()
    assert "not explained" not in "\n".join(budget_lines(good))


def plc_row(name: str) -> Case:
    return only(read_plan(PLAN.with_name("plc_sources.csv")).cases, name)


def test_a_value_of_a_plc_has_the_causes_of_its_chain_and_none_of_the_latch() -> None:
    def at_cycle(cases: Sequence[Case]) -> Iterator[CaseResult]:
        """The PLC is 1 ms late, not with its shortest cycle; the CNC gives what was 0.4 ms ago."""
        for case in cases:
            late_ms = -0.4 + (case.inputs.get("plc:period_us") != "50")
            yield yielded(case, SPEED_MM_S * late_ms, SPEED_MM_S, None, 0.0)

    budget = make_budget(plc_row("plc-f600"), None, at_cycle)
    found = {share.cause.cause: share for share in budget.shares}
    assert list(found) == ["PLC cycle", "encoder", "CNC cycle"]
    assert found["PLC cycle"].in_turn_um == pytest.approx(-10.0)
    assert found["PLC cycle"].expected_um == pytest.approx(-10.0)
    assert found["CNC cycle"].in_turn_um == pytest.approx(4.0)
    assert budget.left_um == pytest.approx(0.0)
    assert budget.is_explained


@pytest.mark.long
def test_a_clock_is_off_where_the_cnc_knows_it() -> None:
    def shares(name: str) -> list[str]:
        case = plc_row(name)
        return [each.cause.cause for each in active_causes(case, settings_of(case), "Z", False)]

    assert "clock drift" in shares("stamp-drift")
    assert "clock drift" not in shares("stamp-drift-known")
    assert "clock offset" in shares("stamp-clock-behind")
    assert "clock offset" not in shares("stamp-clock-known")
    assert "stamp jitter" in shares("stamp-jitter")
    assert "stamp resolution" in shares("stamp-resolution")
    assert "terminal filter" in shares("plc-filter")
    assert "terminal cycle" in shares("plc-terminal-slower")
    assert "PDO" in shares("plc-pdo-missing")


def test_the_way_in_a_ramp_has_its_second_order() -> None:
    """x = v t + a t^2/2 with SYNCs every 1 ms."""
    v, a = -10.0, 2000.0
    times = [n * MS for n in range(5)]
    places = [100 + v * n * 1e-3 + a * (n * 1e-3) ** 2 / 2 for n in range(5)]
    track = Track(times, places, [v + a * n * 1e-3 for n in range(5)], 0, 1, 0.0)
    seen = Seen(0.0, v, 0.5, None, track)
    want_um = 1e3 * (v * 2.5e-3 + a * ((3e-3) ** 2 - (0.5e-3) ** 2) / 2)
    assert seen.moved_um(0.5, 3.0) == pytest.approx(want_um, abs=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("plan", "name", "shares"),
    [
        # v T of a PLC cycle at most, and the actual value of the SYNC before the cycle of the CNC
        ("plc_sources", "plc-f600", ("PLC cycle", "CNC cycle")),
        # v times 250 us: 12.5 um at 50 mm/s
        ("ethercat", "sampling-assumed", ("assumed sampling",)),
        # v times the 10 us that are not written to the clock of the terminal
        ("ethercat", "terminal-delay-missing", ("line delay",)),
        # v t: 100 ppm of the time since the start
        ("plc_sources", "stamp-drift", ("clock drift",)),
        # v (1.5 ms + 0.5 ms): the level rests after the last of the edges
        ("probe_reality", "bounce-filter", ("bounce", "filter")),
        # F(v)/k of dry and viscous friction, half of the backlash
        (
            "probe_reality",
            "friction-20um-300",
            ("screw friction", "viscous friction", "backlash"),
        ),
    ],
)
def test_the_budget_of_a_run_closes(plan: str, name: str, shares: tuple[str, ...]) -> None:
    case = only(read_plan(PLAN.with_name(f"{plan}.csv")).cases, name)
    case = near(case) if plan == "plc_sources" else case
    budget = make_budget(case, None, partial(run_cases, files_of=lambda _: RunFiles()))
    assert set(shares) <= {share.cause.cause for share in budget.shares}
    assert budget.differing == ()
    assert abs(budget.left_um) <= budget.increment_um
    for sizes in (
        [share.in_turn_um for share in budget.shares],
        [share.combined_um or 0.0 for share in budget.shares if budget.interacting],
    ):
        if sizes:
            assert sum(sizes) + budget.left_um == pytest.approx(budget.error_um, abs=1e-9)


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


@pytest.mark.long
def test_a_budget_in_a_results_folder_is_in_the_card_of_its_run(tmp_path: Path) -> None:
    budget = replace(make_budget(probe_row(), None, calculated), frame_log_sha256="ab" * 32)
    assert "fall" not in report_of(tmp_path, "ab" * 32)
    path = add_budget(tmp_path, budget)
    assert path == tmp_path / "budgets" / "latch_accuracy-f600.csv"
    shown = report_of(tmp_path, "ab" * 32)
    assert shown.count('<rect class=\\"fall-') == len(budget.shares) + 2
    assert "pre-travel" in shown
    assert "systematic, pre-travel (ISO 230-10)" in shown
    # The row was run again, with other settings
    assert "made of other frames" in report_of(tmp_path, "cd" * 32)
    assert "fall-" not in report_of(tmp_path, "cd" * 32)
    with pytest.raises(UserError, match="other frames"):
        add_budget(tmp_path, budget)
    path.write_text(path.read_text(encoding="utf-8").replace("-8.", "x8."), encoding="utf-8")
    with pytest.raises(UserError, match="`budget` of run"):
        report_of(tmp_path, "ab" * 32)


@pytest.mark.long
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
        assert cause.place in PLACES
        assert cause.needs in ("", "drive", "input", "plc", "line", "terminal", "external")
        assert cause.form in FORMS
        assert cause.effect in ("systematic", "random")
        assert (cause.form in ("rounding", "sampling", "jitter")) <= (cause.effect == "random")
        assert cause.form, "each has a closed form or a bound"
        assert len(cause.key.split()) == len(cause.off.split())
        assert cause.meaning
        assert cause.source


def test_defaults_are_those_of_the_models() -> None:
    """A start value that nobody gives is the default of the model."""
    models = Path(fmus.__file__).parent / "AxisRig"
    text = "".join(
        (models / f"{name}.mo").read_text(encoding="utf-8")
        for name in (
            *("Drives/PartialAxis", "Drives/ServoAxis", "Drives/ScrewAxis"),
            *("Mechanics/LuGreFriction", "Sensors/WorkpieceProbe"),
        )
    )
    for cause in causes():
        keys, defaults = cause.key.split(), cause.default.split()
        for key, default in zip(keys, defaults, strict=bool(defaults)):
            name = key.rpartition(".")[2]
            assert re.search(rf" {name}(\(min = 0\))? = {default}\b", text), key
    for name, value in (
        ("screw_stiffness", f"{STIFFNESS_N_M:g}"),
        ("stribeck", f"{STRIBECK_M_S:g}"),
        ("bounce_time", f"{BOUNCE_MS * 1e-3:g}"),
    ):
        found = re.search(rf" {name}(\(min = 1e-9\))? = (\d\S*)", text)
        assert found is not None
        assert float(found[2].rstrip(";,")) == float(value), name


def test_one_case_is_asked_for() -> None:
    result = CliRunner().invoke(app, ["budget", str(PLAN), "-k", "feed"])
    assert result.exit_code == 2
    assert "has to name one case" in result.output
