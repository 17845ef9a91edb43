"""What FMUs write to standard output: whose it may be, and that it goes to its file."""

import json
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.rig import fmu_output
from axisrig.bench.rig.fmu_output import divert, printed_lines, printed_log


@pytest.mark.parametrize(
    ("fmus", "who"),
    [
        ({"z": "/x/own.fmu"}, "plant z"),
        ({"z": "/x/own.fmu", "probe": "/x/own.fmu"}, "plants z, probe"),
        ({"y": "AxisRig.Drives.ServoAxis", "z": "/x/own.fmu", "w": "own.mo"}, "plant z"),
        ({"y": "AxisRig.Drives.ServoAxis", "w": "own.mo"}, "a plant"),
    ],
)
def test_output_is_that_of_the_plants_that_are_code_from_outside(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, fmus: dict[str, str], who: str
) -> None:
    """A plant whose axis is a real one does not run here."""
    plants = {name: SimpleNamespace(fmu=fmu) for name, fmu in fmus.items()}
    monkeypatch.setattr(fmu_output, "simulated_plants", lambda settings: settings.plants)
    settings: Any = SimpleNamespace(plants=plants, rig=SimpleNamespace(plant=plants | {"away": 0}))
    monkeypatch.setattr(fmu_output, "_FILES", [])
    assert printed_log(settings) == []
    (tmp_path / "out").write_text("one\n\ntwo\n", encoding="utf-8")
    monkeypatch.setattr(fmu_output, "_FILES", [tmp_path / "out"])
    assert printed_log(settings) == [
        f"{who} wrote to standard output: {word}" for word in ("one", "two")
    ]


@pytest.mark.skipif(os.name != "posix", reason="forks")
def test_standard_output_goes_to_the_file_that_was_named_last(tmp_path: Path) -> None:
    """A file from before is emptied; what was written earlier stays where it was."""
    first, second, found = (tmp_path / name for name in ("first", "second", "found"))
    second.write_text("of another run\n", encoding="utf-8")
    child = os.fork()
    if not child:  # standard output belongs to the process
        try:
            divert(first)
            os.write(1, b"one\n")
            lines = [printed_lines()]
            divert(second)
            os.write(1, b"two\nthree\n")
            lines.append(printed_lines())
            found.write_text(json.dumps(lines), encoding="utf-8")
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    assert json.loads(found.read_text("utf-8")) == [["one"], ["two", "three"]]
    assert (first.read_text("utf-8"), second.read_text("utf-8")) == ("one\n", "two\nthree\n")
    assert first.stat().st_mode & 0o077 == 0
