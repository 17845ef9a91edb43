"""`axisrig scenarios`: a log goes on where it ends, options that exclude each other, the smallest
scenario of a finding. No machine runs here, apart from one row.
"""

import csv
import json
import random
from dataclasses import replace
from pathlib import Path

import pytest
from tests.tools.scenario_counts import PAGE, read_rows, rows_of, table_of
from typer.testing import CliRunner

from axisrig.bench.cli.main import app
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.reading.faults import read_time
from axisrig.bench.tools.scenarios.campaign import (
    SAMPLE,
    Tally,
    compared,
    repeated,
    run_scenario,
)
from axisrig.bench.tools.scenarios.drawing import draw_inputs
from axisrig.bench.tools.scenarios.log import ScenarioLog, line_of
from axisrig.bench.tools.scenarios.machines import machines, machines_named, path_of
from axisrig.bench.tools.scenarios.minimise import faults_of, is_same, minimised
from axisrig.bench.tools.scenarios.oracle import DEFECTS, Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario, drawn_kinds, make_scenario
from axisrig.kernel.cosim.fmi.fmu import EdgeMayBeLostError, PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

ROOT = Path(__file__).parents[2]
GOOD = Judgement(Result.GOOD, right=4, frames="f")


def call(*words: str) -> tuple[int, str]:
    found = CliRunner().invoke(app, ["scenarios", *words])
    return found.exit_code, found.output


# --- the log


def test_a_log_goes_on_where_it_ends(tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    for words in (("--count", "1"), ("--count", "2")):
        code, output = call(*words, "--log", str(path))
        assert code == 0, output
    assert [json.loads(line)["number"] for line in path.read_text().splitlines()] == [0, 1, 2]
    assert "3 scenarios" in output  # those of before count too
    code, output = call("--for", "0s", "--log", str(path))
    assert (code, "3 scenarios" in output) == (0, True)


def test_a_log_keeps_machines_and_seeds_apart(tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    found = [(1, "one-axis", 4), (2, "one-axis", 9)]
    path.write_text("".join(line_of(s, Scenario(n, 1, (), "", m), GOOD) for s, m, n in found))
    log = ScenarioLog(path, 1)
    assert (log.first_of("one-axis"), log.first_of("gantry")) == (5, 0)
    assert ScenarioLog(path, 2).first_of("one-axis") == 10
    ((scenario, judgement),) = log.of("one-axis")
    assert (scenario, judgement) == (make_scenario(1, 4), GOOD)


def test_a_line_that_was_not_written_to_its_end_runs_again(tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    line = line_of(1, Scenario(0, 1, ()), GOOD)
    path.write_text(line + line[:30])
    assert ScenarioLog(path, 1).first_of("one-axis") == 1
    assert path.read_text() == line


def test_another_file_is_no_log(tmp_path: Path) -> None:
    path = tmp_path / "plan.csv"
    path.write_text(line_of(1, Scenario(0, 1, ()), GOOD) + "case,title\n")
    with pytest.raises(UserError, match=r"2.*no line of a log of scenarios"):
        ScenarioLog(path, 1)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--machine", "gantri"), "gantry"),
        (("--for", "30"), "30m"),
        (("--for", "30m", "--count", "2"), "exclude each other"),
        (("--log", "x", "--first", "2"), "exclude each other"),
    ],
)
def test_what_cannot_be_is_refused_with_what_is_allowed(words: tuple[str, ...], text: str) -> None:
    code, output = call(*words)
    assert code == 2
    assert text in output


# --- machines and drawing


def test_all_machines_are_there_with_their_files() -> None:
    assert machines_named("all") == list(machines().values())
    assert [row.name for row in machines_named("gantry")] == ["gantry"]
    for row in machines().values():
        assert path_of(row.rig).is_file()
        assert path_of(row.program).is_file()


def test_a_shipped_rig_asks_for_the_folder_of_the_plans(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match="testplans"):
        path_of(machines()["gantry"].rig)


def test_places_are_drawn_as_the_cell_writes_them() -> None:
    cell = "a=5 ;; plc:F={10..20} ;; w={0.10..0.40} {x | y} ;; g={0..100 step 50 off 60 F}"
    for seed in range(20):
        fixed, number, text, far = draw_inputs(cell, random.Random(seed))
        assert fixed == "a=5"
        assert 10 <= int(number.removeprefix("plc:F=")) <= 20
        value, word = text.removeprefix("w=").split()
        assert len(value) == 4
        assert 0.1 <= float(value) <= 0.4
        assert word in ("x", "y")
        assert far == "g=100"  # 0 and 50 are nearer than 60


@pytest.mark.parametrize(
    ("form", "low", "high", "decimals"),
    [("0..1.50", 0.0, 1.5, 2), ("0.5..3", 0.5, 3.0, 1), ("-0.300..0.300", -0.3, 0.3, 3),
     ("-10..10", -10.0, 10.0, 0), ("1.5..1.5000", 1.5, 1.5, 4)],
)  # fmt: skip
def test_a_number_has_as_many_decimals_as_the_finer_end(
    form: str, low: float, high: float, decimals: int
) -> None:
    found = set()
    for seed in range(30):
        (text,) = draw_inputs(f"w={{{form}}}", random.Random(seed))
        value = text.removeprefix("w=")
        assert len(value.partition(".")[2]) == decimals
        assert low <= float(value) <= high
        found.add(value)
    assert (len(found) > 5) is (low < high)


def test_what_is_behind_a_question_mark_is_drawn_with_its_share() -> None:
    found = [draw_inputs("a=1 ?0.25 b=2 ;; c=3", random.Random(seed)) for seed in range(400)]
    with_both = [inputs for inputs in found if inputs == ["a=1", "b=2", "c=3"]]
    assert all(inputs in (["a=1"], ["a=1", "b=2", "c=3"]) for inputs in found)
    assert 60 < len(with_both) < 140


def test_a_place_of_no_form_is_refused() -> None:
    with pytest.raises(UserError, match="no such form"):
        draw_inputs("a={1 to 2}", random.Random(1))


def test_the_first_machine_draws_kinds_of_frames_and_drives_alone() -> None:
    """A kind that is added has the weight 0 there, so that old seeds stay."""
    rows = list(drawn_kinds().values())
    assert [kind.weights["frames"] for kind in rows] == [1] * 15 + [0] * (len(rows) - 15)
    assert make_scenario(1, 0).assignments == (
        "plc:V.E.FEED1=502",
        "plc:V.E.FEED2=1680",
        "plc:V.E.RETRACT=0.132",
        "plant:z.position_start_mm=0.3912",
        "fault:heartbeat_loss=Z p=0.0224 at=124.427ms for=3.297ms",
        "fault:bus_off=Z at=motion",
    )


def test_what_nobody_can_know_hides_the_value() -> None:
    known = replace(make_scenario(1, 0), assignments=("fault:drop=Z.TPDO1",))
    assert known.hidden == frozenset()
    late = replace(known, assignments=("fault:probe_late=probe by=1ms", *known.assignments))
    assert late.hidden == {"value"}
    # What keeps an axis from moving looks like a stop to a control that has its lag alone
    without_force = replace(known, assignments=("fault:plant_input=z.force_limit value=1",))
    assert without_force.hidden == {"found-stop"}


# --- the same scenario in another process


def test_other_frames_in_another_process_are_a_finding() -> None:
    assert compared(GOOD, GOOD) is GOOD
    found = compared(GOOD, replace(GOOD, frames="g"))
    assert (found.result, found.broken) == (Result.BROKEN, ("repeats",))
    tally = Tally()
    tally.add(Scenario(100, 1, ()), found)
    assert "other frames" in tally.table()
    broken_off = compared(GOOD, Judgement(Result.EXCEPTION, note="OSError: no memory"))
    assert "OSError: no memory, no for f" in broken_off.note


@pytest.mark.long
@pytest.mark.parametrize(
    "machine",
    [
        "one-axis",
        "three-axes",
        "gantry",
        "distance-3d",
        "overrides",
        "source-stamp",
        "ethercat-axes",
    ],
)
def test_a_scenario_sends_the_same_frames_in_another_process(machine: str) -> None:
    """One that shares neither memory layout nor hashes of words with this one."""
    scenario = make_scenario(1, SAMPLE - 1, machine)
    judgement = run_scenario(scenario)
    assert judgement.frames
    assert repeated((scenario, judgement)) == (scenario, judgement)


@pytest.mark.long
@pytest.mark.parametrize("machine", list(machines()))
def test_a_machine_without_faults_gives_its_values_and_no_finding(machine: str) -> None:
    drawn = make_scenario(2, 0, machine)
    inputs = tuple(text for text in drawn.assignments if not text.startswith("fault:"))
    judgement = run_scenario(replace(drawn, assignments=inputs))
    assert judgement.result is Result.GOOD, judgement.note
    assert judgement.right >= bool(machines()[machine].source)


ALTERED = "fault:alter=Z.RPDO1"


@pytest.mark.parametrize(
    ("fault", "kind", "has_begun", "hits", "found"),
    [
        (ALTERED, EdgeMayBeLostError, True, 2, Result.NO_TRUTH),
        ("fault:drop=can1.SYNC", EdgeMayBeLostError, True, 1, Result.NO_TRUTH),
        ("fault:bus_off=Z", EdgeMayBeLostError, True, None, Result.NO_TRUTH),
        (ALTERED, PlantError, True, 2, Result.EXCEPTION),
        (ALTERED, EdgeMayBeLostError, False, 0, Result.EXCEPTION),
        (ALTERED, EdgeMayBeLostError, True, 0, Result.EXCEPTION),
        ("fault:alter=Z.TPDO1", EdgeMayBeLostError, True, 2, Result.EXCEPTION),
        ("fault:reset=Z", EdgeMayBeLostError, True, None, Result.EXCEPTION),
        ("", EdgeMayBeLostError, True, None, Result.EXCEPTION),
    ],
)
def test_no_truth_is_an_edge_that_a_jump_of_a_set_position_may_lose_and_nothing_else(
    monkeypatch: pytest.MonkeyPatch,
    fault: str,
    kind: type[PlantError],
    has_begun: bool,
    hits: int | None,
    found: Result,
) -> None:
    """Every other failure of a plant is a finding, also that one without a fault that jumps."""

    def refuse(machine: Machine) -> None:
        for injected in machine.faults:
            injected.begin_ns, injected.hits = MS if has_begun else None, hits
        raise kind("probe", MS, "no such step")

    monkeypatch.setattr(Machine, "run", refuse)
    drawn = make_scenario(1, 0)
    inputs = tuple(text for text in drawn.assignments if not text.startswith("fault:"))
    judgement = run_scenario(replace(drawn, assignments=(*inputs, *([fault] if fault else []))))
    assert judgement.result is found
    assert judgement.note.endswith("no such step")
    assert (judgement.result in DEFECTS) is (found is Result.EXCEPTION)


@pytest.mark.long
def test_an_axis_that_follows_its_demand_exactly_jumps_with_a_turned_bit_of_it() -> None:
    judgement = run_scenario(make_scenario(1, 78, "kinematics"))
    assert judgement.result is Result.NO_TRUTH


def test_a_machine_that_cannot_be_built_is_a_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = make_scenario(1, 0)  # builds the machine once, to see its fault points

    def refuse(*_: object, **__: object) -> None:
        raise PlantError("probe", 0, "its start is outside")

    monkeypatch.setattr(Machine, "__init__", refuse)
    judgement = run_scenario(drawn)
    assert judgement.result is Result.EXCEPTION
    assert judgement.note.endswith("its start is outside")


# --- the smallest scenario

WRONG = Judgement(Result.BROKEN, note="value: run 1", broken=("value",))


def run_with(needed: str, window_us: int) -> "list[Scenario]":
    """Minimise a finding that stays while one fault is there, for at least a window."""
    tried: list[Scenario] = []

    def run(scenario: Scenario) -> Judgement:
        tried.append(scenario)
        for kind, cell in faults_of(scenario):
            if kind == needed:
                words = cell.partition("for=")[2]
                if not words or read_time(words) >= window_us * US:
                    return WRONG
        return GOOD

    given = Scenario(
        3, 1, ("plc:V.E.X=1", "fault:drop=Z.SDO; Z.EMCY", "fault:delay=Z.TPDO1 by=1ms for=8ms")
    )
    smallest, judgement = minimised(given, WRONG, run)
    assert judgement is WRONG
    return [smallest, *tried]


def test_faults_are_dropped_and_windows_shortened_while_the_finding_stays() -> None:
    smallest, *tried = run_with("delay", 1500)
    assert smallest.assignments == ("plc:V.E.X=1", "fault:delay=Z.TPDO1 by=1ms for=2000us")
    assert run_with("delay", 1500)[1:] == tried  # the same way each time
    without_end, *_ = run_with("drop", 100_000)
    assert without_end.assignments == ("plc:V.E.X=1", "fault:drop=Z.EMCY for=128000us")


def test_another_finding_is_not_the_same() -> None:
    assert is_same(WRONG, replace(WRONG, note="value: run 2"))
    assert not is_same(WRONG, replace(WRONG, broken=("value", "rest")))
    assert not is_same(WRONG, GOOD)
    raised = Judgement(Result.EXCEPTION, note="KeyError: 'a'")
    assert is_same(raised, replace(raised, note="KeyError: 'b'"))
    assert not is_same(raised, replace(raised, note="ValueError: 1"))


# --- the page


@pytest.mark.parametrize("table", ["machines.csv", "invariants.csv"])
def test_the_page_has_every_row_of_the_tables(table: str) -> None:
    page = (ROOT / "docs" / "reliability.md").read_text("utf-8")
    folder = ROOT / "bench" / "axisrig" / "bench" / "tools" / "scenarios"
    rows = list(csv.reader((folder / table).read_text("utf-8").splitlines()))[1:]
    for name, what, *_ in rows:
        assert f"| `{name}` | {what} |" in page


def test_the_counts_of_the_page_are_those_of_its_table() -> None:
    """docs/reliability.csv, which `python -m tests.tools.scenario_counts` writes from a log."""
    rows = read_rows()
    page = PAGE.read_text("utf-8")
    assert "\n".join(table_of(rows)) in page
    *each, whole = rows
    assert [row["machine"] for row in each] == list(machines())
    kinds = ("good", "alarm", "no control can know", "no truth", "findings")
    for column in ("run", *kinds):
        assert sum(int(row[column]) for row in each) == int(whole[column])
    for row in rows:
        assert sum(int(row[name]) for name in kinds) == int(row["run"])


def test_a_row_counts_what_a_log_has_of_a_machine() -> None:
    found = [
        (make_scenario(1, 0), GOOD),
        (make_scenario(1, 1), Judgement(Result.ALARM, [5, 900006])),
        (make_scenario(1, 2), Judgement(Result.HANG)),
        (make_scenario(1, 0, "gantry"), Judgement(Result.NO_TRUTH)),
        (make_scenario(1, 0, "source-plc"), Judgement(Result.UNKNOWABLE)),
    ]
    rows = {row["machine"]: row for row in rows_of(1, found, {})}
    assert list(rows) == [*machines(), "all"]
    assert list(rows["one-axis"].values()) == [
        "one-axis", "1", "3", "1", "1", "0", "0", "1", "900006 (1)",
    ]  # fmt: skip
    assert list(rows["all"].values())[2:8] == ["5", "1", "1", "1", "1", "1"]
    assert rows["homing"]["run"] == "0"


@pytest.mark.long
def test_a_machine_that_a_log_does_not_have_keeps_its_row() -> None:
    before = [(make_scenario(1, number, "homing"), GOOD) for number in range(3)]
    kept = {row["machine"]: row for row in rows_of(1, before, {})}
    rows = {
        row["machine"]: row
        for row in rows_of(2, [(make_scenario(2, 0), Judgement(Result.HANG))], kept)
    }
    assert rows["homing"] == kept["homing"]
    assert [rows["one-axis"][key] for key in ("seed", "run", "findings")] == ["2", "1", "1"]
    assert [rows["all"][key] for key in ("run", "good", "findings")] == ["4", "3", "1"]
