"""Files of a run that the report links: trace, facts, bus logs, row of the plan, program."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.layout import SEGMENT_MARK
from axisrig.bench.campaign.results.stored import RECORDINGS
from axisrig.reports.build import _links


@pytest.fixture
def place(tmp_path: Path) -> Path:
    (tmp_path / "bus").mkdir()
    for name in ("p-a.blf", f"p-b{SEGMENT_MARK}can1.blf", f"p-b{SEGMENT_MARK}can2.blf"):
        (tmp_path / "bus" / name).touch()
    return tmp_path


def links(place: Path | None, recorded: str, **more: Any) -> list[tuple[str, str, str]]:
    manifest = {"plans": [{"name": "p", "path": "plans/p.csv"}], "output": "out", **more}
    results: Any = SimpleNamespace(manifest=manifest, place=place)
    run: Any = SimpleNamespace(
        trace=Path("p-a.arrow"),
        file=None,
        run="p-a",
        recorded=recorded,
        case={"plan": "p", "program": "a.nc"},
        checks=[SimpleNamespace(reference="q.csv:9"), SimpleNamespace(reference="p.csv:3")],
    )
    return _links(results)(run)


def test_bus_logs_are_those_of_the_run_whose_recording_it_is(place: Path) -> None:
    """A row that is judged from the recording of another run has no log of its own."""
    for recorded in ("p-a", "p-b"):
        logs = [shown for what, shown, _ in links(place, recorded) if shown.startswith("bus/")]
        names = sorted(path.name for path in (place / "bus").iterdir())
        assert logs == [f"bus/{name}" for name in names if name.startswith(recorded)]
        assert len(logs) == (1 if recorded == "p-a" else 2)
    assert not [shown for _, shown, _ in links(None, "p-a") if shown.startswith("bus/")]


def test_addresses_count_from_the_page(place: Path) -> None:
    whole = {shown: address for _, shown, address in links(place, "p-a")}
    assert whole == {
        "traces/p-a.arrow": "traces/p-a.arrow",
        "bus/p-a.blf": "bus/p-a.blf",
        "p.csv:3": "../plans/p.csv",
        "a.nc": "../plans/a.nc",
    }
    beside = {shown: address for _, shown, address in links(place, "p-a", **{RECORDINGS: "../r 1"})}
    assert beside["traces/p-a.arrow"] == "../r%201/traces/p-a.arrow"
