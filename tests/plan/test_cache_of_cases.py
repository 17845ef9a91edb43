"""Cases that a process has prepared are kept while their files are the same."""

import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import preparing
from axisrig.bench.campaign.preparing import Prepared, forget, recall
from axisrig.bench.plan.checks import parse_check
from axisrig.kernel.nc.text.parser import read_program


def test_a_prepared_case_is_known_as_long_as_its_files_are_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    forget()
    program, rig, fmu = (tmp_path / name for name in ("part.nc", "rig.toml", "a.fmu"))
    for path in (program, rig, fmu):
        path.write_text("first", encoding="utf-8")
    case = case_of("a", rig, program=program, inputs={"plc:V.E.A": "1"})
    settings = SimpleNamespace(is_checked=False)
    prepared: Any = Prepared(settings, SimpleNamespace(blocks=[], subprograms={}))  # type: ignore[arg-type]
    monkeypatch.setattr(preparing, "started_files", lambda _: [])
    files = [program, rig, fmu]

    def keep() -> None:
        preparing._keep(case, prepared, files, preparing._content(files))

    assert recall(case) is None
    keep()
    assert recall(case) is prepared
    assert settings.is_checked is True
    for other in (
        {"inputs": {"plc:V.E.A": "2"}}, {"inputs": {"plc:V.E.B": "1"}}, {"rig": fmu},
        {"program": rig}, {"line": 3}, {"overridden": frozenset({"plc:V.E.A"})},
    ):  # fmt: skip
        assert recall(replace(case, **other)) is None, other
    assert recall(replace(case, title="another")) is prepared
    for path in files:
        text = path.read_text(encoding="utf-8")
        path.write_text("second", encoding="utf-8")
        os.utime(path, ns=(1, 1))
        assert recall(case) is None, path
        path.write_text(text, encoding="utf-8")
        keep()
        assert recall(case) is prepared
    program.unlink()
    assert recall(case) is None
    # One that was written while the case was read is not kept
    preparing._keep(case, prepared, [rig], [b"before"])
    assert recall(case) is None
    forget()


GLOBAL, LOCAL = "N10 L other.nc\n", "N10 LL SUB\n"


@pytest.mark.parametrize(
    ("text", "is_kept"),
    [
        ("%MAIN\nN10 G4 1\nM30\n", True),
        (f"%L SUB\nN5 G4 1\nM29\n%MAIN\n{LOCAL}M30\n", True),
        (f"%MAIN\n{GLOBAL}M30\n", False),
        ("%MAIN\nN10 L CYCLE [NAME=other.cyc @P1=3]\nM30\n", False),
        # In a subprogram of its own, in the first or in a later one, called or not
        (f"%L SUB\n{GLOBAL}M29\n%MAIN\n{LOCAL}M30\n", False),
        (f"%L SUB\n{GLOBAL}M29\n%MAIN\nN10 G4 1\nM30\n", False),
        (f"%L SUB\nN5 G4 1\nM29\n%L TWO\n{GLOBAL}M29\n%MAIN\n{LOCAL}M30\n", False),
        # Within a branch, and behind another call
        (f"%MAIN\nN5 $IF V.E.A == 1\n{GLOBAL}N15 $ENDIF\nM30\n", False),
        (f"%L SUB\nN5 G4 1\nM29\n%MAIN\n{LOCAL}{GLOBAL}M30\n", False),
    ],
)
def test_a_case_whose_programs_call_other_files_is_read_every_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, is_kept: bool
) -> None:
    """These files may change; subprograms of the same file change with it."""
    forget()
    monkeypatch.setattr(preparing, "started_files", lambda _: [])
    path = tmp_path / "part.nc"
    path.write_text(text, encoding="utf-8")
    case = case_of("a", program=path)
    prepared = Prepared(SimpleNamespace(is_checked=False), read_program(path, ("Z",)))  # type: ignore[arg-type]
    preparing._keep(case, prepared, [path], preparing._content([path]))
    assert (recall(case) is prepared) is is_kept
    forget()


@pytest.mark.parametrize(
    ("inputs", "started", "is_kept"),
    [
        ({}, [], True),
        ({}, ["second.nc"], False),
        ({"drive:servo.eds": "a.eds"}, [], False),
        ({"drive:servo.pdo_map": "map.csv"}, [], False),
        ({"plc:V.E.A": "1", "drive:servo.pdo_map": "map.csv"}, [], False),
        ({"drive:servo.lead_mm": "5"}, [], True),
    ],
)
def test_a_case_with_files_beside_rig_and_program_is_read_every_time(
    monkeypatch: pytest.MonkeyPatch, inputs: dict[str, str], started: list[str], is_kept: bool
) -> None:
    """Programs that the PLC side starts, and what cells name for a drive."""
    forget()
    monkeypatch.setattr(preparing, "started_files", lambda _: started)
    case = case_of("a", inputs=inputs)
    settings: Any = SimpleNamespace(is_checked=False)
    prepared = Prepared(settings, SimpleNamespace(blocks=[], subprograms={}))  # type: ignore[arg-type]
    preparing._keep(case, prepared, [], [])
    assert (recall(case) is prepared) is is_kept
    assert settings.is_checked is is_kept
    forget()


@pytest.mark.parametrize("name", ["case", "file", "places", "checks", "sampled", "line"])
def test_whatever_is_looked_at_when_a_case_is_prepared_tells_it_from_others(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    forget()
    monkeypatch.setattr(preparing, "started_files", lambda _: [])
    settings: Any = SimpleNamespace(is_checked=False)
    prepared = Prepared(settings, SimpleNamespace(blocks=[], subprograms={}))  # type: ignore[arg-type]
    case = case_of("a")
    preparing._keep(case, prepared, [], [])
    other: Any = {
        "case": "b", "file": Path("rows.csv"), "places": {"plc:V.E.A": None}, "line": 7,
        "checks": (parse_check("alarms", "none", ""),),
        "sampled": (parse_check("alarms", "none", ""),),
    }[name]  # fmt: skip
    assert recall(replace(case, **{name: other})) is None
    assert recall(case) is prepared
    forget()


def test_only_so_many_cases_are_kept_the_oldest_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    forget()
    monkeypatch.setattr(preparing, "KEPT_MAX", 2)
    monkeypatch.setattr(preparing, "started_files", lambda _: [])
    cases = [case_of(run, line=line) for line, run in enumerate("abc", start=2)]
    prepared: Any = Prepared(
        SimpleNamespace(is_checked=False),  # type: ignore[arg-type]
        SimpleNamespace(blocks=[], subprograms={}),  # type: ignore[arg-type]
    )
    for case in cases[:2]:
        preparing._keep(case, prepared, [], [])
    recall(cases[0])  # asked last
    preparing._keep(cases[2], prepared, [], [])
    assert [recall(case) is prepared for case in cases] == [True, False, True]
    forget()
    assert recall(cases[0]) is None


def test_an_fmu_is_another_one_by_its_time_its_size_or_its_place_on_the_disk(
    tmp_path: Path,
) -> None:
    """One that was built elsewhere and put in place may have the same time and the same size."""
    fmu, other = tmp_path / "a.fmu", tmp_path / "b.fmu"
    for path, text in ((fmu, "first"), (other, "other")):
        path.write_text(text, encoding="utf-8")
        os.utime(path, ns=(5, 5))
    before = preparing._content([fmu])
    assert preparing._content([fmu]) == before
    other.replace(fmu)
    replaced = preparing._content([fmu])
    os.utime(fmu, ns=(6, 6))
    touched = preparing._content([fmu])
    fmu.write_text("longer", encoding="utf-8")
    os.utime(fmu, ns=(6, 6))
    longer = preparing._content([fmu])
    fmu.unlink()
    states = [before, replaced, touched, longer, preparing._content([fmu])]
    assert all(one != two for at, one in enumerate(states) for two in states[:at])
