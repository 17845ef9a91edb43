"""A run that is broken off leaves its facts and series until then, with the reason; never green."""

import csv
from collections.abc import Callable, Sequence
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from cli_plan import HEADER
from tests.reports.pages import whole

from axisrig.bench.machine import kept_fmus
from axisrig.bench.record.facts import Facts, read_run
from axisrig.kernel.cosim.fmi.steps import StepsInARow
from axisrig.kernel.time.clock import MS

Call = Callable[..., tuple[int, str, str]]
CHECKED = f"{HEADER},plc:limit_s,check:latch_error_um:Z"


def write(place: Path, limit_s: str) -> str:
    row = f"a,part.nc,rig.toml,3000,,,{limit_s},<= 1"
    (place / "plan.csv").write_text(f"{CHECKED}\n{row}\n", encoding="utf-8")
    return "plan.csv"


def left(place: Path) -> tuple[Facts, int]:
    """Facts of the run, and the last instant of its series."""
    facts = read_run(place / "out" / "runs" / "plan-a.json").facts
    assert facts is not None
    times = pq.read_table(place / "out" / "traces" / "plan-a.parquet").column("time_ns")
    return facts, times[-1].as_py()


def checks(folder: Path) -> list[tuple[str, str, str]]:
    with (folder / "results.csv").open(encoding="utf-8", newline="") as file:
        return [(row["verdict"], row["value"], row["note"]) for row in csv.DictReader(file)]


@pytest.mark.long
def test_a_program_that_does_not_end_in_its_time(place: Path, axisrig: Call) -> None:
    """All that there is until 200 ms; who reads the page finds why."""
    reason = "the program did not end within 0.2 s of simulated time (plc:limit_s)"
    code, said, _ = axisrig("run", write(place, "0.2"), "-o", "out")
    assert code == 4
    assert reason in said.replace("\n", " ")
    facts, last_ns = left(place)
    assert facts.unfinished.startswith(reason)
    assert 198 * MS < last_ns <= 200 * MS
    assert facts.sim_ns == 200 * MS
    assert [state.state for state in facts.axes["Z"].states][-1] == "OPERATION_ENABLED"
    assert facts.plants["z"].values
    found = checks(place / "out")
    assert {(verdict, value) for verdict, value, _ in found} == {("error", "")}
    assert all(note.startswith(reason) for _, _, note in found)
    page = whole(place / "out" / "report.html")
    assert reason in page
    # Judged again it is no better: nothing judges a part of a run
    code, _, _ = axisrig("judge", "out", "--plan", "plan.csv")
    assert code == 4
    assert checks(place / "out" / "judged" / "1-plan") == checks(place / "out")
    with (place / "out" / "cases.csv").open(encoding="utf-8", newline="") as file:
        (case,) = csv.DictReader(file)
    assert (case["verdict"], case["sim_s"]) == ("error", "0.2")
    assert case["frame_log_sha256"] == facts.frame_log_sha256 != ""


@pytest.mark.long
@pytest.mark.interpreted
def test_a_plant_that_fails(place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """No FMU is asked for anything after it; the rows before it are whole."""
    take = StepsInARow.take
    kept_fmus.forget()

    def refuse(
        steps: StepsInARow, ends_ns: Sequence[int], given: Sequence[float] = ()
    ) -> list[list[float]]:
        if ends_ns[-1] > 60 * MS and steps._slave.name == "z":
            steps._slave.failed("doStep", 3)
        return take(steps, ends_ns, given)

    monkeypatch.setattr(StepsInARow, "take", refuse)
    code, said, _ = axisrig("run", write(place, ""), "-o", "out")
    assert code == 4
    assert "doStep: error" in said
    facts, last_ns = left(place)
    assert "doStep: error" in facts.unfinished
    assert 55 * MS < last_ns <= 60 * MS
    assert facts.plants == {}
    assert facts.axes["Z"].states
    assert "doStep: error" in whole(place / "out" / "report.html")
