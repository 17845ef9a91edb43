"""FMUs that come with a wheel: used as long as they are of the sources that are installed."""

import importlib.util
import json
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.build_info import hash_of_sources
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.bench.rig.reading.foreign import foreign_plants
from axisrig.bench.tools.listings import doctor
from axisrig.fmus import MODELS, BuildError, ensure_built, is_ours, place_in_cache
from axisrig.fmus import build as building
from axisrig.fmus.shipped import KEYS, Shipped, sha256_of, shipped

AXIS, PROBE = "AxisRig.Drives.ServoAxis", "AxisRig.Sensors.TouchProbe"


@pytest.fixture
def comes_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Path]:
    """Let this installation have come with FMUs; their keys are right unless `keys` has others."""

    def make(*models: str, keys: Mapping[str, str] = {}) -> Path:
        folder = tmp_path / "shipped"
        folder.mkdir()
        rows = {}
        for model in models:
            file = folder / f"{model.rpartition('.')[2]}.fmu"
            file.write_text(model, encoding="utf-8")
            key = keys.get(model, building.source_key(model))
            rows[model] = {"file": file.name, "key": key, "sha256": sha256_of(file)}
        (folder / KEYS).write_text(json.dumps(rows), encoding="utf-8")
        found = shipped(folder)
        monkeypatch.setattr(building, "shipped", lambda: found)
        return folder

    return make


@pytest.fixture
def without_tools(monkeypatch: pytest.MonkeyPatch) -> None:
    """No C compiler and no rumoca."""
    there = importlib.util.find_spec
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(
        importlib.util,
        "find_spec",
        lambda name, *rest: None if name in ("rumoca", "ziglang") else there(name, *rest),
    )


def test_a_shipped_fmu_serves_without_compilers(
    comes_with: Callable[..., Path], without_tools: None
) -> None:
    folder = comes_with(AXIS, PROBE)
    assert ensure_built(AXIS) == place_in_cache(AXIS) == folder / "ServoAxis.fmu"
    assert ensure_built(PROBE) == folder / "TouchProbe.fmu"
    assert is_ours(folder / "ServoAxis.fmu")
    tables = {"z": PlantTable(fmu=str(folder / "ServoAxis.fmu")), "x": PlantTable(fmu="other.fmu")}
    assert foreign_plants(tables) == ["x"]


def test_others_are_built_and_say_what_that_needs(
    comes_with: Callable[..., Path], without_tools: None, tmp_path: Path
) -> None:
    comes_with(AXIS)
    for asked in (
        {"model": PROBE},
        {"model": AXIS, "fmi": "2.0"},
        {"model": AXIS, "compiler": "zig"},
        {"model": AXIS, "cache_dir": tmp_path},
        {"model": AXIS, "platforms": ["x86_64-windows"]},
    ):
        with pytest.raises(BuildError, match=r"axisrig\[cc\]"):
            ensure_built(**asked)


def test_a_model_of_ones_own_needs_the_modelica_compiler(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    there = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *r: None if name == "rumoca" else there(name, *r)
    )
    with pytest.raises(BuildError, match=r"pip install 'axisrig\[models\]'"):
        building.build(AXIS, tmp_path / "axis.fmu")


@pytest.mark.parametrize("fault", ["other sources", "damaged", "lost"])
def test_an_fmu_of_other_sources_or_bytes_is_not_used(
    comes_with: Callable[..., Path], fault: str
) -> None:
    """Beside one that is right, before and after."""
    folder = comes_with(AXIS, PROBE, keys={AXIS: "0" * 64} if fault == "other sources" else {})
    if fault == "damaged":
        (folder / "ServoAxis.fmu").write_text("another", encoding="utf-8")
    if fault == "lost":
        (folder / "ServoAxis.fmu").unlink()
    assert place_in_cache(PROBE).parent == folder
    assert place_in_cache(AXIS).parent != folder


def test_the_key_is_that_of_the_sources_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = [building.source_key(model) for model in MODELS]
    assert len(set(keys)) == len(MODELS)
    monkeypatch.setattr(building, "_rumoca", lambda: "another")
    assert building.source_key(MODELS[0]) == keys[0]
    monkeypatch.setattr(building, "_version", lambda: "another")
    assert building.source_key(MODELS[0]) != keys[0]


def test_a_checkout_has_none() -> None:
    assert shipped() == {}


def test_shipped_fmus_do_not_change_the_hash_of_the_sources(tmp_path: Path) -> None:
    (tmp_path / "fmus").mkdir()
    (tmp_path / "fmus" / "build.py").write_text("1", encoding="utf-8")
    before = hash_of_sources([tmp_path])
    (tmp_path / "fmus" / "shipped").mkdir()
    (tmp_path / "fmus" / "shipped" / KEYS).write_text("{}", encoding="utf-8")
    assert hash_of_sources([tmp_path]) == before
    (tmp_path / "fmus" / "shipped.py").write_text("1", encoding="utf-8")
    assert hash_of_sources([tmp_path]) != before


def test_the_doctor_lacks_no_compiler_where_all_came_with_the_wheel(
    comes_with: Callable[..., Path], without_tools: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "find_spec", lambda name: None)
    lines = list(doctor.examine())
    assert any(line.startswith(doctor.LACK) and "C compiler" in line for line in lines)
    comes_with(*MODELS)
    lines = list(doctor.examine())
    assert [line for line in lines if line.startswith(doctor.LACK)] == []
    assert f"ok    {AXIS}: ServoAxis.fmu, shipped" in lines
    assert any("slower build" in line for line in lines)


def test_a_row_names_its_file(tmp_path: Path) -> None:
    (tmp_path / KEYS).write_text('{"M": {"file": "m.fmu", "key": "k", "sha256": "s"}}')
    assert shipped(tmp_path) == {"M": Shipped(tmp_path / "m.fmu", "k", "s")}
