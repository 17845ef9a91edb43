"""Two builds side by side: the table, which way is better, and the plan of many rows."""

import shutil
from pathlib import Path

import pytest
from tests.perf.beside import KINDS, Build, many_rows, read_measures

from axisrig.bench.plan.plan import read_plan

ROOT = Path(__file__).parents[2]


@pytest.mark.long
def test_every_measure_is_of_a_known_kind_and_names_a_row_that_is_there() -> None:
    for measure in read_measures():
        assert measure.kind in KINDS
        assert measure.better in ("more", "less")
        assert measure.reach >= 1.0
        if measure.plan:
            plan = read_plan(ROOT / "testplans" / measure.plan)
            assert measure.row in [case.case for case in plan.cases]


@pytest.mark.parametrize(("better", "gain"), [("more", 0.5), ("less", 2.0)])
def test_a_gain_above_one_is_better(better: str, gain: float) -> None:
    measure = read_measures()[0]._replace(better=better)
    assert measure.gain(2.0, 4.0) == gain


def test_a_plan_of_many_rows_has_as_many_that_differ(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "testplans", tmp_path / "testplans")
    cases = read_plan(many_rows(tmp_path, 60)).cases
    assert len(cases) == 60
    assert len({case.inputs["plc:V.E.FEED"] for case in cases}) == 60
    assert len({case.run for case in cases}) == 60


def test_a_build_is_called_where_it_was_compiled(tmp_path: Path) -> None:
    words = Build(tmp_path, "0").words("check", "a.csv")
    assert words == [str(tmp_path / ".venv-fast/bin/axisrig"), "check", "a.csv"]
