"""Files of the blocks of a run: named from the folder of its program."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


@pytest.mark.parametrize("folder", ["", "parts"])
def test_blocks_are_named_from_the_folder_of_their_program(
    tmp_path: Path, run_own: Callable[..., Any], folder: str
) -> None:
    """Wherever it lies: a recording says the same of a run on another machine."""
    here = tmp_path / folder
    here.mkdir(exist_ok=True)
    (here / "first.nc").write_text("%first\nN10 L sub.nc\nN20 G04 Z0.002\nN30 M30\n", "utf-8")
    (here / "sub.nc").write_text("%sub\nN10 G04 Z0.002\nN20 M17\n", "utf-8")
    outcome = run_own(here / "first.nc", RIGS / "probe-z.toml")
    assert outcome.alarms == []
    lines = outcome.facts.blocks.lines
    assert {line.file for line in lines} == {"first.nc", "sub.nc"}
    assert [(line.file, line.text) for line in lines if "G04" in line.text] == [
        ("sub.nc", "N10 G04 Z0.002"), ("first.nc", "N20 G04 Z0.002"),
    ]  # fmt: skip
