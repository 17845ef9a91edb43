"""Pictures of the checks of a run that did not pass, and a recording that is damaged."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from tests.recordings import Step, block_trace, facts
from tests.reports.test_row_of_a_run import row, run
from tests.reports.test_view_of_a_run import view

from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.facts import run_text
from axisrig.kernel.errors import UserError
from axisrig.reports import run as page

TRACE, CHART = pa.table({"time_ns": [0, 1]}), {"plots": []}
ROWS = (
    row("a", verdict="fail"), row("b"), row("c", verdict="error"), row("d", verdict="fail"),
    row("e", verdict="marginal"),
)  # fmt: skip


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """What is asked of a picture; those of a and d are alike."""
    asked: list[tuple[Any, ...]] = []

    def picture(*words: Any) -> str:
        asked.append(words)
        return "<svg>" + {"a": "same", "d": "same"}.get(words[2], words[2])

    monkeypatch.setattr(page, "picture", picture)
    monkeypatch.setattr(page, "with_signals", lambda *words: words)
    return asked


def test_each_check_that_did_not_pass_has_a_picture_and_equal_ones_are_drawn_once(
    drawn: list[tuple[Any, ...]],
) -> None:
    """The worst one first; a marginal one is good."""
    info = RunFindings()
    found = page._pictures(run("error", *ROWS), TRACE, info, CHART, ())
    assert found == {"c": "<svg>c", "a": "<svg>same"}
    assert drawn == [((TRACE, info, ()), CHART, name) for name in "cad"]


@pytest.mark.parametrize(
    ("trace", "chart", "rows"),
    [(None, CHART, ROWS), (TRACE, {}, ROWS), (TRACE, CHART, ROWS[1:2]), (TRACE, CHART, ())],
)
def test_without_signals_or_a_failure_there_is_no_picture(
    trace: Any, chart: dict[str, Any], rows: Any, drawn: list[tuple[Any, ...]]
) -> None:
    assert page._pictures(run("fail", *rows), trace, RunFindings(), chart, ()) == {}
    assert drawn == []


def test_a_damaged_block_trace_is_refused_with_the_file_of_its_run(tmp_path: Path) -> None:
    trace = replace(block_trace((Step("N10 G1 Z5", "feed", 1, 2, 6),)), packed="no rows")
    with pytest.raises(UserError) as refused:
        view(tmp_path, text=run_text(facts(blocks=trace)))
    assert refused.value.message.startswith("the recording is damaged: blocks: ")
    assert refused.value.file == str(tmp_path / "p-c.json")
    assert refused.value.hint == "run the case again with this version"
