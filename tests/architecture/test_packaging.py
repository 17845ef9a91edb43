"""What is installed: the wheel holds axisrig and nothing else, and works without the checkout."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("kernel", "bench", "fmus", "reports")
RIG = ROOT / "testplans/rigs/probe-xyz.toml"
PROGRAM = ROOT / "testplans/programs/meas1.nc"
SELECTION = ("tests/kernel/test_errors.py", "tests/nc/test_nc_units_and_relative.py")


def _run(*command: object, cwd: Path) -> str:
    """Return the standard output of a command that ends with 0 and sees no PYTHON... variable."""
    ended = subprocess.run(
        list(map(str, command)), cwd=cwd, capture_output=True, text=True, check=False,
        env={key: value for key, value in os.environ.items() if not key.startswith("PYTHON")},
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


def _built(target: str, checkout: Path, folder: Path) -> Path:
    _run(sys.executable, "-m", "hatchling", "build", "-t", target, "-d", folder, cwd=checkout)
    (path,) = folder.iterdir()
    return path


def _names(wheel: Path) -> list[str]:
    with zipfile.ZipFile(wheel) as archive:
        return sorted(archive.namelist())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _built("wheel", ROOT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the interpreter of a fresh environment: the wheel, and what it depends on.

    The packages it depends on are those of the environment of this test; a path that a .pth file
    names is searched, but its own .pth files, one of which leads to the checkout, are not read.
    """
    env = tmp_path_factory.mktemp("fresh") / "env"
    _run(sys.executable, "-m", "venv", "--without-pip", env, cwd=env.parent)
    places = sysconfig.get_paths("venv", {"base": str(env), "platbase": str(env)})
    python = Path(places["scripts"]) / Path(sys.executable).name
    packages = Path(places["purelib"])
    assert list(packages.iterdir()) == []
    pip = (sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "--no-index")
    _run(*pip, "--no-compile", "--disable-pip-version-check", wheel, cwd=env.parent)
    names = sorted(path.name.partition("-")[0] for path in packages.iterdir())
    assert names == ["axisrig", "axisrig"], names  # the packages, and their dist-info
    (packages / "dependencies.pth").write_text(
        "\n".join({sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}), "utf-8"
    )
    return python


def test_the_wheel_holds_every_file_of_the_source_folders_and_no_other(wheel: Path) -> None:
    files = {
        path.relative_to(ROOT / folder).as_posix()
        for folder in FOLDERS
        for path in (ROOT / folder / "axisrig").rglob("*")
        if path.is_file() and path.suffix != ".pyc"
    }
    files |= {
        f"axisrig/reports/documents/{path.relative_to(ROOT / 'docs').as_posix()}"
        for path in (ROOT / "docs").rglob("*")
        if path.is_file() and path.suffix != ".pyc"
    }
    # At the top level nothing but the one name; it is a namespace package
    packed = [name for name in _names(wheel) if ".dist-info/" not in name]
    assert {name.partition("/")[0] for name in packed} == {"axisrig"}
    assert "axisrig/__init__.py" not in packed
    assert sorted(files) == packed
    assert {f"axisrig/{name}/py.typed" for name in FOLDERS} <= files  # users' code is type-checked
    data = {Path(name).suffix for name in packed}
    assert data >= {".py", ".csv", ".lark", ".html", ".js", ".css", ".c", ".h", ".inc", ".mo"}


@pytest.mark.long
def test_an_editable_install_has_no_copy_of_its_own(tmp_path: Path) -> None:
    """A copy of the documents would be shown in the place of those of the checkout."""
    program = "from hatchling.build import build_editable as b; import sys; b(sys.argv[1])"
    _run(sys.executable, "-c", program, tmp_path, cwd=ROOT)
    (path,) = tmp_path.iterdir()
    names = {name for name in _names(path) if ".dist-info/" not in name}
    assert names == {"_axisrig.pth"}


@pytest.mark.long
def test_the_sdist_gives_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    with tarfile.open(_built("sdist", ROOT, tmp_path / "sdist")) as archive:
        archive.extractall(tmp_path / "unpacked", filter="data")
    (checkout,) = (tmp_path / "unpacked").iterdir()
    assert _names(_built("wheel", checkout, tmp_path / "wheel")) == _names(wheel)


@pytest.mark.long
def test_nothing_of_the_checkout_is_imported(python: Path, tmp_path: Path) -> None:
    code = (
        "import importlib.util as u, axisrig, axisrig.bench.cli.main as m\n"
        f"print([n for n in {FOLDERS} if u.find_spec(n)], len(axisrig.__path__), m.__file__)"
    )
    names, count, file = _run(python, "-c", code, cwd=tmp_path).split()
    assert (names, count) == ("[]", "1")
    assert Path(file).is_relative_to(python.parents[1])


@pytest.mark.long
def test_module_and_console_script_run_a_program_in_another_folder(
    python: Path, tmp_path: Path
) -> None:
    script = python.with_name("axisrig" + python.suffix)
    for start in ([python, "-m", "axisrig.bench.cli"], [script]):
        text = _run(*start, "nc", PROGRAM, "--rig", RIG, cwd=tmp_path)
        assert text.splitlines()[:2] == [
            "V.A.MESS.Z=100.000000",
            "V.A.MEAS.ACS.VALUE.Z=100.000000",
        ]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long
def test_tests_and_plans_pass_with_the_installed_wheel(python: Path, tmp_path: Path) -> None:
    pytest_ = (python, "-m", "pytest", "-q", "-p", "no:cacheprovider")
    _run(*pytest_, *(ROOT / name for name in SELECTION), cwd=tmp_path)
    plans = tmp_path / "plans"
    for name in ("programs", "rigs"):
        shutil.copytree(ROOT / "testplans" / name, plans / name)
    for name in ("conftest.py", "latch_accuracy.csv"):
        shutil.copy(ROOT / "testplans" / name, plans)
    ended = _run(*pytest_, plans, "-k", "f3000 and not ff", cwd=tmp_path)
    assert "1 passed" in ended


@pytest.mark.long
def test_a_new_project_runs_from_the_wheel(python: Path, tmp_path: Path) -> None:
    """In an empty folder outside the checkout, with a model that is built there."""
    command = (python, "-m", "axisrig.bench.cli")
    _run(*command, "new", "bench", cwd=tmp_path)
    project = tmp_path / "bench"
    printed = _run(*command, "run", "testplans/touch.csv", cwd=project)
    assert printed.split()[-1] == str(Path("out") / "touch" / "report.html")
    rows = (project / "out" / "touch" / "cases.csv").read_text(encoding="utf-8").splitlines()
    assert sum(",pass," in row for row in rows if "pretravel-s" not in row) == 5
