"""What a results folder that is damaged is refused with, and which names in it are whose."""

import json
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.results.commits import Commit, read_commit
from axisrig.bench.campaign.results.layout import logs_beside, run_of_log
from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    RESULT_COLUMNS,
    damaged,
    read_manifest,
    read_rows,
)
from axisrig.bench.campaign.results.tally import Tally
from axisrig.kernel.errors import UserError

FRESH = "`axisrig run --fresh` makes the results anew"


@pytest.mark.parametrize(
    ("name", "has_manifest", "is_of_another_tool"),
    [
        ("cases.csv", True, False),
        ("cases.csv", False, True),
        ("results.csv", True, False),
        ("results.csv", False, True),
        ("manifest.json", True, False),
        ("r.commit", False, False),
    ],
)
def test_a_damaged_file_comes_with_the_remedy_of_its_folder(
    tmp_path: Path, name: str, has_manifest: bool, is_of_another_tool: bool
) -> None:
    """Results of axisrig are made anew; another tool has to write its tables in another way."""
    if has_manifest:
        (tmp_path / "manifest.json").write_text("{}", encoding="utf-8")
    error = damaged(tmp_path / name, "odd", 7)
    assert (error.message, error.file, error.line) == (
        "the results folder is damaged: odd", str(tmp_path / name), 7,
    )  # fmt: skip
    assert (error.hint == FRESH) is not is_of_another_tool
    if is_of_another_tool:
        for word in ("cases.csv", "results.csv", "metric", "marginal", "inconclusive"):
            assert word in str(error.hint)


def refused(folder: Path, entries: dict[str, Any]) -> str:
    (folder / "manifest.json").write_text(json.dumps(entries), encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_manifest(folder)
    return caught.value.message


@pytest.mark.parametrize("size", [39, 40, 41, 5000])
def test_a_long_name_or_cell_is_cut_in_the_message(tmp_path: Path, size: int) -> None:
    """A folder may hold anything: 40 signs show what is meant."""
    name = "/" * size
    shown = repr("/" * min(size, 40))
    entries: tuple[dict[str, Any], ...] = (
        {"missing": {"p": ["p-a", name]}}, {"earlier": [{"runs": []}, {"runs": [name]}]},
    )  # fmt: skip
    for entry in entries:
        assert refused(tmp_path, entry).endswith(f": {shown} is no run id")
    path = tmp_path / "table.csv"
    path.write_text(f"run,verdict\na,pass\na,{name}\n", encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_rows(path, ("run", "verdict"))
    assert caught.value.message.endswith(f"verdict {shown} is no verdict")
    assert caught.value.line == 3


CASE = dict.fromkeys(CASE_COLUMNS, "") | {"run": "r", "verdict": "pass", "sim_s": "1",
                                          "wall_s": "1", "seed": "1"}  # fmt: skip
CHECK = dict.fromkeys(RESULT_COLUMNS, "") | {"run": "r", "verdict": "pass", "metric": "m",
                                             "uncertainty": "0"}  # fmt: skip


@pytest.mark.parametrize(
    ("case", "checks", "words"),
    [
        ({"verdict": "good"}, {}, "verdict 'good' is no verdict"),
        ({"sim_s": "-1"}, {}, "sim_s '-1' is no time"),
        ({"wall_s": ""}, {}, "wall_s '' is no time"),
        ({"trace_sha256": "f0"}, {}, "trace_sha256 'f0' is no SHA-256"),
        ({}, {"verdict": "good"}, "verdict 'good' is no verdict"),
        ({}, {"uncertainty": "-1"}, "uncertainty '-1' is no uncertainty"),
        ({}, {"uncertainty": "nan"}, "uncertainty 'nan' is no uncertainty"),
    ],
)
def test_every_row_of_a_commit_has_the_cells_of_a_result(
    tmp_path: Path, case: dict[str, str], checks: dict[str, str], words: str
) -> None:
    """Of its checks also the last one; columns beside those of each table are none of it."""
    path = tmp_path / "r.commit"
    more = {"plc:V.E.A": "1"}
    path.write_text(Commit("r", [], CASE | more, [CHECK, CHECK]).text, encoding="utf-8")
    assert read_commit(path).case == CASE | more
    path.write_text(Commit("r", [], CASE | case, [CHECK, CHECK | checks]).text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_commit(path)
    assert caught.value.message.endswith(f"damaged: {words}")
    assert caught.value.file == str(path)


NAMES = ("r.blf", "r.asc", "r@ec1.pcapng", "r@two.blf", "r2@ec1.pcapng", "r@ec1.parquet",
         "r.parquet", "@ec1.pcapng", "r@.pcapng", "s@ec1.pcapng")  # fmt: skip


def test_logs_of_single_segments_are_those_with_the_mark_of_their_run() -> None:
    """The log of the whole bus is none of them, nor that of a run with a longer name."""
    assert logs_beside("r", NAMES) == ["r@ec1.pcapng", "r@two.blf"]
    assert logs_beside("r2", NAMES) == ["r2@ec1.pcapng"]
    assert logs_beside("t", NAMES) == []


@pytest.mark.parametrize(
    ("name", "run"),
    [
        ("r.blf", "r"), ("r.asc", "r"), ("r.log", "r"), ("r@ec1.pcapng", "r"),
        ("a.b-c_1.blf", "a.b-c_1"), ("r.parquet", ""), ("r@.pcapng", ""), (".blf", ""),
        ("r@a/b.pcapng", ""), ("r@a:b.pcapng", ""),
    ],
)  # fmt: skip
def test_a_bus_log_has_the_id_of_its_run_in_its_name(name: str, run: str) -> None:
    assert run_of_log(name) == run


@pytest.mark.parametrize(
    ("tally", "words"),
    [
        (Tally(0), "0 runs"),
        (Tally(1), "1 run"),
        (Tally(0, 1), "1 row of statistics"),
        (Tally(0, 0, 1), "1 search"),
        (Tally(0, 0, 2), "2 searches"),
        (Tally(0, 0, 1, 1), "1 search with 1 probe"),
        (Tally(1, 1), "1 run and 1 row of statistics"),
        (Tally(0, 2, 1), "2 rows of statistics and 1 search"),
        (Tally(1, 0, 2, 9), "1 run and 2 searches with 9 probes"),
        (Tally(2, 2, 2), "2 runs, 2 rows of statistics and 2 searches"),
    ],
)
def test_a_campaign_is_counted_in_words_by_what_it_has(tally: Tally, words: str) -> None:
    """A search of which no probe is there yet has none to count."""
    assert tally.words == words
    assert tally.word == ("runs" if tally.rows == tally.runs else "rows")
