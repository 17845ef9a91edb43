"""The heading of the report: times without probes, what was tested with its number of runs."""

from pathlib import Path

import pytest
from tests.reports.swept import searched

from axisrig.bench.campaign.results.stored import StoredResults, read_results
from axisrig.reports.heading import heading


def test_probes_of_a_search_are_no_computing_of_their_own(tmp_path: Path) -> None:
    """Six probes and the row that searched, whose time has theirs in it: 1 s in each row."""
    folder = read_results(searched(tmp_path, ("300", "325")))
    facts = dict(heading(folder, {"sim": (2.0, 0.5), "real": ()})["facts"])
    assert facts["took"] == "1.0 s of computing in all runs"
    assert facts["simulated"] == "2.500 s in 2 runs"
    assert "on a real bus" not in facts
    on_a_bus = dict(heading(folder, {"sim": (0.0,), "real": (3.0,)})["facts"])
    assert (on_a_bus.get("simulated"), on_a_bus["on a real bus"]) == (None, "3.000 s in 1 run")


@pytest.mark.parametrize(
    ("serials", "words"),
    [
        (("7", "7", "7"), "serial no: 7"),
        (("7", "8", "7"), "serial no: 7 (2 runs), 8 (1 run)"),
        (("7", "", "7"), "serial no: 7 (2 runs)"),  # the third has no number
    ],
)
def test_what_was_tested_has_its_runs_where_they_differ(
    tmp_path: Path, serials: tuple[str, ...], words: str
) -> None:
    rows = ["run,verdict,wall_s,alarms,info:serial_no"]
    rows += [f"r{n},pass,1,,{serial}" for n, serial in enumerate(serials)]
    (tmp_path / "cases.csv").write_text("\n".join([*rows, ""]), encoding="utf-8")
    (tmp_path / "results.csv").write_text("run,metric,value,verdict\n", encoding="utf-8")
    folder: StoredResults = read_results(tmp_path)
    assert heading(folder, {"sim": (), "real": ()})["tested"][0] == words
