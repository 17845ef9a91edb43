"""The C compilers that turn generated sources into the libraries of an FMU."""

import csv
import importlib.metadata
import importlib.util
import platform
import shutil
import struct
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from axisrig.fmus.reading.errors import BuildError

PLATFORMS_FILE = Path(__file__).parent / "platforms.csv"
# No fast-math and no contraction: the same sources give the same bits of results. No debug
# information: it would hold the folder of the build.
FLAGS = (
    "-std=c11",
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
OPTIMISED, NOT_OPTIMISED = "-O2", "-O0"
LINK = ("-lm",)
# zig: without symbols (Windows would get a file of them beside), and no checks that only its
# debug builds need.
ZIG_FLAGS = ("-s", "-fno-sanitize=undefined")
COMPILERS = ("cc", "zig")


def flags(is_optimised: bool = True) -> tuple[str, ...]:
    """The options of a build; without optimisation the compiler takes a third of its time."""
    return (OPTIMISED if is_optimised else NOT_OPTIMISED, *FLAGS)


@dataclass(frozen=True)
class Compiler:
    """A C compiler. name: "cc" or "zig". command: how it is called. identity: its version."""

    name: str
    command: tuple[str, ...]
    identity: str


@dataclass(frozen=True)
class Platform:
    """Where an FMU runs, a row of `platforms.csv`.

    name: its word and folder in FMI 3.0. fmi2_folder: that of FMI 2.0, empty where that version has
    none. ending: of a shared library. target: zig's word. in_all: part of `--platform all`.
    """

    name: str
    fmi2_folder: str
    ending: str
    target: str
    in_all: bool

    def folder(self, fmi: str) -> str:
        """The folder below `binaries`. Raises BuildError when this version of FMI has none."""
        found = self.name if fmi == "3.0" else self.fmi2_folder
        if not found:
            raise BuildError(None, None, f"FMI {fmi} has no {self.name}; FMI 3.0 has")
        return found


def read_platforms() -> dict[str, Platform]:
    """The platforms that FMUs can be built for, by the word of FMI 3.0."""
    with PLATFORMS_FILE.open(encoding="utf-8", newline="") as file:
        return {
            row["platform"]: Platform(
                row["platform"], row["fmi2_folder"], row["ending"], row["target"], row["all"] == "1"
            )
            for row in csv.DictReader(file)
        }


PLATFORMS: Mapping[str, Platform] = read_platforms()


@cache
def this_platform() -> Platform:
    """The platform of this interpreter. Raises BuildError for one that is not in the table."""
    systems = {"linux": "linux", "win32": "windows", "darwin": "darwin"}
    machines = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
    system, machine = systems.get(sys.platform), machines.get(platform.machine().lower())
    found = PLATFORMS.get(f"{machine}-{system}")
    if found is None:
        raise BuildError(None, None, f"no FMU for {sys.platform} on {platform.machine()}")
    return found


def find_compiler(name: str | None = None) -> Compiler:
    """The compiler `name`; by default the system's `cc`, else the one of the package ziglang.

    Raises BuildError when it is not there.
    """
    cc = shutil.which("cc") if name in (None, "cc") else None
    if cc is not None:
        return _asked(cc)
    if name in (None, "zig") and importlib.util.find_spec("ziglang") is not None:
        version = importlib.metadata.version("ziglang")
        return Compiler("zig", (sys.executable, "-m", "ziglang", "cc"), f"ziglang {version}")
    hint = 'pip install "axisrig[cc]"'
    if name == "zig":
        raise BuildError(None, None, f"the package ziglang is not installed: {hint}")
    raise BuildError(None, None, f"no C compiler; install one, or the package: {hint}")


@cache
def _asked(command: str) -> Compiler:
    """Ask the system's compiler who it is and what for."""
    said = [
        subprocess.run([command, option], capture_output=True, text=True, check=False)
        for option in ("--version", "-dumpmachine")
    ]
    if said[0].returncode != 0:
        raise BuildError(None, None, f"{command} does not run: {said[0].stderr.strip()}")
    return Compiler("cc", (command,), "\n".join(result.stdout.strip() for result in said))


def compiler_for(platforms: Sequence[Platform], name: str | None) -> Compiler:
    """The compiler that builds for these platforms: zig as soon as one is not this one.

    Raises BuildError when `name` asks for another.
    """
    foreign = [p.name for p in platforms if p is not this_platform()]
    if not foreign:
        return find_compiler(name)
    if name == "cc":
        message = (
            f"the system's cc builds for {this_platform().name}, not for {foreign[0]}; zig does"
        )
        raise BuildError(None, None, message)
    return find_compiler("zig")


def compile_library(
    compiler: Compiler,
    source: Path,
    library: Path,
    target: Platform,
    is_optimised: bool = True,
) -> None:
    """Compile one source file to a shared library for a platform.

    Raises BuildError with the compiler's first message.
    """
    # Run beside the source and with bare names, so that no path of this machine gets into the
    # library: Mach-O keeps the name that it is written to, Windows gets files beside it.
    for_target = ("-target", target.target, *ZIG_FLAGS) if compiler.name == "zig" else ()
    output = f"{source.stem}{target.ending}"
    options = (*for_target, *flags(is_optimised))
    command = [*compiler.command, *options, "-o", output, source.name, *LINK]
    result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=source.parent)
    if result.returncode != 0:
        lines = (result.stderr or result.stdout).strip().splitlines()
        first = next((line for line in lines if "error" in line), lines[0] if lines else "failed")
        raise BuildError(source.name, None, f"the C compiler says: {first}")
    library.parent.mkdir(parents=True, exist_ok=True)
    (source.parent / output).replace(library)
    (source.parent / f"{source.stem}.lib").unlink(missing_ok=True)


def universal_library(thin: Sequence[Path], universal: Path) -> None:
    """Join Mach-O libraries of several machines into one file.

    Source: <mach-o/fat.h>: magic, count, then CPU type, subtype, offset, size and alignment (as a
    power of two) of each part, all big-endian.
    """
    align = 14  # pages of 16 KiB on arm64
    page = 1 << align
    entries, body = b"", b""
    for path in thin:
        data = path.read_bytes()
        _, cpu_type, cpu_subtype = struct.unpack_from("<3I", data)
        body += bytes(-len(body) % page)
        entries += struct.pack(">5I", cpu_type, cpu_subtype, page + len(body), len(data), align)
        body += data
    header = struct.pack(">2I", 0xCAFEBABE, len(thin)) + entries
    universal.parent.mkdir(parents=True, exist_ok=True)
    universal.write_bytes(header.ljust(page, b"\0") + body)
