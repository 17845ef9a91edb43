"""Plans in a temporary folder, with the program and the rig they name."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # results_setup.py

PlanWriter = Callable[..., Path]


@pytest.fixture
def write_plan(tmp_path: Path) -> PlanWriter:
    """Return a function that writes a plan as CSV and returns its path."""
    (tmp_path / "probe.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "machine.toml").write_text("[machine]\n", encoding="utf-8")

    def write(text: str, name: str = "probing.csv", encoding: str = "utf-8") -> Path:
        path = tmp_path / name
        path.write_bytes(text.encode(encoding))
        return path

    return write
