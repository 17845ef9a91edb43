"""What goes of a results folder when it is cleared or opened anew, and what never does."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from results_setup import posix

from axisrig.bench.campaign.results.folder import ResultsFolder, clear, refuse_foreign
from axisrig.bench.campaign.results.layout import FOLDERS, PLANS
from axisrig.bench.campaign.results.stored import CASE_COLUMNS, RESULT_COLUMNS
from axisrig.kernel.errors import UserError

TABLES = {
    "cases.csv": ",".join(CASE_COLUMNS) + "\n",
    "results.csv": ",".join(RESULT_COLUMNS) + "\n",
}
MANIFEST = '{"axisrig": "1", "runs_planned": 0, "finished": true}'


def files_below(place: Path) -> list[str]:
    return sorted(path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file())


def filled(place: Path, names: Sequence[str]) -> Path:
    for name in names:
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_text(TABLES.get(name, MANIFEST), encoding="utf-8")
    return place


OWN = [
    *("results.csv", "cases.csv", "junit.xml", "report.html", "report.pdf", "manifest.json"),
    *("inputs.json", "plans/p.csv", "plans/q.csv", "traces/r.parquet", "runs/r.json"),
    *("bus/r.blf", "bus/r@can2.log", "judged/1-p/cases.csv", "budgets/r/Z.csv"),
    *(".new/campaign-1/runs/r.json", ".new/campaign-1/r.commit"),
    # What a process leaves that was killed while it wrote one of them
    *(".results.csv.new", ".cases.csv.new", ".junit.xml.new", ".report.html.new"),
    *(".report.pdf.new", ".manifest.json.new", ".inputs.json.new"),
    # Below the folders of runs
    *("traces/of-somebody/r.parquet", "plans/deep/er/p.csv"),
]


@pytest.mark.parametrize("name", OWN)
def test_of_the_results_nothing_stays(tmp_path: Path, name: str) -> None:
    place = filled(tmp_path / "out", [name, "notes.txt"])
    clear(place)
    assert files_below(place) == ["notes.txt"]


def test_what_is_not_of_the_results_stays(tmp_path: Path) -> None:
    """The lock is held meanwhile; time series that were exported are the user's."""
    names = [".lock", "export/r.mf4", "notes.txt", "mine/cases.csv", "cases.csv.bak"]
    place = filled(tmp_path / "out", [*OWN, *names])
    clear(place)
    assert files_below(place) == sorted(names)
    kept = {path.name for path in place.iterdir() if path.is_dir()}
    assert kept == {PLANS, *FOLDERS, "export", "mine"}
    clear(place)  # once more: nothing is left to remove
    assert files_below(place) == sorted(names)


@posix
@pytest.mark.parametrize(
    "name", ["judged", "budgets", ".new", "plans", "traces", "runs", "bus", "traces/deep"]
)
def test_of_a_link_only_the_link_goes(tmp_path: Path, name: str) -> None:
    """Also one inside of a folder of runs."""
    elsewhere = filled(tmp_path / "elsewhere", ["kept.txt", "deep/kept.txt"])
    place = filled(tmp_path / "out", ["cases.csv"])
    (place / name).parent.mkdir(exist_ok=True)
    (place / name).symlink_to(elsewhere, target_is_directory=True)
    clear(place)
    assert not (place / name).is_symlink()
    assert files_below(elsewhere) == ["deep/kept.txt", "kept.txt"]


@posix
def test_a_link_to_a_file_is_no_reason_to_empty_that_file(tmp_path: Path) -> None:
    other = tmp_path / "other.txt"
    other.write_text("mine", encoding="utf-8")
    place = filled(tmp_path / "out", ["bus/r.blf"])
    for name in ("cases.csv", "bus/s.blf"):
        (place / name).symlink_to(other)
    clear(place)
    assert files_below(place) == []
    assert not (place / "cases.csv").is_symlink()
    assert other.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("name", ["junit.xml", "report.html", "report.pdf"])
def test_what_is_made_of_the_rows_goes_with_the_begin_of_a_campaign(
    tmp_path: Path, name: str
) -> None:
    """Where there are rows; the manifest and what belongs to runs stay."""
    others = ["manifest.json", "inputs.json", "plans/p.csv", "judged/1-p/cases.csv"]
    place = filled(tmp_path / "out", [name, *others, *TABLES])
    results = ResultsFolder(place)
    results.open()
    results.close()
    assert files_below(place) == sorted([*others, *TABLES])


@pytest.mark.parametrize(
    ("names", "runs", "left"),
    [
        (["bus/r@can2.blf"], ["r"], []),  # of one segment alone
        (["bus/r@ec1.pcapng", "bus/r@ec2.pcapng"], ["r"], []),
        (["bus/r.blf", "bus/r.asc", "bus/r.log", "bus/r.pcap", "traces/r.parquet"], ["r"], []),
        (["runs/r.json"], ["r"], []),
        (["bus/r.blf", "bus/s.blf", "bus/r2.blf"], ["r"], ["bus/r2.blf", "bus/s.blf"]),
        (["bus/r.blf", "bus/r.1.blf"], ["r.1"], ["bus/r.blf"]),
        (["bus/r.blf", "bus/r.1.blf"], ["r"], ["bus/r.1.blf"]),
        (["bus/r[1].blf", "bus/r1@can2.blf"], ["r[1]"], ["bus/r1@can2.blf"]),
        (["runs/r.json", "runs/s.json", "runs/t.json"], ["t", "r"], ["runs/s.json"]),
        (["traces/r.txt", "bus/r"], ["r"], ["bus/r", "traces/r.txt"]),
    ],
)
def test_files_of_runs_without_a_row_go_by_the_id_of_their_run(
    tmp_path: Path, names: list[str], runs: list[str], left: list[str]
) -> None:
    place = filled(tmp_path / "out", names)
    results = ResultsFolder(place)
    results.open()
    results.drop_files(runs)
    results.close()
    assert files_below(place) == left


@pytest.mark.parametrize(
    ("names", "is_refused"),
    [
        ([".lock"], False),
        ([".manifest.json.new", ".cases.csv.new"], False),
        ([".new/campaign-1/runs/r.json"], False),
        ([".notes.txt.new"], True),
        (["manifest.json.bak"], True),
        (["traces"], True),  # a file of that name
        (["judged/1-p/cases.csv"], True),
        (["cases.csv", "results.csv"], True),  # of another tool: it has no manifest
        (["cases.csv", "results.csv", "manifest.json", "notes.txt"], False),
    ],
)
def test_a_folder_is_taken_where_it_is_of_results_or_one_that_was_hardly_begun(
    tmp_path: Path, names: list[str], is_refused: bool
) -> None:
    place = filled(tmp_path / "out", names)
    if is_refused:
        with pytest.raises(UserError, match="something that is no results folder") as caught:
            refuse_foreign(place)
        assert (caught.value.file, caught.value.hint) == (
            str(place), "name an empty or a new folder",
        )  # fmt: skip
    else:
        refuse_foreign(place)
    assert files_below(place) == sorted(names)
