"""A Modelica model of the user in a rig: built where something changed, blamed with its line."""

import time
from pathlib import Path

import pytest

from axisrig.bench.machine.fmu_files import plant_path
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.sources import rig_files
from axisrig.bench.rig.settings import read_settings
from axisrig.fmus import build, ensure_own_built, is_ours
from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RAMP = """\
model Ramp "A ramp of the slope of another model"
  Slope slope(k = 3);
  output Real y = slope.k*time;
end Ramp;
"""
SLOPE = """\
model Slope
  parameter Real k = 1;
end Slope;
"""


@pytest.fixture
def models(tmp_path: Path) -> Path:
    folder = tmp_path / "mo"
    folder.mkdir()
    (folder / "Ramp.mo").write_text(RAMP, encoding="utf-8")
    (folder / "Slope.mo").write_text(SLOPE, encoding="utf-8")
    return folder


@pytest.mark.long
def test_a_model_is_built_again_when_it_or_what_it_uses_changes(
    models: Path, tmp_path: Path
) -> None:
    cache = tmp_path / "cache"
    first = ensure_own_built(models / "Ramp.mo", cache)
    assert is_ours(first, cache)
    written = first.stat().st_mtime_ns
    assert ensure_own_built(models / "Ramp.mo", cache) == first
    assert first.stat().st_mtime_ns == written
    time.sleep(0.02)
    (models / "Slope.mo").write_text(SLOPE.replace("k = 1", "k = 2"), encoding="utf-8")
    assert ensure_own_built(models / "Ramp.mo", cache) != first
    # The FMU does what the model says: y = 3 t
    slave = load_fmu(first, "ramp")
    try:
        assert slave.description.modelName.endswith("Ramp")
    finally:
        slave.close()


def _rig(folder: Path, model: str) -> Path:
    rig = folder / "own.toml"
    rig.write_text(
        f'base = "{(RIGS / "probe-z.toml").as_posix()}"\n\n[plant.z]\nfmu = "{model}"\n', "utf-8"
    )
    return rig


def test_a_derived_rig_changes_the_fmu_and_its_files_count(models: Path, tmp_path: Path) -> None:
    (models / "MyAxis.mo").write_text(
        'model MyAxis "Softer"\n  extends AxisRig.Drives.ServoAxis(kv = 30);\nend MyAxis;\n',
        encoding="utf-8",
    )
    rig = _rig(tmp_path, "mo/MyAxis.mo")
    table, files = read_rig(rig)
    assert table.plant["z"].fmu == str(models / "MyAxis.mo")
    assert table.plant["z"].start["position_start_mm"] == 130  # of the base
    names = [path.name for path in rig_files(rig)]
    assert {"MyAxis.mo", "Ramp.mo", "Slope.mo"} <= set(names)
    settings = read_settings(table, files, [])
    path = plant_path(settings, "z", table.plant["z"])
    assert path.name.startswith("MyAxis-")
    assert is_ours(path)


@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("model Bad\n  output Real y;\nequation\n  y = 2*tme;\nend Bad;\n", 4, "tme"),
        ("model Bad\n  output Real y\nequation\n  y = 2;\nend Bad;\n", 2, ""),
        ("model Bad\n  extends AxisRig.Drives.ServoAxes;\nend Bad;\n", 2, "ServoAxes"),
    ],
)
def test_a_mistake_in_a_model_is_blamed_with_its_line(
    models: Path, tmp_path: Path, text: str, line: int, words: str
) -> None:
    (models / "Bad.mo").write_text(text, encoding="utf-8")
    table, files = read_rig(_rig(tmp_path, "mo/Bad.mo"))
    settings = read_settings(table, files, [])
    with pytest.raises(UserError, match="the model cannot be built") as caught:
        plant_path(settings, "z", table.plant["z"])
    assert (caught.value.file, caught.value.line) == (str(models / "Bad.mo"), line)
    assert words in caught.value.message


def test_a_missing_model_is_blamed_on_the_rig(models: Path, tmp_path: Path) -> None:
    rig = _rig(tmp_path, "mo/Nothing.mo")
    table, files = read_rig(rig)
    settings = read_settings(table, files, [])
    with pytest.raises(UserError, match="there is no such model") as caught:
        plant_path(settings, "z", table.plant["z"])
    assert (caught.value.file, caught.value.line) == (str(rig), 4)
    with pytest.raises(build.BuildError, match="there is no such model"):
        ensure_own_built(models / "Nothing.mo")
