"""The exporter: repeatable bytes, a cache that is right, and no silently wrong FMU."""

import math
import os
import shutil
import subprocess
import sys
import zipfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest
import rumoca
from fmpy.fmi1 import FMICallException

import axisrig.fmus.build as building
from axisrig.fmus import MODELS, BuildError, ensure_built, is_ours
from axisrig.fmus.compiler import find_compiler

UNSUPPORTED = {
    "delay": ("y = delay(time, 0.1); n = 0; x = 0;", "delay()"),
    "unit": ("y = z; n = 0; x = 0;", "unit furlong is not known"),
}
MODEL = """package Small
  function square input Real u; output Real v; algorithm v := u*u; end square;
  model Plant
    output Real y(unit="1") "Result";
    Real x(start=1);
    Integer n(start=0);
    {declaration}
  equation
    {equation}
  end Plant;
end Small;
"""
LINE = 9  # of {equation} in MODEL


def library(folder: Path, equation: str, declaration: str = "") -> Path:
    """A library with one model."""
    root = folder / "Small"
    root.mkdir(parents=True)
    text = MODEL.replace("{equation}", equation).replace("{declaration}", declaration)
    (root / "package.mo").write_text(text, encoding="utf-8")
    return root


def small(folder: Path, equation: str, declaration: str = "") -> Path:
    """The FMU of a library with one model."""
    root = library(folder, equation, declaration)
    return building.build("Small.Plant", folder / "plant.fmu", root, is_optimised=False)


@pytest.mark.parametrize("name", UNSUPPORTED)
def test_unsupported_construct_stops_the_build_with_file_and_line(tmp_path, name):
    equation, message = UNSUPPORTED[name]
    declaration = 'parameter Real z(unit="furlong") = 1;' if name == "unit" else ""
    with pytest.raises(BuildError, match=message.replace("(", r"\(").replace(")", r"\)")) as error:
        small(tmp_path, equation, declaration)
    assert error.value.file == "Small/package.mo"
    assert error.value.line == (LINE - 2 if name == "unit" else LINE)
    assert not list(tmp_path.glob("*.fmu"))


def test_syntax_error_is_told_with_file_and_line(tmp_path):
    with pytest.raises(BuildError) as error:
        small(tmp_path, "y = ; n = 0; x = 0;")
    assert (error.value.file, error.value.line) == ("Small/package.mo", LINE)


def test_unknown_name_is_told_with_file_and_line(tmp_path):
    with pytest.raises(BuildError, match="nowhere") as error:
        small(tmp_path, "y = nowhere; n = 0; x = 0;")
    assert (error.value.file, error.value.line) == ("Small/package.mo", LINE)


def test_start_value_that_would_not_follow_its_parameter_is_refused(tmp_path):
    declaration = 'parameter Real p(unit="1") = 2; discrete Real d(start=p, fixed=true);'
    with pytest.raises(BuildError, match="start of d must not depend on a parameter"):
        small(tmp_path, "when time > 1 then d = 0; end when; y = d; n = 0; x = 0;", declaration)


def test_other_schema_of_the_compiler_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("axisrig.fmus.reading.ir.SCHEMA_VERSION", 70)
    with pytest.raises(BuildError, match="schema 71, not 70"):
        small(tmp_path, "y = time; n = 0; x = 0;")


@pytest.mark.long
def test_two_builds_have_the_same_bytes(tmp_path):
    first = building.build(MODELS[0], tmp_path / "a" / "x.fmu")
    second = building.build(MODELS[0], tmp_path / "b" / "x.fmu")
    assert first.read_bytes() == second.read_bytes()


def test_cache_is_used_and_follows_the_sources(tmp_path, monkeypatch):
    path = ensure_built(MODELS[1])
    stamp = path.stat().st_mtime_ns
    assert ensure_built(MODELS[1]) == path
    assert path.stat().st_mtime_ns == stamp
    root = library(tmp_path, "y = time; n = 0; x = 0;")
    before = building.cache_key("Small.Plant", root)
    assert building.cache_key("Small.Plant", root) == before
    assert building.cache_key("Small.Plant", root, step_s=20e-6) != before
    (root / "package.mo").write_text("package Small end Small;", encoding="utf-8")
    assert building.cache_key("Small.Plant", root) != before


def test_models_of_one_text_under_two_names_are_two(tmp_path):
    """Messages of an FMU name the file that its equations come from."""
    keys = []
    for name in ("Plant.mo", "Other.mo"):
        (tmp_path / name).write_text("model Plant end Plant;", encoding="utf-8")
    for name in ("Plant.mo", "Other.mo", "Plant.mo"):
        keys.append(building.cache_key("Plant", tmp_path / name))
    assert keys[0] == keys[2] != keys[1]


@pytest.mark.long
def test_damaged_fmu_in_the_cache_is_built_again(tmp_path):
    path = ensure_built(MODELS[-2], tmp_path)
    good = path.read_bytes()
    assert is_ours(path, tmp_path)
    for bad in (b"", good + b"\0", good[: len(good) // 2]):
        path.write_bytes(bad)
        assert not is_ours(path, tmp_path)
    assert ensure_built(MODELS[-2], tmp_path) == path
    assert path.read_bytes() == good


EXPORTER = Path(building.__file__).parent
# What no FMU depends on: what only people read
ASIDE = ("__pycache__", "package.order", "py.typed")
FILES = sorted(
    path.relative_to(EXPORTER)
    for path in EXPORTER.rglob("*")
    if path.is_file() and not set(ASIDE) & set(path.relative_to(EXPORTER).parts)
)
KEYS = """
import sys
from pathlib import Path
from axisrig.fmus import build
from axisrig.fmus.build import cache_key
root = Path(build.__file__).parent
assert root.parents[1] == Path.cwd()
print(cache_key("AxisRig.Drives.ServoAxis"))
for name in sys.stdin.read().splitlines():
    file = root / name
    good = file.read_bytes()
    file.write_bytes(good + b" ")
    print(cache_key("AxisRig.Drives.ServoAxis"))
    file.write_bytes(good)
print(cache_key("AxisRig.Drives.ServoAxis"))
"""


@pytest.mark.long
def test_cache_key_changes_with_every_file_of_exporter_and_library(tmp_path):
    """On a copy that is imported in its own place."""
    aside = shutil.ignore_patterns("__pycache__")
    shutil.copytree(EXPORTER, tmp_path / "axisrig" / "fmus", ignore=aside)
    ended = subprocess.run(
        [sys.executable, "-c", KEYS], cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(tmp_path)},
        input="\n".join(path.as_posix() for path in FILES),
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    first, *changed, last = ended.stdout.split()
    assert first == last
    assert {path.suffix for path in FILES} == {
        *(".py", ".csv", ".h", ".inc", ".jinja", ".toml", ".txt", ".mo"),
    }
    assert [str(f) for f, key in zip(FILES, changed, strict=True) if key == first] == []
    assert len(set(changed)) == len(FILES)


@pytest.mark.long
def test_two_processes_may_build_at_once(tmp_path):
    with ProcessPoolExecutor(2) as pool:
        paths = list(pool.map(ensure_built, [MODELS[-2]] * 2, [tmp_path] * 2))
    assert paths[0] == paths[1]
    assert sorted(p.name for p in tmp_path.iterdir()) == [paths[0].name, "sha256"]
    assert zipfile.ZipFile(paths[0]).testzip() is None


def test_unknown_model_is_refused():
    with pytest.raises(BuildError, match=r"no model AxisRig\.Nothing; there are"):
        ensure_built("AxisRig.Nothing")


def test_missing_c_compiler_tells_what_to_install(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(BuildError, match=r"axisrig\[cc\]"):
        find_compiler()


@pytest.mark.long
def test_time_events_are_located(tmp_path, load):
    """x' is 1, then 3 from t = 0.1234567 on: x is exact although the step lies across it."""
    equation = "der(x) = if time < p then 1 else 3; y = x; when time >= p then n = 7; end when;"
    plant = load(small(tmp_path, equation, 'parameter Real p(unit="s") = 0.5;'), p=0.1234567)
    plant.step(0.1)
    assert plant.n == 0
    plant.step(0.1)
    assert plant.n == 7
    assert plant.y == pytest.approx(1 + 0.1234567 + 3 * (0.2 - 0.1234567), abs=1e-10)


@pytest.mark.long
def test_state_events_are_located(tmp_path, load):
    """x = sin t by its oscillator; n counts where it rises through 0.5."""
    declaration = 'Real v(start=1); discrete output Real t_up(unit="s", start=0) "Crossing";'
    equation = (
        "der(x) = v; der(v) = -(x - 1); y = x;"
        " when x > 1.5 then n = pre(n) + 1; t_up = time; end when;"
    )
    plant = load(small(tmp_path, equation, declaration))
    for k in range(1, 15):
        plant.step(0.5)
        assert plant.y == pytest.approx(1 + math.sin(0.5 * k), abs=1e-12)
    assert plant.n == 2
    assert plant.t_up == pytest.approx(2 * math.pi + math.pi / 6, abs=1e-9)


@pytest.mark.long
def test_fifth_order_of_the_integration(tmp_path, load):
    """Halving the internal step divides the error of an oscillator by 32."""
    root = library(tmp_path, "der(x) = v; der(v) = -100*x; y = x; n = 0;", "Real v(start=0);")
    errors = []
    for step in (4e-3, 2e-3):
        path = building.build("Small.Plant", tmp_path / f"{step}.fmu", root, step_s=step)
        plant = load(path)
        plant.step(2.0)
        errors.append(abs(plant.y - math.cos(20.0)))
    assert errors[0] / errors[1] == pytest.approx(32, rel=0.1)


@pytest.mark.long
def test_fast_transition_is_resolved_however_long_the_internal_step(tmp_path, load):
    """x' = -tanh(x/1e-5) from 1: x falls with slope 1 and stops within 1e-5; sinh decays."""
    root = library(tmp_path, "der(x) = -tanh(x/1e-5); y = x; n = 0;")
    plant = load(building.build("Small.Plant", tmp_path / "x.fmu", root, step_s=2e-3))
    plant.step(1.0 + 2e-5)
    # sinh(x/w) = sinh(1/w) exp(-t/w), w = 1e-5; sinh(1/w) = exp(1/w)/2
    assert plant.y == pytest.approx(1e-5 * math.asinh(0.5 * math.exp(-2.0)), abs=1e-12)


@pytest.mark.long
def test_divergence_names_variable_and_time(tmp_path, load):
    plant = load(small(tmp_path, "der(x) = 1000*x*x; y = x; n = 0;"))
    with pytest.raises(FMICallException):
        plant.step(0.1)
    assert "x is not a finite number at t = 0.00" in plant.messages[-1]


@pytest.mark.long
def test_chatter_ends_with_the_place_of_the_relation(tmp_path, load):
    plant = load(small(tmp_path, "der(x) = if x > 0 then -1 else 1; y = x; n = 0;"))
    plant.step(0.99)
    with pytest.raises(FMICallException):
        plant.step(0.1)
    assert f"relation at Small/package.mo:{LINE}" in plant.messages[-1]


@pytest.mark.long
def test_restless_discrete_equations_are_an_error(tmp_path, load):
    """b = not b, once the clock has passed 0.5 s."""
    equation = "b = time > 0.5 and not pre(b); n = if b then 1 else 0; y = n; x = 0;"
    plant = load(small(tmp_path, equation, "Boolean b(start=false, fixed=true);"))
    plant.step(0.4)
    with pytest.raises(FMICallException):
        plant.step(0.2)
    assert "do not come to rest at t = 0.5" in plant.messages[-1]


@pytest.mark.long
def test_failed_assertion_tells_text_and_place(tmp_path, load):
    plant = load(small(tmp_path, 'y = time; n = 0; x = 0; assert(y < 0.5, "too far");'))
    plant.step(0.4)
    with pytest.raises(FMICallException):
        plant.step(0.2)
    assert plant.messages[-1].startswith(f"Small/package.mo:{LINE}: too far (t = 0.5")


@pytest.mark.long
def test_exported_model_agrees_with_the_compilers_own_solver(servo):
    """SteadyLag through another solver of the same source: lag of 2 mm at 20 mm/s, Kv 10 1/s."""
    entry = building.LIBRARY / "package.mo"
    model = rumoca.Session().load(str(entry), model="AxisRig.Examples.SteadyLag")
    result = model.simulate(t=(0, 3), dt=0.01)
    assert result["lag"][-1] == pytest.approx(2e-3, abs=1e-9)
    axis = servo(enabled=True)
    axis.set(reference_velocity=0.02, reference_end=100.0)
    axis.step(3.0)
    assert axis.demand_position - axis.position == pytest.approx(result["lag"][-1], abs=1e-8)


def test_import_of_the_package_does_not_load_fmpy():
    code = "import sys, fmus; print('fmpy' in sys.modules)"
    root = Path(building.__file__).parents[1]
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root)
    assert done.stdout.strip() == "False"
