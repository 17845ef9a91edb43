"""What `axisrig params` says of one parameter and of a topic; what `axisrig perf` divides by."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord, Contact, Edge, ProbeRecord
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.rig.parameter_words import every_parameter, warning
from axisrig.bench.tools.budget.observed_run import METRICS, see
from axisrig.bench.tools.params.listing import explained, page, parameters_text
from axisrig.bench.tools.perf import perf
from axisrig.bench.tools.perf.perf import measure
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import UNITS
from axisrig.kernel.parameters.table import TOPICS
from axisrig.kernel.time.clock import MS

ROWS = [*every_parameter()]
PLAN = Path(__file__).parents[2] / "testplans" / "latch_accuracy.csv"

FACTS = ("type", "range", "limits", "default", "while unset", "warning", "older names", "acts",
         "list", "source")  # fmt: skip

# One parameter


def test_each_parameter_has_a_line_for_each_fact_and_none_for_what_it_lacks() -> None:
    for row in ROWS:
        lines = explained(row).splitlines()
        assert row.path in lines[0]
        facts_of = [line for line in lines if line[2:14].rstrip() in FACTS]
        assert all(line[14] == " " and line[15:].strip() for line in facts_of)
        there = [line[2:14].rstrip() for line in facts_of]
        assert there == [name for name in FACTS if name in there]
        assert ("older names" in there) is bool(row.old_paths)
        assert ("warning" in there) is bool(warning(row))
        assert ("while unset" in there) is bool(row.fallback)
        assert set(there) >= {"type", "default", "list", "source"}


def test_only_a_unit_that_is_another_one_of_a_rotary_axis_is_said_twice() -> None:
    seen = set()
    for row in ROWS:
        unit = UNITS.get(row.unit)
        (line,) = (each for each in explained(row).splitlines() if each.startswith("  type  "))
        is_other = unit is not None and unit.rotary != unit.name
        assert ("(rotary axis: " in line) is is_other
        assert (" are 1 " in line) is (unit is not None and unit.divisor > 1)
        seen.add((unit is not None, is_other))
    assert seen == {(False, False), (True, False), (True, True)}


# Pages


@pytest.mark.parametrize("topic", list(TOPICS))
def test_a_page_has_the_topics_of_its_rows_alone(topic: str) -> None:
    rows = [row for row in ROWS if row.topic == topic]
    assert rows
    heads = [line for line in page(rows).splitlines() if line.startswith("## ")]
    assert heads == [f"## {TOPICS[topic]}", "## Units", "## Damaged names of the printed lists"]
    table = [line for line in page(rows).splitlines() if line.startswith("| `") and "| " in line]
    assert len([line for line in table if any(f"`{row.path}`" in line for row in rows)]) >= len(
        rows
    )


def test_a_bar_in_a_cell_divides_no_column() -> None:
    row = replace(ROWS[0], meaning="one | or the other", source="a|b")
    (line,) = (each for each in page([row]).splitlines() if each.startswith(f"| `{row.path}`"))
    assert line.endswith("| one \\| or the other | a\\|b |")
    assert line.replace("\\|", "").count("|") == 8


@pytest.mark.parametrize("form", ["csv", "markdown"])
def test_a_table_of_one_word_is_a_table(form: str) -> None:
    """Only the text explains the one parameter that a number means."""
    text = parameters_text([ROWS[0].number], form)
    assert text != explained(ROWS[0])
    assert ROWS[0].path in text
    assert parameters_text([ROWS[0].number], "text") == explained(ROWS[0])


def test_words_that_fit_nothing_are_said_as_a_whole() -> None:
    with pytest.raises(UserError, match="no parameter fits") as caught:
        parameters_text(["nothing", "of", "that"], "text")
    assert caught.value.value == "nothing of that"


# A measured row


class Clock:
    """Seconds that a test spends; wall time goes twice as fast."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def cpu_s(self) -> float:
        return self.now_s

    def cpu_ns(self) -> int:
        return round(self.now_s * 1e9)

    def wall_ns(self) -> int:
        return round(self.now_s * 2e9)


@pytest.fixture
def timed(monkeypatch: pytest.MonkeyPatch) -> Callable[..., dict[str, Any]]:
    """Measure runs that take so long, of 20 s simulated in some cycles."""

    def made(*runs_s: float, cycles: int | None = 4, compiled: bool = True) -> dict[str, Any]:
        clock, lasts = Clock(), iter([*runs_s, 8.0])
        series = None if cycles is None else SimpleNamespace(column=lambda _: range(cycles))

        def run_case(*_: Any) -> Any:
            clock.now_s += next(lasts)
            return SimpleNamespace(
                error=None, sim_s=20.0, loop_s=1.0, frame_log_sha256="ab", series=series
            )

        class Folder:
            def __enter__(self) -> "Folder":
                return self

            def __exit__(self, *_: object) -> None:
                return None

            def files_of(self, _run: str) -> None:
                return None

            def add(self, _result: object) -> None:
                return None

        monkeypatch.setattr(perf, "prepare", lambda _: None)
        monkeypatch.setattr(perf, "run_case", run_case)
        monkeypatch.setattr(perf, "ResultsWriter", lambda *_, **__: Folder())
        monkeypatch.setattr(perf, "build_manifest", lambda *_, **__: {})
        monkeypatch.setattr(perf, "is_compiled", lambda: compiled)
        given: Any = clock
        return measure(PLAN, "f600", len(runs_s), given, lambda _: Path())

    return made


def test_factors_of_two_runs_are_of_what_is_between_them(
    timed: Callable[..., dict[str, Any]],
) -> None:
    """2 and 3 s of CPU, 4 and 6 s of wall time: 2.5 and 5 s."""
    found = timed(2.0, 3.0)
    assert (found["wall_s_min"], found["wall_s"], found["wall_s_max"]) == (4.0, 5.0, 6.0)
    assert found["real_time_factor"] == pytest.approx(4.0)
    assert (found["cpu_s"], found["cpu_factor"]) == (2.5, pytest.approx(8.0))
    assert found["beyond_simulation_ms"] == pytest.approx(2000.0)  # of the second one alone
    back = timed(3.0, 2.0)
    assert (back["wall_s_min"], back["wall_s"], back["wall_s_max"]) == (4.0, 5.0, 6.0)
    assert back["beyond_simulation_ms"] == pytest.approx(1000.0)


@pytest.mark.parametrize("cycles", [None, 0, 1, 4])
@pytest.mark.parametrize("compiled", [True, False])
def test_what_has_no_cycles_is_divided_by_one(
    timed: Callable[..., dict[str, Any]], cycles: int | None, compiled: bool
) -> None:
    """16 s of wall time in the run that is taken apart; nothing of it in a part."""
    found = timed(2.0, cycles=cycles, compiled=compiled)
    assert found["cycles"] == (cycles or 0)
    split = found["cycle_us"]
    assert split.pop("rest") == pytest.approx(16e6 / max(cycles or 0, 1))
    assert split == ({} if compiled else dict.fromkeys(perf.PARTS, 0.0))


# A budget whose plants have names of their own


@pytest.mark.parametrize(("axis", "per_length"), [("X", 2.0), ("Z", -1.0)])
def test_speeds_of_a_touch_are_those_of_the_axes_that_move_the_plants_of_the_probe(
    axis: str, per_length: float
) -> None:
    """X goes 20 and Z -10 mm/s onto a plane: X has twice the way; neither plant is called so."""
    ms = np.arange(40, dtype=np.float64)
    table = pa.table({
        "time_ns": np.arange(40, dtype=np.int64) * MS,
        "X.truth_mm": 0.02 * ms, "X.velocity_mm_s": np.full(40, 20.0),
        "Z.truth_mm": 5 - 0.01 * ms, "Z.velocity_mm_s": np.full(40, -10.0),
    })  # fmt: skip
    plants = {"X": "table", "Z": "quill"}
    contact = Contact(20 * MS, {"table": 0.4, "quill": 4.8})
    left = facts(
        axes={name: AxisRecord("can1", n, 1.0, plant=plant, signals={"probe_1": "probe"})
              for n, (name, plant) in enumerate(plants.items(), 1)},
        probes={"probe": ProbeRecord(True, 1.0, contacts=(contact,), edges=(Edge(20 * MS, True),))},
        runs=(MeasurementRun(("X", "Z"), begin_ns=MS, end_ns=35 * MS, inputs={"X": 1, "Z": 1}),),
        end_ns=40 * MS, sim_ns=40 * MS,
    )  # fmt: skip
    rig = SimpleNamespace(
        axis={name: SimpleNamespace(drive="servo", plant=plant, probe_1="probe")
              for name, plant in plants.items()},
        plant={
            "table": SimpleNamespace(start={}, wire={}),
            "quill": SimpleNamespace(start={}, wire={}),
            "probe": SimpleNamespace(start={}, wire={"x": "table", "z": "quill"}),
        },
    )  # fmt: skip
    values = dict(zip(METRICS, (-1.0, -10.0, 0.3, None), strict=True))
    checks = [
        judge(parse_check(f"{name}:{axis}", "-1e9 .. 1e9", ""), value, 0.0, "none")
        for name, value in values.items()
    ]
    case: Any = SimpleNamespace(run="p-a", inputs={})
    settings: Any = SimpleNamespace(rig=rig, start={})
    result = CaseResult(case, Verdict.PASS, checks, facts=left, series=kept(table))
    assert see(result, axis, settings).per_length == pytest.approx(per_length)
