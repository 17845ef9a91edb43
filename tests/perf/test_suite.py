"""The suite of measures: its table, its turns, and what it says of them; with clocks that count."""

import csv
import json
import math
import re
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from tests.perf import measures as suite
from tests.perf import yardsticks
from tests.perf.measures import Measure, read_suite, run_suite, selected
from tests.perf.suite import report
from tests.perf.suite_text import (
    HEADER,
    gains,
    markdown,
    reach_of,
    read_suite_result,
    row_of,
    show_gains,
    show_suite,
)

from axisrig.bench.plan.plan import read_plan
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.bench.tools.perf.gains import MORE_IS_BETTER
from axisrig.bench.tools.perf.gains import gains as row_gains
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.kernel.errors import UserError

ROOT = Path(__file__).parents[2]
PLANS = ROOT / "testplans"
MS = 1_000_000


@dataclass
class Counting:
    """A clock that goes on by a step whenever it is read; other processes get their own."""

    step_ns: int
    now_ns: int = 0

    def __call__(self) -> int:
        self.now_ns += self.step_ns
        return self.now_ns


CLOCKS = Clocks(Counting(7 * MS), Counting(MS))


def a_measure(name: str, kind: str = "fake", **cells: Any) -> Measure:
    given = {
        "plan": "", "row": "", "better": "more", "reach": 10.0, "reach_interpreted": None,
        "unit": "times", "turns": None, "note": "why",
    }  # fmt: skip
    return Measure(name, kind, **given | cells)


class Fake:
    """Gives 1, 2, 3 ... and notes who was asked."""

    asked: list[str] = []  # noqa: RUF012

    def __init__(self, plan: str, _row: str, _place: yardsticks.Place) -> None:
        self.name, self.numbers = plan, count(1)

    def sample(self) -> yardsticks.Sample:
        self.asked.append(self.name)
        return {"value": float(next(self.numbers)), "text": "same", "more": 4.0}


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Let the kind `fake` count; gives the plans in the order in which they were asked."""
    monkeypatch.setattr(Fake, "asked", [])
    kinds = {**yardsticks.KINDS, "fake": Fake}
    monkeypatch.setattr(suite, "KINDS", kinds)
    return Fake.asked


def run(*measures: Measure, repeats: int = 3) -> dict[str, Any]:
    return run_suite(measures, PLANS, repeats, CLOCKS, lambda *_: None)


# ---- the table


@pytest.mark.long
def test_the_table_names_rows_that_there_are() -> None:
    for measure in read_suite():
        if measure.plan.endswith(".csv"):
            cases = {case.case for case in read_plan(PLANS / measure.plan).cases}
            names = [word for word in measure.row.split() if "=" not in word]
            assert names or measure.kind == "workers", measure  # of these: every row of the plan
            assert set(names) <= cases, measure
        elif measure.kind == "kept_run":
            assert measure.plan in machines(), measure
        else:
            words = measure.row.replace(":", " ").split()
            files = [measure.plan, *words] if measure.plan else []
            assert all((PLANS / name).is_file() for name in files), measure


def test_the_table_has_what_is_to_be_reached() -> None:
    """Numbers as they were set, in the order of their aims."""
    found = [(m.kind, m.better, m.reach, m.reach_interpreted) for m in read_suite()]
    assert found == [
        ("run", "more", 20.0, 12.0),
        ("run", "more", 15.0, None),
        ("run", "more", 10.0, None),
        ("run", "more", 10.0, None),
        ("run", "more", 6.0, None),
        ("pair", "less", 0.5, None),
        ("kernel_cycle", "less", 200.0, None),
        ("next_run", "less", 5.0, None),
        ("kept_run", "less", 5.0, None),
        ("workers", "more", 1.9, None),
        ("workers", "more", 1.9, None),
        ("check", "less", 0.8, None),
        ("help", "less", 0.15, None),
        ("nc_check", "less", 0.6, None),
        ("memory", "less", 1.0, None),
        ("named", "less", 60.0, None),
        ("named", "less", 300.0, None),
        ("named", "less", 25.0, None),
    ]


def test_names_of_measures_differ() -> None:
    names = [measure.name for measure in read_suite()]
    assert len(set(names)) == len(names)


def test_the_row_of_three_axes_has_them_on_two_buses_at_2_ms() -> None:
    (measure,) = selected(read_suite(), "three axes")
    (case,) = [c for c in read_plan(PLANS / measure.plan).cases if c.case == measure.row]
    assert case.rig.name == "probe-xyz-2ms.toml"


def test_measures_are_chosen_by_their_name_or_kind() -> None:
    measures = read_suite()
    assert selected(measures, None) == measures
    assert [m.kind for m in selected(measures, "help")] == ["help"]
    assert len(selected(measures, "distance control")) == 2
    with pytest.raises(UserError, match="no such measure"):
        selected(measures, "moon")


def test_a_wrong_kind_in_the_table_is_a_defect(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = suite.TABLE.read_text(encoding="utf-8").replace(",help,", ",moon,")
    (tmp_path / "suite.csv").write_text(text, encoding="utf-8")
    monkeypatch.setattr(suite, "TABLE", tmp_path / "suite.csv")
    with pytest.raises(ValueError, match="moon"):
        read_suite()


# ---- turns


def test_measures_take_turns_and_the_median_counts(fake: list[str]) -> None:
    measures = a_measure("one", plan="a"), a_measure("two", plan="b", turns=2)
    result = run(*measures, repeats=3)
    assert fake == ["a", "b", "a", "b", "a"]
    one, two = result["suite"]
    assert (one["value"], one["least"], one["most"], one["samples"]) == (2.0, 1.0, 3.0, 3)
    assert (two["value"], two["samples"]) == (1.5, 2)
    assert (one["text"], one["more"]) == ("same", 4.0)
    assert result["repeats"] == 3


def test_progress_says_what_comes_next(fake: list[str]) -> None:
    said: list[tuple[int, int, str]] = []
    measures = (a_measure("one"), a_measure("two"))
    run_suite(measures, PLANS, 1, CLOCKS, lambda *what: said.append(what))
    assert said == [(0, 2, "one"), (1, 2, "two"), (2, 2, "")]
    assert len(fake) == 2


def test_what_is_only_named_is_not_measured(fake: list[str]) -> None:
    (found,) = run(a_measure("make test", "named", note="time make test"))["suite"]
    assert (found["value"], found["samples"], found["is_reached"]) == (None, 0, None)
    assert fake == []


def test_frames_that_differ_between_two_samples_are_an_error(
    fake: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    texts = iter("aab")
    monkeypatch.setattr(Fake, "sample", lambda _self: {"value": 1.0, "hash": next(texts)})
    with pytest.raises(UserError, match="hash is not the same in every run"):
        run(a_measure("one"))
    assert fake == []


@pytest.mark.parametrize(
    ("value", "cells", "is_compiled", "reached"),
    [
        (20.0, {"reach": 20.0}, True, True),
        (19.9, {"reach": 20.0}, True, False),
        (15.0, {"reach": 20.0, "reach_interpreted": 12.0}, False, True),
        (15.0, {"reach": 20.0, "reach_interpreted": 12.0}, True, False),
        (99.0, {"reach": 20.0}, False, None),
        (0.8, {"reach": 0.8, "better": "less"}, True, True),
        (0.9, {"reach": 0.8, "better": "less"}, True, False),
    ],
)
def test_a_number_holds_for_the_compiled_build_unless_there_are_two(
    value: float, cells: dict[str, Any], is_compiled: bool, reached: bool | None
) -> None:
    assert a_measure("one", **cells).is_reached(value, is_compiled) is reached


# ---- the kinds


def measured(kind: str, plan: str = "", row: str = "") -> dict[str, Any]:
    found: dict[str, Any] = run(a_measure("it", kind, plan=plan, row=row), repeats=1)["suite"][0]
    return found


@pytest.mark.long
def test_a_run_is_timed_with_its_files_and_its_frames() -> None:
    found = measured("run", "latch_accuracy.csv", "actuated")
    assert found["value"] == pytest.approx(found["simulated_s"] / found["cpu_s"])
    # The clock goes on by 1 ms whenever it is read: run, its wall time twice, its loop twice, its
    # folder twice, end
    assert found["cpu_s"] == pytest.approx(0.007)
    assert re.fullmatch("[0-9a-f]{64}", found["frame_log_sha256"])


def test_beyond_the_simulation_is_everything_but_its_loop() -> None:
    found = measured("next_run", "latch_accuracy.csv", "actuated")
    assert found["value"] == found["beyond_simulation_ms"]
    # One tick for the check, seven for the run without the one of the loop
    assert found["value"] == pytest.approx(7.0)
    # Its folder takes one to open, and one to close
    assert found["next_row_ms"] == pytest.approx(5.0)


def test_rows_of_a_plan_are_checked_as_a_plan_of_their_own(tmp_path: Path) -> None:
    place = yardsticks.Place(PLANS, tmp_path, CLOCKS)
    yardsticks.check_of_rows("latch_accuracy.csv", "f60 f150", place)
    plan = read_plan(tmp_path / "latch_accuracy.csv")
    assert [case.case for case in plan.cases] == ["f60", "f150"]
    assert {case.rig for case in plan.cases} == {(PLANS / "rigs/probe-z.toml").resolve()}


@pytest.mark.long
def test_a_command_is_timed_in_a_process_and_must_succeed(tmp_path: Path) -> None:
    place = yardsticks.Place(PLANS, tmp_path, CLOCKS)
    assert measured("help")["value"] == pytest.approx(0.001)
    with pytest.raises(UserError, match="a command fails"):
        yardsticks.Command(["moon"], place).sample()


@pytest.mark.long
def test_two_workers_are_set_against_one() -> None:
    found = measured("workers", "latch_accuracy.csv", "actuated not-released")
    assert found["value"] == pytest.approx(found["one_wall_s"] / found["two_wall_s"])
    assert 0.0 < found["apart"] < 10.0
    assert found["by_cpu"] == pytest.approx(2 * found["one_cpu_s"] / found["two_cpu_s"])
    with pytest.raises(UserError, match="rows are missing"):
        measured("workers", "latch_accuracy.csv", "actuated moon")


@pytest.mark.long
def test_memory_is_that_of_a_longer_run_over_a_short_one() -> None:
    feeds = "plc:V.E.FEED=3000 plc:V.E.FEED=600"
    found = measured("memory", "latch_accuracy.csv", f"f600 {feeds}")
    seconds = found["long_simulated_s"] - found["short_simulated_s"]
    grown_mb = found["long_peak_mb"] - found["short_peak_mb"]
    assert seconds > 0.5
    assert min(found["short_peak_mb"], found["long_peak_mb"]) > 20.0
    assert found["value"] == pytest.approx(60 * grown_mb / seconds)
    assert math.isfinite(found["loop_mb_min"])
    with pytest.raises(UserError, match="no such case"):
        measured("memory", "latch_accuracy.csv", f"moon {feeds}")


# ---- what it says


def a_result(value: float | None = 5.0, **more: Any) -> dict[str, Any]:
    entry = {
        **a_measure("one", "run", plan="p.csv", row="a", reach_interpreted=6.0)._asdict(),
        "measure": "one", "value": value, "least": 4.0, "most": 6.0, "is_reached": False,
        "frame_log_sha256": "f0",
    }  # fmt: skip
    whole = {
        "compiled": False, "sources_sha256": "5e", "python": "3.11.2", "machine": "x86_64",
        "cores": 2, "load_1min": 1.8, "has_two_idle_cores": False, "repeats": 9, "suite": [entry],
    }  # fmt: skip
    return whole | more


def test_the_table_shows_number_and_reach() -> None:
    text = show_suite(a_result())
    assert "one      `p.csv` a  10 / 6 times  5.0 (4.0 to 6.0)  no" in text
    assert "axisrig interpreted, sources 5e; Python 3.11.2" in text
    assert "not two idle cores" in text
    assert "not two idle cores" not in show_suite(a_result(has_two_idle_cores=True))
    assert "not here: why" in show_suite(a_result(None))
    assert "`-`: the number holds for the compiled build" not in text
    only_compiled = a_result()
    only_compiled["suite"][0] |= {"reach_interpreted": None, "is_reached": None}
    assert "`-`: the number holds for the compiled build" in show_suite(only_compiled)


def test_the_page_gets_the_same_table() -> None:
    lines = markdown(a_result()).splitlines()
    assert lines[:3] == [
        "| measure | row | reach | measured | reached |",
        "|---|---|---|---|---|",
        "| one | `p.csv` a | 10 / 6 times | 5.0 (4.0 to 6.0) | no |",
    ]


def test_the_page_has_the_rows_of_the_table() -> None:
    """Every table of the page between the marks; numbers that were measured may be old."""
    page = (ROOT / "docs/performance.md").read_text(encoding="utf-8")
    tables = re.findall(r"<!-- suite: begin -->\n(.*?)<!-- suite: end -->", page, re.DOTALL)
    assert tables
    cells = ("measure", *Measure._fields[1:])
    entries = [dict(zip(cells, measure, strict=True)) for measure in read_suite()]
    wanted = [(e["measure"], row_of(e), reach_of(e)) for e in entries]
    for table in tables:
        rows = [
            tuple(cell.strip() for cell in line.strip("|").split("|"))
            for line in table.splitlines()
            if line.startswith("|")
        ]
        assert rows[0] == HEADER
        assert [row[:3] for row in rows[2:]] == wanted


def test_gains_are_above_1_when_it_is_better() -> None:
    before, now = a_result(5.0), a_result(10.0)
    assert gains(now, before) == {"one": 2.0}
    now["suite"][0]["better"] = "less"
    assert gains(now, before) == {"one": 0.5}
    assert gains(a_result(None), before) == {"one": None}
    other = a_result(10.0)
    other["suite"][0]["frame_log_sha256"] = "0f"
    assert "frames differ: one" in show_gains(other, before)
    assert "frames differ" not in show_gains(a_result(10.0), before)


def test_a_row_is_set_against_the_same_row() -> None:
    row = {"case": "a", "real_time_factor": 9.0, "cpu_s": 0.3, "frame_log_sha256": "f0"}
    now = row | {"real_time_factor": 18.0, "cpu_s": 0.1, "beyond_simulation_ms": 5.0}
    assert row_gains(now, row) == {
        "real_time_factor": 2.0,
        "cpu_factor": None,
        "cpu_s": pytest.approx(3.0),
        "beyond_simulation_ms": None,
    }
    with pytest.raises(UserError, match="not the same row"):
        row_gains(now, row | {"case": "b"})


def test_more_time_is_a_loss_and_more_simulated_time_a_gain() -> None:
    """Each number is three times as large as before."""
    before = dict.fromkeys(MORE_IS_BETTER, 2.0) | {"case": "a"}
    now = dict.fromkeys(MORE_IS_BETTER, 6.0) | {"case": "a"}
    faster = {"real_time_factor", "cpu_factor"}
    for name, found in row_gains(now, before).items():
        assert found == pytest.approx(3.0 if name in faster else 1 / 3), name
    assert row_gains(now, before).keys() == faster | {"cpu_s", "beyond_simulation_ms"}


def test_what_is_no_result_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "before.json"
    with pytest.raises(UserError, match="no result of the suite"):
        read_suite_result(file)
    for text in ("{", "[]", "{}"):
        file.write_text(text, encoding="utf-8")
        with pytest.raises(UserError, match="no result of the suite"):
            read_suite_result(file)
    file.write_text(json.dumps(a_result()), encoding="utf-8")
    assert read_suite_result(file) == a_result()


@pytest.mark.long
def test_the_command_prints_a_table_an_object_or_a_page(tmp_path: Path) -> None:
    words = ["-k", "help", "--repeats", "1", "--plans", str(PLANS)]
    out = report([*words, "--json"])
    found = json.loads(out)
    assert [entry["kind"] for entry in found["suite"]] == ["help"]
    before = tmp_path / "before.json"
    before.write_text(out, encoding="utf-8")
    out = report([*words, "--against", str(before)])
    assert out.startswith("measure ")
    assert "axisrig --help" in out.split("against the file")[1]
    assert report([*words, "--markdown"]).startswith("| measure | row | reach |")
    with pytest.raises(UserError, match="no such measure"):
        report(["-k", "moon"])


@pytest.mark.long
def test_a_step_of_the_axis_fmu_is_set_beside_c() -> None:
    found = json.loads(report(["--fmu", "--json", "--repeats", "1"]))
    both = found["c_loop_us"] + found["call_us"]
    assert found["ratio"] == pytest.approx(found["slave_us"] / both)


@pytest.mark.long
def test_nc_text_and_frames_are_timed_by_themselves() -> None:
    found = json.loads(report(["--parse", "--json", "--repeats", "1"]))
    assert all(found[name]["bytes"] >= 1_000_000 for name in ("moves", "mixed"))
    assert found["moves"]["blocks"] > 20_000
    found = json.loads(report(["--bus", "--json", "--repeats", "1"]))
    ratio = found["segment_frames_s"] / found["virtual_frames_s"]
    assert found["segment_ratio"] == pytest.approx(ratio)
    ours = found["pack_us"] + found["unpack_us"]
    assert found["codec_frames_s"] == pytest.approx(1e6 / ours)


def test_the_table_is_read_as_it_is_written() -> None:
    with suite.TABLE.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["measure"] for row in rows] == [measure.name for measure in read_suite()]
    assert all(row["note"] for row in rows)


@pytest.mark.long
def test_the_kernel_of_five_axes_is_timed_beside_three(tmp_path: Path) -> None:
    """Clocks that go on by 1 ms whenever they are read: a cycle reads them twice."""
    (measure,) = selected(read_suite(), "five axes")
    place = yardsticks.Place(PLANS, tmp_path, CLOCKS)
    made = yardsticks.KINDS[measure.kind]
    assert made is not None
    sample = made(measure.plan, measure.row, place).sample()
    assert sample["value"] == sample["beside_us"] == 7000.0
