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
        {"inputs": {"plc:V.E.A": "2"}}, {"rig": fmu}, {"program": rig}, {"line": 3},
        {"overridden": frozenset({"plc:V.E.A"})},
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
