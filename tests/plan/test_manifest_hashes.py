"""Hashes in a manifest: of sources and of the files of its cases."""

import hashlib
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.results import case_files, manifest
from axisrig.bench.campaign.results.build_info import hash_of_sources
from axisrig.bench.campaign.results.case_files import content_hash, own_metrics, started_programs

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml"


def test_sources_count_by_name_and_content_and_what_was_made_of_them_does_not(
    tmp_path: Path,
) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    for folder, name, text in (
        (first, "one.py", "1"), (first, "deep/two.csv", "2"), (second, "three.py", "3"),
    ):  # fmt: skip
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    before = hash_of_sources([first, second])
    assert hash_of_sources([second, first]) == before
    for name in ("one.so", "deep/x.pyc", "y.pyd"):
        (first / name).touch()
    (second / "reports/documents").mkdir(parents=True)
    (second / "reports/documents/glossary.csv").write_text("of the documents", encoding="utf-8")
    assert hash_of_sources([first, second]) == before
    (first / "one.py").write_text("x", encoding="utf-8")
    changed = hash_of_sources([first, second])
    (first / "one.py").write_text("1", encoding="utf-8")
    (first / "one.py").rename(first / "other.py")
    assert len({before, changed, hash_of_sources([first, second])}) == 3


def test_names_and_contents_of_sources_make_their_hash(tmp_path: Path) -> None:
    """Neither another name nor two files with each other's content are the same sources."""
    one, other = tmp_path / "a.py", tmp_path / "b.py"
    one.write_text("1", encoding="utf-8")
    other.write_text("2", encoding="utf-8")
    found = [hash_of_sources([tmp_path])]
    one.write_text("2", encoding="utf-8")
    other.write_text("1", encoding="utf-8")
    found.append(hash_of_sources([tmp_path]))
    other.rename(tmp_path / "c.py")
    found.append(hash_of_sources([tmp_path]))
    (tmp_path / "inner").mkdir()
    (tmp_path / "c.py").rename(tmp_path / "inner" / "c.py")
    found.append(hash_of_sources([tmp_path]))
    (tmp_path / "fmus" / "shipped").mkdir(parents=True)
    (tmp_path / "fmus" / "shipped" / "z.fmu").write_text("a wheel alone has it", encoding="utf-8")
    assert len(set(found)) == len(found)
    assert hash_of_sources([tmp_path]) == found[-1]


def test_files_that_the_plc_starts_count_and_metrics_of_the_user() -> None:
    started = "file=a.nc after=5ms; at=motion file=sub/b.nc;file=c.nc"
    module: Any = SimpleNamespace(path=Path("/m/own.py"))
    own: Any = SimpleNamespace(path=None)
    base = case_of("a", program=Path("/n/part.nc"))
    assert [*started_programs(base), *own_metrics(base)] == []
    found = replace(base, inputs={"plc:program_start": started}, module=module)
    assert started_programs(found) == [Path("/n/a.nc"), Path("/n/sub/b.nc"), Path("/n/c.nc")]
    assert own_metrics(found) == [Path("/m/own.py")]
    none = replace(base, inputs={"plc:V.E.A": "file=x.nc"}, module=own)
    assert [*started_programs(none), *own_metrics(none)] == []


def test_files_of_cases_are_hashed_once_by_their_names_from_the_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Program, rig with what it is made from, and a table that the plan takes rows from."""
    for name in ("p.csv", "rows.csv", "b.nc", "a.nc", "lists/z.lst", "lists/started.nc", "r.toml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name, encoding="utf-8")
    monkeypatch.setattr(case_files, "rig_files", lambda rig: [rig, tmp_path / "lists" / "z.lst"])
    own = {"folder": tmp_path, "rig": tmp_path / "r.toml", "file": tmp_path / "p.csv"}
    starts = {"inputs": {"plc:program_start": "file=lists/started.nc"}}
    cases = [
        case_of("a", program=tmp_path / "b.nc", **own, **starts),
        case_of("b", program=tmp_path / "a.nc", **own),
        case_of("c", program=tmp_path / "a.nc", **{**own, "file": tmp_path / "rows.csv"}),
    ]  # fmt: skip
    found = manifest.file_hashes(cases)
    assert list(found) == [
        *("a.nc", "b.nc", "lists/started.nc", "lists/z.lst", "r.toml", "rows.csv"),
    ]
    for name, digest in found.items():
        assert digest == hashlib.sha256(name.encode()).hexdigest()
    assert "rows.csv" not in manifest.file_hashes(cases[:2])


def test_a_file_is_hashed_anew_when_it_was_written_or_replaced(tmp_path: Path) -> None:
    """Within one second, with as many bytes; or another file with the same time in its place."""
    path, other = tmp_path / "part.nc", tmp_path / "other.nc"
    second_ns = 1_700_000_000 * 10**9

    def written(file: Path, text: bytes, after_ns: int) -> None:
        file.write_bytes(text)
        os.utime(file, ns=(second_ns, second_ns + after_ns))

    written(path, b"G1 Z1", 0)
    assert content_hash(path) == hashlib.sha256(b"G1 Z1").hexdigest()
    written(path, b"G1 Z2", 10**6)
    assert content_hash(path) == hashlib.sha256(b"G1 Z2").hexdigest()
    written(other, b"G1 Z3", 10**6)
    other.replace(path)
    assert content_hash(path) == hashlib.sha256(b"G1 Z3").hexdigest()
    path.unlink()
    assert content_hash(path) == ""


def test_subprograms_are_those_of_every_program_of_a_run_each_once(tmp_path: Path) -> None:
    """Of the program and of one that the PLC starts; a program that another calls is no sub."""
    texts = {
        "part.nc": "%part\nN10 L one.nc\nN20 L both.nc\nN30 M30\n",
        "started.nc": "%started\nN10 L both.nc\nN20 L two.nc\nN30 M30\n",
        "one.nc": "%one\nN10 L deep.nc\nN20 M17\n",
        **{f"{name}.nc": f"%{name}\nN10 M17\n" for name in ("two", "both", "deep")},
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    rig = tmp_path / "rig.toml"
    rig.write_text(RIG.read_text(encoding="utf-8"), encoding="utf-8")
    case = case_of("a", rig, program=tmp_path / "part.nc",
                   inputs={"plc:program_start": "at=motion file=started.nc"})  # fmt: skip
    found = [path.name for path in case_files.subprograms_of(case)]
    assert sorted(found) == ["both.nc", "deep.nc", "one.nc", "two.nc"]
    assert [path.name for path in case_files.files_of_case(case)][:2] == ["part.nc", "started.nc"]
    plain = replace(case, inputs={})
    assert sorted(path.name for path in case_files.subprograms_of(plain)) == [
        "both.nc", "deep.nc", "one.nc",
    ]  # fmt: skip
    (tmp_path / "part.nc").write_text("%part\nN10 L none.nc\nN20 M30\n", encoding="utf-8")
    assert case_files.readable_subprograms(case) == []
