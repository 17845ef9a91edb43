"""A folder with a rig, its lists and a program, and the command line called inside this process."""

import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.cli.main import main

sys.path.insert(0, str(Path(__file__).parent))  # cli_plan.py

TESTPLANS = Path(__file__).parents[2] / "testplans"

RIG = """\
title = "one axis"

[cycle]
period_us = 1000
cycle_offset_us = 600

[channel]
list = "lists/channel.lst"

[segment.can1]
bitrate = 1_000_000

[drive.servo]
encoder_increments = 1_048_576
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
start = { surface_mm = 129 }
wire = { z = "z" }
"""

# 3 mm above the start nothing is in the way; the run towards 126 meets the workpiece at 129.
PROGRAM = """\
N10 G90 G1 Z132 F3000
N20 G100 Z126 F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 M30
"""


@pytest.fixture(scope="session")
def originals(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder: Path = tmp_path_factory.mktemp("bench")
    shutil.copytree(TESTPLANS / "rigs" / "lists", folder / "lists")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
    (folder / "part.nc").write_text(PROGRAM, encoding="utf-8")
    return folder


@pytest.fixture
def place(originals: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which the commands of a test are called; its files may be changed."""
    shutil.copytree(originals, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    return tmp_path


@pytest.fixture
def axisrig(place: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Call `axisrig` with these words in `place`; gives exit code, standard output and error.

    Any other exception than the end of the process fails the test: it would be a traceback.
    """

    def call(*words: str | Path) -> tuple[int, str, str]:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([str(word) for word in words])
        code = ended.value.code
        assert isinstance(code, int)
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return call


@pytest.fixture
def rejected(
    axisrig: Callable[..., tuple[int, str, str]],
) -> Callable[..., str]:
    """Call `axisrig` and hold it to a rejection: code 2, one message, nothing on standard output.

    Gives the message without `error: `.
    """

    def call(*words: str | Path) -> str:
        code, out, err = axisrig(*words)
        assert (code, out) == (2, ""), err
        lines = err.splitlines()
        assert lines[-1].strip()
        assert lines[0].startswith("error: "), err
        assert sum(line.startswith("error: ") for line in lines) == 1
        return err.removeprefix("error: ").strip()

    return call
