"""What two campaigns were made from that differs, in words."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from tests.results.test_pairs import compared

from axisrig.bench.campaign.results.layout import INPUTS
from axisrig.bench.campaign.results.stored import read_results
from axisrig.results.compare.changes import KEYS_MAX, changes
from axisrig.results.compare.pairs import compare
from axisrig.results.compare.words import diff_lines

HEAD = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,plc:V.E.F"
CHECKS = "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference"
RIG = """title = "x"
[drive.servo]
input_delay_us = {delay}
sides = [1, 2]
"""
LIST = "# a list\nkenngr.achs_nr 1\nkenngr.measure.signal {signal} # why\nEnde\n"


def folder(
    place: Path,
    texts: dict[str, str],
    rows: Sequence[tuple[str, str]] = (("300", "<= 1"),),
    **more: Any,
) -> Path:
    """rows: input and condition of each run. The hash of a file follows from its text."""
    place.mkdir()
    cases = [HEAD, *(f"p,c,r{n},pass,1,1,1,,h,{value}" for n, (value, _) in enumerate(rows))]
    checks = [CHECKS]
    checks += [f"p,c,r{n},{asked},m,1,um,,1,0,pass,p.csv:2" for n, (_, asked) in enumerate(rows)]
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    hashes = {name: f"{sum(text.encode()):064x}" for name, text in texts.items()}
    manifest = {"axisrig": "0.1.0", "python": "3.11", "files": hashes, "finished": True, **more}
    (place / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    (place / INPUTS).write_text(json.dumps(texts), encoding="utf-8")
    return place


def found(one: Path, other: Path) -> list[str]:
    folders = [read_results(place) for place in (one, other)]
    comparison = compare(*folders)
    lines = diff_lines(comparison, changes(folders[0], folders[1], comparison.pairs))
    return [line for line in lines if line.startswith(("changed", "  "))]


def test_keys_of_rig_and_list_are_named_with_both_values(tmp_path: Path) -> None:
    """A rig, a list, and a program that differ; a comment and an equal key do not count."""
    before = {"r.toml": RIG.format(delay=4), "z.lst": LIST.format(signal="PLC"), "p.nc": "N10 X1"}
    after = {"r.toml": RIG.format(delay=20), "z.lst": LIST.format(signal="1"), "p.nc": "N10 X2"}
    lines = found(folder(tmp_path / "a", before), folder(tmp_path / "b", after))
    heads = [line.split(" ")[1] for line in lines if line.startswith("changed")]
    assert heads == ["p.nc", "r.toml", "z.lst"]
    assert "  drive.servo.input_delay_us 4 -> 20" in lines
    assert "  kenngr.measure.signal PLC -> 1" in lines
    assert len(lines) == 6  # three files, the block N10, two keys
    assert any(" -> " in line and "0000" in line for line in lines)


def test_a_key_that_only_one_file_has_is_said_to_be_missing(tmp_path: Path) -> None:
    one = folder(tmp_path / "a", {"r.toml": "a = 1\n"})
    other = folder(tmp_path / "b", {"r.toml": "b = 2\n", "new.toml": ""})
    lines = found(one, other)
    assert lines[0] == "changed: new.toml is new"
    assert lines[2:] == ["  a 1 -> (missing)", "  b (missing) -> 2"]


def test_versions_are_named(tmp_path: Path) -> None:
    one = folder(tmp_path / "a", {}, packages={"fmpy": "0.3.22", "numpy": "2"}, compiled=False)
    other = folder(
        tmp_path / "b",
        {},
        packages={"fmpy": "0.3.23", "numpy": "2"},
        compiled=True,
        axisrig="0.2.0",
    )
    assert found(one, other) == [
        "changed: axisrig 0.1.0 -> 0.2.0",
        "changed: compiled False -> True",
        "changed: fmpy 0.3.22 -> 0.3.23",
    ]


@pytest.mark.parametrize(
    ("name", "shown"),
    [("axisrig", "axisrig"), ("sources_sha256", "sources"), ("compiled", "compiled"),
     ("python", "python"), ("platform", "platform")],
)  # fmt: skip
def test_each_version_is_named_alone(tmp_path: Path, name: str, shown: str) -> None:
    one, other = (folder(tmp_path / value, {}, **{name: value}) for value in ("1", "2"))
    assert found(one, other) == [f"changed: {shown} 1 -> 2"]
    assert found(one, one) == []


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("name", ["r.toml", "z.lst", "p.nc", "Axis.fmu"])
def test_a_file_that_only_one_folder_has_is_new_or_missing(
    tmp_path: Path, name: str, turn: int
) -> None:
    one, other = (
        folder(tmp_path / place, {}, files=dict.fromkeys(files, f"{7:064x}"))
        for place, files in (("a", ["q.nc"]), ("b", [name, "q.nc"]))
    )
    words = "is new" if turn > 0 else "is missing"
    assert found(*(one, other)[::turn]) == [f"changed: {name} {words}"]


@pytest.mark.parametrize("more", [-1, 0, 1, 5])
def test_so_many_keys_of_a_file_are_named_and_the_rest_is_counted(
    tmp_path: Path, more: int
) -> None:
    count = KEYS_MAX + more
    texts = ["".join(f"k{n} = {value}\n" for n in range(count)) for value in (1, 2)]
    one, other = (folder(tmp_path / str(n), {"r.toml": text}) for n, text in enumerate(texts))
    _, *keys = found(one, other)
    assert keys[:KEYS_MAX] == [f"  k{n} 1 -> 2" for n in range(min(count, KEYS_MAX))]
    assert keys[KEYS_MAX:] == ([f"  {more} more"] if more > 0 else [])


@pytest.mark.parametrize("turn", [1, -1])
def test_a_version_that_only_one_folder_has_is_no_change(tmp_path: Path, turn: int) -> None:
    """An older release wrote fewer of them; a package may be of an extra."""
    one = folder(tmp_path / "a", {}, packages={"numpy": "2"})
    other = folder(
        tmp_path / "b", {}, packages={"numpy": "2", "duckdb": "1.4"}, compiled=True, platform="x",
        sources_sha256="ab" * 32,
    )  # fmt: skip
    assert found(*(one, other)[::turn]) == []


@pytest.mark.parametrize(
    ("version", "shown"),
    [
        ("0123456789abcdef" * 4, "0123456789ab"),
        ("0123456789abcdef" * 4 + "0", "0123456789abcdef" * 4 + "0"),
        ("0123456789abcdef" * 3, "0123456789abcdef" * 3),
        ("0123456789abcdeX" * 4, "0123456789abcdeX" * 4),
        ("1.2.3", "1.2.3"),
    ],
)
def test_of_a_sha_256_the_begin_is_named_and_of_other_versions_all(
    tmp_path: Path, version: str, shown: str
) -> None:
    one = folder(tmp_path / "a", {}, sources_sha256=version)
    other = folder(tmp_path / "b", {}, sources_sha256="f" * 64)
    assert found(one, other) == [f"changed: sources {shown} -> {'f' * 12}"]


def test_plans_and_models_are_files_as_well(tmp_path: Path) -> None:
    """A model has no text that a folder keeps; a plan is known by its name, wherever it was."""
    one, other = (
        folder(
            tmp_path / name,
            {},
            fmus={"Axis.fmu": f"{fmu:064x}", "Probe.fmu": f"{7:064x}"},
            plans=[{"name": "p", "path": f"{name}/p.csv", "sha256": f"{plan:064x}"}],
        )
        for name, fmu, plan in (("a", 1, 3), ("b", 2, 4))
    )
    heads = [line.split(" ")[1] for line in found(one, other) if line.startswith("changed")]
    assert heads == ["Axis.fmu", "p.csv"]


@pytest.mark.parametrize("column", ["seed", "program", "rig", "plc:V.E.F", "info:device"])
def test_a_cell_that_decides_or_tells_what_was_run_is_named(tmp_path: Path, column: str) -> None:
    folders = []
    for value in ("1", "2"):
        place = folder(tmp_path / value, {})
        cells = dict.fromkeys([*HEAD.split(","), column], "") | {"plan": "p", "case": "c"}
        cells |= {"run": "r0", "verdict": "pass", "sim_s": "1", "wall_s": value, column: value}
        cases = [",".join(cells), ",".join(cells.values())]
        (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
        folders.append(place)
    lines = found(*folders)
    assert lines[-1] == f"  {column} 1 -> 2"
    assert not any("wall_s" in line for line in lines)


def test_cells_of_the_plan_are_counted(tmp_path: Path) -> None:
    one = folder(tmp_path / "a", {}, [("300", "<= 1"), ("600", "<= 1"), ("900", "<= 1")])
    other = folder(tmp_path / "b", {}, [("300", "<= 0.5"), ("600", "<= 0.5"), ("901", "<= 1")])
    assert found(one, other) == [
        "changed: the plan",
        "  check:m <= 1 -> <= 0.5 in 2 runs",
        "  plc:V.E.F 900 -> 901",
    ]


def table(place: Path, rows: Sequence[dict[str, str]]) -> Path:
    """A folder whose runs have these cells beside their names; all rows have the same columns."""
    folder(place, {})
    known = {"plan": "p", "case": "c", "verdict": "pass", "sim_s": "1", "wall_s": "1"}
    known = dict.fromkeys(HEAD.split(",")[:-1], "") | known
    cells = [known | {"run": f"r{number}"} | row for number, row in enumerate(rows)]
    lines = [",".join(cells[0]), *(",".join(row.values()) for row in cells), ""]
    (place / "cases.csv").write_text("\n".join(lines), encoding="utf-8")
    return place


@pytest.mark.parametrize("column", ["plc:V.E.N", "fault:probe", "set:Z.a", "info:device", "rig"])
@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ({}, {"?": "5"}, "(empty) -> 5"),
        ({"?": "5"}, {}, "5 -> (empty)"),
        ({"?": ""}, {"?": "5"}, "(empty) -> 5"),
        ({"?": "4"}, {"?": "5"}, "4 -> 5"),
        ({}, {"?": ""}, ""),
        ({"?": "5"}, {"?": "5"}, ""),
    ],
)
def test_a_column_that_one_plan_has_is_named_whichever_it_is(
    tmp_path: Path, column: str, before: dict[str, str], after: dict[str, str], words: str
) -> None:
    """A plan without it, and one with an empty cell, say the same."""
    places = [
        table(tmp_path / name, [dict.fromkeys([column] if row else [], row.get("?", ""))])
        for name, row in (("a", before), ("b", after))
    ]
    expected = ["changed: the plan", f"  {column} {words}"] if words else []
    assert found(*places) == expected


@pytest.mark.parametrize(
    "column", ["title", "tags", "note:x", "search:plc:V.E.N", "verdict", "alarms"]
)
def test_a_column_that_decides_nothing_is_not_named(tmp_path: Path, column: str) -> None:
    places = [table(tmp_path / value, [{column: value}]) for value in ("pass", "error")]
    assert not any(line.startswith(f"  {column}") for line in found(*places))


def test_cells_are_in_the_order_of_how_many_runs_they_are_in(tmp_path: Path) -> None:
    """Three changes: in one, in three and in two of three runs; of a row that differs in two."""
    before = [{"plc:V.E.A": "1", "set:Z.b": "1", "seed": "1"}] * 3
    after = [{"plc:V.E.A": "2", "set:Z.b": "2", "seed": "2"}, {"plc:V.E.A": "1", "set:Z.b": "2",
             "seed": "2"}, {"plc:V.E.A": "1", "set:Z.b": "2", "seed": "1"}]  # fmt: skip
    assert found(table(tmp_path / "a", before), table(tmp_path / "b", after)) == [
        "changed: the plan",
        "  set:Z.b 1 -> 2 in 3 runs",
        "  seed 1 -> 2 in 2 runs",
        "  plc:V.E.A 1 -> 2",
    ]


def test_nothing_changed_says_nothing_and_long_lists_are_cut(tmp_path: Path) -> None:
    same = folder(tmp_path / "a", {"r.toml": RIG}), folder(tmp_path / "b", {"r.toml": RIG})
    assert found(*same) == []
    many = ["".join(f"k{n} = {n + add}\n" for n in range(30)) for add in (0, 1)]
    lines = found(
        folder(tmp_path / "c", {"r.toml": many[0]}), folder(tmp_path / "d", {"r.toml": many[1]})
    )
    assert len(lines) == 1 + KEYS_MAX + 1
    assert lines[-1] == "  10 more"


@pytest.mark.parametrize(
    ("name", "before", "after", "keys"),
    [
        ("z.lst", "a.b 1 # c\nEnde\n", "a.b  2\nc 3\nEnd\n", ["a.b 1 -> 2", "c (missing) -> 3"]),
        ("m.toml", "[a.b]\nc = 'x'\n", "[a.b]\nc = true\n", ["a.b.c x -> true"]),
        # What has no keys: a name is there twice, in the first or the second, or it is no TOML
        ("n.txt", "G1 X1\nG1 X2\n", "G1 X1\n", []),
        ("n.txt", "G1 X1\n", "G1 X1\nG1 X2\n", []),
        ("n.txt", "F 1\nG1 X1\nG1 X2\n", "F 2\nG1 X1\n", []),
        ("n.txt", "F 1\nG1 X1\n", "F 2\nG1 X1\nG1 X2\n", []),
        ("m.toml", "a = \n", "a = 1\n", []),
        ("m.toml", "a = 1\n", "a = \n", []),
    ],
)
def test_a_file_has_keys_where_each_of_them_is_there_once(
    tmp_path: Path, name: str, before: str, after: str, keys: list[str]
) -> None:
    lines = found(folder(tmp_path / "a", {name: before}), folder(tmp_path / "b", {name: after}))
    assert [line.strip() for line in lines[1:]] == keys
    assert lines[0].startswith(f"changed: {name} ")


@pytest.mark.parametrize("text", ["no json", "[1]", '{"a": 1}', None])
def test_a_folder_that_kept_no_texts_names_the_files_alone(
    tmp_path: Path, text: str | None
) -> None:
    one, other = (
        folder(tmp_path / "a", {"r.toml": "a = 1\n"}),
        folder(tmp_path / "b", {"r.toml": "a = 2\n"}),
    )
    if text is None:
        (one / INPUTS).unlink()
    else:
        (one / INPUTS).write_text(text, encoding="utf-8")
    (line,) = found(one, other)
    assert line.startswith("changed: r.toml 0000")


def test_a_check_that_only_one_folder_asks_for_is_no_other_cell(tmp_path: Path) -> None:
    """What is asked of the same metric is one; without a condition on one side it is one too."""
    both = [
        {"runs": [{"run": "r"}], "checks": [{"metric": name, "check": asked} for name, asked in of]}
        for of in ((("m", "<= 1"), ("old", "<= 5"), ("open", "")),
                   (("m", "<= 2"), ("new", "<= 5"), ("open", "<= 3")))
    ]  # fmt: skip
    comparison = compared(tmp_path, *both)
    stored = [read_results(tmp_path / str(n)) for n in (0, 1)]
    assert dict(changes(*stored, comparison.pairs))["the plan"] == [
        "check:m <= 1 -> <= 2", "check:open (empty) -> <= 3",
    ]  # fmt: skip
