"""Shipped rigs with changes, and rigs of a test that stand above them."""

from pathlib import Path

from axisrig.bench.rig import contents
from axisrig.bench.rig.settings import Settings

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def settings_of(rig: Path | str, *changes: str) -> Settings:
    """Settings of a shipped rig, or of a path, with assignments as on the command line."""
    return contents.settings_of(RIGS / rig, changes)


def above(folder: Path, base: str, text: str) -> Path:
    """Write a rig whose base is a shipped one, and return its path."""
    rig = folder / "rig.toml"
    rig.write_text(f'base = "{(RIGS / base).as_posix()}"\n{text}\n', encoding="utf-8")
    return rig
