"""Memory of the slaves: nothing leaks, nothing is shared, nothing is read before it is written.

`AXISRIG_LIVES=10000 pytest tests/fmus/slave/test_memory.py` runs the full number.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest

from axisrig.fmus import MODELS, ensure_built
from axisrig.fmus.compiler import FLAGS, find_compiler

SERVO = "AxisRig.Drives.ServoAxis"
LIVES = os.environ.get("AXISRIG_LIVES", "25")

linux = pytest.mark.skipif(sys.platform != "linux", reason="reads ELF files and uses dlopen")


@pytest.fixture(scope="module")
def servo_fmu(fmi, unpack):
    return unpack(ensure_built(SERVO, fmi=fmi))


def life_cycle(fmu: Path, folder: Path, fmi: str, build: Path) -> list[str]:
    """The command that lives through `LIVES` lives of an unpacked FMU."""
    source = Path(__file__).with_name("life_cycle.c")
    program = build / "life_cycle"
    headers = ["-I", str(folder / "sources"), f"-DFMI={fmi[0]}"]
    options = ["-std=gnu11", "-g", "-O1", "-Wall", "-Wextra", "-Werror", *headers]
    command = [*find_compiler().command, *options, str(source), "-o", str(program), "-ldl"]
    subprocess.run(command, check=True)
    description = fmpy.read_model_description(str(fmu))
    (library,) = (folder / "binaries").rglob("*.so")
    reference = next(v for v in description.modelVariables if v.name == "force_limit")
    token = str(description.guid)
    return [str(program), str(library), token, LIVES, str(reference.valueReference), "321.5"]


@pytest.mark.long
@linux
@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
def test_lives_leave_no_memory_behind_and_touch_none_that_is_not_theirs(servo_fmu, fmi, tmp_path):
    command = life_cycle(*servo_fmu, fmi, tmp_path)
    watch = ["valgrind", "--leak-check=full", "--show-leak-kinds=all", "--error-exitcode=9"]
    watch += ["--errors-for-leak-kinds=all"]
    done = subprocess.run([*watch, *command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == f"{LIVES} lives, {3 * int(LIVES)} messages\n"
    assert "ERROR SUMMARY: 0 errors" in done.stderr


@pytest.mark.long(but=1)
@linux
@pytest.mark.parametrize("model", MODELS)
def test_sources_compile_without_a_warning_and_share_no_memory(model, fmi, unpack, tmp_path):
    """The object file has no data that can be written: neither .data nor .bss, nor of threads."""
    _, folder = unpack(ensure_built(model, fmi=fmi))
    sources = folder / "sources"
    (source,) = sources.glob("*AxisRig*.c")
    flags = [flag for flag in FLAGS if flag != "-shared"]
    command = [*find_compiler().command, *flags, "-Werror", "-c", source.name]
    command += ["-o", str(tmp_path / "a.o")]
    done = subprocess.run(command, cwd=sources, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    if shutil.which("size") is None:
        pytest.skip("binutils are not installed")
    listed = subprocess.run(
        ["size", "-A", str(tmp_path / "a.o")], capture_output=True, text=True, check=True
    )
    sizes = {row.split()[0]: int(row.split()[1]) for row in listed.stdout.splitlines()[2:-2] if row}
    assert sizes[".text"] > 0
    shared = {
        name: size
        for name, size in sizes.items()
        if size
        and name.startswith((".data", ".bss", ".tdata", ".tbss", ".ldata", ".lbss"))
        # Relocated once when the library is loaded, then read-only
        and not name.startswith(".data.rel.ro")
    }
    assert shared == {}
