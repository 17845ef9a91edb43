"""The C compiler that turns generated sources into the library of an FMU."""

import importlib.util
import platform
import shutil
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from fmus.errors import BuildError

# No fast-math and no contraction: the same sources give the same bits of results. No debug
# information: it would hold the folder of the build.
FLAGS = (
    "-std=c11",
    "-O2",
    "-g0",
    "-fPIC",
    "-shared",
    "-ffp-contract=off",
    "-fno-fast-math",
    "-fvisibility=hidden",
    "-Wall",
    "-Wextra",
    "-Werror=implicit-function-declaration",
)
LINK = ("-lm",)


@dataclass(frozen=True)
class Compiler:
    """A C compiler. command: how it is called. identity: what it says about its version."""

    command: tuple[str, ...]
    identity: str


@dataclass(frozen=True)
class Platform:
    """Where an FMU runs: folder by FMI 3.0 and by FMI 2.0, and ending of a shared library."""

    folder: str
    folder_fmi2: str
    ending: str


@cache
def find_compiler() -> Compiler:
    """The system's `cc`, else the one of the package ziglang.

    Raises BuildError when there is none.
    """
    if (cc := shutil.which("cc")) is not None:
        return _asked((cc,))
    if importlib.util.find_spec("ziglang") is not None:
        return _asked((sys.executable, "-m", "ziglang", "cc"))
    raise BuildError(
        None, None, 'no C compiler; install one, or the package: pip install "axisrig[cc]"'
    )


def _asked(command: tuple[str, ...]) -> Compiler:
    """Ask a compiler who it is."""
    result = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise BuildError(None, None, f"{' '.join(command)} does not run: {result.stderr.strip()}")
    machine = subprocess.run(
        [*command, "-dumpmachine"], capture_output=True, text=True, check=False
    )
    return Compiler(command, f"{result.stdout.strip()}\n{machine.stdout.strip()}")


def this_platform() -> Platform:
    """The platform of this interpreter in the words of FMI 3.0.

    Raises BuildError for one that has no word there.
    """
    systems = {
        "linux": Platform("linux", "linux64", ".so"),
        "win32": Platform("windows", "win64", ".dll"),
        "darwin": Platform("darwin", "darwin64", ".dylib"),
    }
    machines = {
        "x86_64": "x86_64",
        "amd64": "x86_64",
        "aarch64": "aarch64",
        "arm64": "aarch64",
    }
    system = systems.get(sys.platform)
    machine = machines.get(platform.machine().lower())
    if system is None or machine is None:
        raise BuildError(None, None, f"no FMU for {sys.platform} on {platform.machine()}")
    return Platform(f"{machine}-{system.folder}", system.folder_fmi2, system.ending)


def compile_library(compiler: Compiler, source: Path, library: Path) -> None:
    """Compile one source file to a shared library.

    Raises BuildError with the compiler's first message.
    """
    command = [*compiler.command, *FLAGS, "-o", str(library), source.name, *LINK]
    # Run beside the source, so that no path of this machine gets into the library.
    result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=source.parent)
    if result.returncode != 0:
        lines = (result.stderr or result.stdout).strip().splitlines()
        first = next((line for line in lines if "error" in line), lines[0] if lines else "failed")
        raise BuildError(source.name, None, f"the C compiler says: {first}")
