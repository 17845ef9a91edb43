"""The same models built by OpenModelica, where it is installed: an exporter that is not ours."""

import re
import shutil
import subprocess
import tempfile
import zipfile
from pathlib import Path

from axisrig.fmus.reading.errors import BuildError

_SCRIPT = """setCommandLineOptions("--fmiFlags=s:cvode"); getErrorString();
loadFile("{entry}"); getErrorString();
buildModelFMU({model}, version="{fmi}", fmuType="cs", fileNamePrefix="{name}"); getErrorString();
"""


def omc_identity() -> str:
    """What the installed compiler says about its version. Raises BuildError when there is none."""
    done = _run(["--version"], None)
    return done.stdout.strip()


def build_with_omc(model: str, path: Path, library: Path, fmi: str) -> Path:
    """Let OpenModelica build the FMU of `model` of `library` into the file `path`, and return it.

    Its bytes hold the date of the build: they are not the same twice.
    Raises BuildError with what the compiler says.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    name = re.sub(r"\W", "_", model)
    entry = library / "package.mo" if library.is_dir() else library
    with tempfile.TemporaryDirectory(prefix=".omc-", dir=path.parent) as folder:
        work = Path(folder)
        script = _SCRIPT.format(entry=entry.resolve().as_posix(), model=model, fmi=fmi, name=name)
        (work / "build.mos").write_text(script, encoding="utf-8")
        done = _run(["build.mos"], work)
        built = work / f"{name}.fmu"
        if done.returncode != 0 or not zipfile.is_zipfile(built):
            raise BuildError(library, None, f"OpenModelica says: {_first_error(done.stdout)}")
        built.replace(path)
    return path


def _run(arguments: list[str], folder: Path | None) -> subprocess.CompletedProcess[str]:
    omc = shutil.which("omc")
    if omc is None:
        raise BuildError(None, None, "OpenModelica's omc is not on the PATH")
    command = [omc, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)


def _first_error(said: str) -> str:
    """The first message of the kind [file:1:2-3:4:writable] Error: text, else the last line."""
    found = re.search(r"Error: ([^\n\"]+)", said)
    lines = [line for line in said.splitlines() if line.strip(' "')]
    return found.group(1) if found else lines[-1] if lines else "no FMU and no message"
