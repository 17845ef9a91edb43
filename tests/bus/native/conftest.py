"""The extensions in C, built for these tests with the C compiler of this machine."""

import importlib
import shutil
import subprocess
import sysconfig
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import axisrig.bench.bus.can
import axisrig.bench.bus.can.frame_hash
import axisrig.bench.bus.can.load
import axisrig.bench.bus.can.logs  # with what it imports, these bind `native` before it is there
import axisrig.bench.bus.can.segment
import axisrig.kernel.time

ROOT = Path(__file__).parents[3]
# -Werror: a warning here is a defect
FLAGS = ("-std=c11", "-O1", "-Wall", "-Wextra", "-Werror", "-fPIC", "-shared")
QUIET = ("-Wno-missing-field-initializers", "-Wno-cast-function-type")


def _built(source: Path, folder: Path) -> None:
    compiler = shutil.which("cc")
    headers = Path(sysconfig.get_paths()["include"])
    if compiler is None or not (headers / "Python.h").exists():
        pytest.skip("needs a C compiler (cc) and the headers of Python (python3-dev)")
    target = folder / (source.stem + sysconfig.get_config_var("EXT_SUFFIX"))
    include = [f"-I{headers}", f"-I{ROOT / 'kernel/axisrig/kernel/time'}"]
    words = [compiler, *FLAGS, *QUIET, *include, str(source), "-o", str(target)]
    subprocess.run(words, check=True)


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """Return the extensions: `scheduler`, `line`, `records`."""
    found: dict[str, ModuleType] = {}
    for name, package, path in (
        ("scheduler", axisrig.kernel.time, "kernel/axisrig/kernel/time/_scheduler.c"),
        ("line", axisrig.bench.bus.can, "bench/axisrig/bench/bus/can/_line.c"),
        ("records", axisrig.bench.bus.can, "bench/axisrig/bench/bus/can/_records.c"),
    ):
        folder = tmp_path_factory.mktemp(name)
        module = f"{package.__name__}.{Path(path).stem}"
        if importlib.util.find_spec(module) is None:  # the compiled build has it
            _built(ROOT / path, folder)
            package.__path__.append(str(folder))
            importlib.invalidate_caches()
        found[name] = importlib.import_module(module)
    return SimpleNamespace(**found)
