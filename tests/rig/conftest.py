"""A rig file with its lists in a folder of its own, to be changed line by line."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RIG = """\
title = "one axis"

[cycle]
cycle_offset_us = 600

[channel]
list = "lists/channel.lst"

[segment.can1]
bitrate = 1_000_000

[drive.servo]
lead_mm = 10.0

[axis.Z]
list = "lists/axis-z.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "z"
probe_1 = "probe"

[plant.z]
fmu = "AxisRig.Drives.ServoAxis"
start = { position_start_mm = 130, kv = 40 }

[plant.probe]
fmu = "AxisRig.Sensors.TouchProbe"
wire = { z = "z" }
"""


@pytest.fixture
def rig_file(tmp_path: Path) -> Callable[..., Path]:
    """Write the rig; each argument is a pair (old text, new text) that must fit once."""
    lists = tmp_path / "lists"
    lists.mkdir()
    (lists / "channel.lst").write_text("messtyp 1\n")
    for axis in "XYZ":
        (lists / f"axis-{axis.lower()}.lst").write_text(f"kopf.log_achs_name {axis}\n")

    def write(*changes: tuple[str, str], name: str = "rig.toml") -> Path:
        text = RIG
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def settings_of() -> Callable[..., Settings]:
    """Read a rig and apply assignments written as on the command line."""

    def read(path: Path, *assignments: str) -> Settings:
        rig, files = read_rig(path)
        return read_settings(
            rig, files, [(parse_assignment(text), as_written) for text in assignments]
        )

    return read


@pytest.fixture
def rig_above(tmp_path: Path, settings_of: Callable[..., Settings]) -> Callable[..., Settings]:
    """Return `rig_above(base, TOML, *assignments)`: settings of a rig above a shipped one."""

    def make(base: str, text: str = "", *assignments: str) -> Settings:
        rig = tmp_path / "rig.toml"
        rig.write_text(f'base = "{(RIGS / base).as_posix()}"\n{text}\n', encoding="utf-8")
        return settings_of(rig, *assignments)

    return make


DRIVE = "[drive.servo]\nlead_mm = 10.0\n"


@pytest.fixture
def with_eds(
    rig_file: Callable[..., Path], settings_of: Callable[..., Settings]
) -> Callable[..., Settings]:
    """Read the rig with an EDS of this text, and these further keys of its drive."""

    def make(text: str, keys: str = "", *changes: tuple[str, str], suffix: str = "eds") -> Settings:
        path = rig_file((DRIVE, f'{DRIVE}eds = "foreign.{suffix}"\n{keys}\n'), *changes)
        (path.parent / f"foreign.{suffix}").write_text(text, encoding="utf-8")
        return settings_of(path)

    return make
