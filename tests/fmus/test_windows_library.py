"""The library for Windows runs: in wine, with the numbers of the one for this platform."""

import importlib.util
import os
import shutil
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from axisrig.bench.tools.fmu.release import courses, walk
from axisrig.fmus import FMI_VERSIONS, MODELS, ensure_built

HOST = Path(__file__).with_name("windows_host.c")
TYPES = {"Real": "r", "Float64": "r", "Integer": "i", "Int32": "i", "Boolean": "b"}
STEP_NS, COUNT = 1_000_000, 1000


@pytest.fixture(scope="module")
def wine(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The command that runs a program for Windows."""
    if importlib.util.find_spec("ziglang") is None:
        pytest.skip("the package ziglang is missing: pip install ziglang")
    places = f"{os.environ['PATH']}{os.pathsep}/usr/lib/wine"  # where Debian's wine64 is
    program = shutil.which("wine64", path=places) or shutil.which("wine")
    if program is None:
        pytest.skip("wine is missing: apt-get install wine64")
    os.environ.setdefault("WINEDEBUG", "-all")
    os.environ["WINEPREFIX"] = str(tmp_path_factory.mktemp("wine"))
    return [program]


@pytest.mark.long
@pytest.mark.parametrize("fmi", FMI_VERSIONS)
@pytest.mark.parametrize("model", [m for m in MODELS if courses()[m][-1].at_s == 0])
def test_library_for_windows_gives_the_numbers_of_this_platform(
    wine: list[str], model: str, fmi: str, tmp_path: Path
) -> None:
    fmu = ensure_built(model, fmi=fmi, platforms=["x86_64-windows"])
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path)
    (library,) = (tmp_path / "binaries").rglob("*.dll")
    host = tmp_path / "host.exe"
    command = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-windows-gnu", "-O1"]
    command += [f"-DFMI={fmi[0]}", "-I", str(tmp_path / "sources"), str(HOST), "-o", str(host)]
    subprocess.run(command, check=True, capture_output=True)
    description = fmpy.read_model_description(str(fmu))
    variables = {v.name: v for v in description.modelVariables}
    here = ensure_built(model, fmi=fmi)
    names, rows = walk(here, courses()[model], STEP_NS, COUNT)
    words = [
        f"s:{variables[c.variable].valueReference}:{TYPES[variables[c.variable].type]}:{c.value!r}"
        for c in courses()[model]
    ]
    words += [f"o:{variables[n].valueReference}:{TYPES[variables[n].type]}" for n in names[1:]]
    done = subprocess.run(
        [*wine, str(host), str(library), str(description.guid), str(STEP_NS), str(COUNT), *words],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = np.array(
        [
            [struct.unpack("<d", struct.pack("<Q", int(word, 16)))[0] for word in line.split()]
            for line in done.stdout.splitlines()
        ]
    )
    expected = np.array(rows)[:, 1:]
    assert found.shape == expected.shape
    assert (np.abs(found - expected) <= 1e-12 * np.ptp(expected, axis=0)).all()
