"""Which C compiler there is, what it is asked for, and where its library goes; none runs here."""

import struct
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus import compiler as compilers
from axisrig.fmus.compiler import (
    FLAGS,
    PLATFORMS,
    ZIG_FLAGS,
    Compiler,
    compile_library,
    find_compiler,
    this_platform,
    universal_library,
)
from axisrig.fmus.reading.errors import BuildError

CC, ZIG = Compiler("cc", ("/x/cc",), "cc 1"), Compiler("zig", ("python", "-m", "ziglang"), "zig 2")


# Platforms


@pytest.mark.parametrize(
    ("name", "fmi2", "ending"),
    [
        # FMI 3.0: <architecture>-<system>; FMI 2.0: win64, linux64, darwin64
        ("x86_64-linux", "linux64", ".so"), ("x86_64-windows", "win64", ".dll"),
        ("x86_64-darwin", "darwin64", ".dylib"), ("aarch64-darwin", "darwin64", ".dylib"),
    ],
)  # fmt: skip
def test_folders_and_endings_are_those_of_the_standards(name: str, fmi2: str, ending: str) -> None:
    found = PLATFORMS[name]
    assert (found.folder("3.0"), found.folder("2.0"), found.ending) == (name, fmi2, ending)
    assert found.in_all
    machine, _, system = name.partition("-")
    assert found.target.startswith(machine)
    assert {"darwin": "macos"}.get(system, system) in found.target


def test_a_platform_that_an_older_version_does_not_have_is_refused_there_alone() -> None:
    arm = PLATFORMS["aarch64-linux"]
    assert (arm.folder("3.0"), arm.ending, arm.in_all) == ("aarch64-linux", ".so", False)
    with pytest.raises(BuildError, match=r"FMI 2\.0 has no aarch64-linux; FMI 3\.0 has"):
        arm.folder("2.0")


@pytest.mark.parametrize(
    ("system", "machine", "name"),
    [
        ("linux", "x86_64", "x86_64-linux"), ("linux", "aarch64", "aarch64-linux"),
        ("win32", "AMD64", "x86_64-windows"), ("darwin", "arm64", "aarch64-darwin"),
        ("darwin", "x86_64", "x86_64-darwin"), ("win32", "ARM64", None), ("linux", "riscv64", None),
        ("aix", "x86_64", None),
    ],
)  # fmt: skip
def test_the_platform_of_an_interpreter(
    system: str, machine: str, name: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However the system writes its machine."""
    monkeypatch.setattr(compilers, "sys", SimpleNamespace(platform=system))
    monkeypatch.setattr(compilers, "platform", SimpleNamespace(machine=lambda: machine))
    this_platform.cache_clear()
    try:
        if name is None:
            with pytest.raises(BuildError, match=f"no FMU for {system} on {machine}"):
                this_platform()
        else:
            assert this_platform() is PLATFORMS[name]
    finally:
        this_platform.cache_clear()


# Which compiler


@pytest.fixture
def computer(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """A computer with these compilers; cc ends with `code`."""

    def make(*, cc: bool = False, zig: bool = False, code: int = 0) -> None:
        def run(command: Sequence[str], **_: Any) -> Any:
            answer = {"--version": "cc 12.2\n", "-dumpmachine": "x86_64-linux-gnu\n"}
            words = answer[command[1]]
            return SimpleNamespace(returncode=code, stdout=words, stderr=" no licence\n")

        asked = compilers._asked.__wrapped__
        monkeypatch.setattr(compilers, "_asked", asked)
        monkeypatch.setattr(compilers.subprocess, "run", run)
        monkeypatch.setattr(compilers.shutil, "which", lambda name: f"/x/{name}" if cc else None)
        monkeypatch.setattr(compilers.importlib.util, "find_spec", lambda _: zig or None)
        monkeypatch.setattr(compilers.importlib.metadata, "version", lambda _: "0.13")

    return make


@pytest.mark.parametrize("zig", [True, False])
@pytest.mark.parametrize("name", [None, "cc"])
def test_the_compiler_of_the_system_comes_first_and_says_who_it_is_and_what_for(
    name: str | None, zig: bool, computer: Callable[..., None]
) -> None:
    computer(cc=True, zig=zig)
    assert find_compiler(name) == Compiler("cc", ("/x/cc",), "cc 12.2\nx86_64-linux-gnu")


@pytest.mark.parametrize(("name", "cc"), [(None, False), ("zig", False), ("zig", True)])
def test_zig_serves_where_it_is_asked_for_or_alone(
    name: str | None, cc: bool, computer: Callable[..., None]
) -> None:
    computer(cc=cc, zig=True)
    command = (sys.executable, "-m", "ziglang", "cc")
    assert find_compiler(name) == Compiler("zig", command, "ziglang 0.13")


@pytest.mark.parametrize(
    ("name", "cc", "zig", "words"),
    [
        (None, False, False, "no C compiler; install one, or the package"),
        ("cc", False, True, "no C compiler; install one, or the package"),
        ("zig", True, False, "the package ziglang is not installed"),
    ],
)
def test_a_compiler_that_is_not_there_is_refused_with_how_to_get_one(
    name: str | None, cc: bool, zig: bool, words: str, computer: Callable[..., None]
) -> None:
    computer(cc=cc, zig=zig)
    with pytest.raises(BuildError, match=words) as caught:
        find_compiler(name)
    assert caught.value.message.endswith('pip install "axisrig[cc]"')


def test_a_compiler_that_does_not_run_says_why(computer: Callable[..., None]) -> None:
    computer(cc=True, zig=True, code=1)
    with pytest.raises(BuildError, match=r"^/x/cc does not run: no licence$"):
        find_compiler()


# What it does


@pytest.fixture
def compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[str]]:
    """The command by which `sources/M.c` becomes a library, in the folder of the source."""

    def make(compiler: Compiler, target: str, code: int = 0, **options: Any) -> list[str]:
        asked: list[list[str]] = []
        words = {name: options.pop(name, "") for name in ("stdout", "stderr")}

        def run(command: list[str], *, cwd: Path, **_: Any) -> Any:
            asked.append(command)
            assert cwd == tmp_path / "sources"
            (cwd / command[command.index("-o") + 1]).write_bytes(b"library")
            (cwd / "M.lib").write_bytes(b"beside it, of Windows")
            return SimpleNamespace(returncode=code, **words)

        monkeypatch.setattr(compilers.subprocess, "run", run)
        (tmp_path / "sources").mkdir(exist_ok=True)
        place = tmp_path / "binaries" / target / "wanted"
        compile_library(compiler, tmp_path / "sources" / "M.c", place, PLATFORMS[target], **options)
        assert place.read_bytes() == b"library"
        assert [path.name for path in (tmp_path / "sources").iterdir()] == []
        return asked[0]

    return make


@pytest.mark.parametrize("target", PLATFORMS)
def test_zig_is_asked_for_the_platform_and_cc_for_none(
    target: str, compiled: Callable[..., list[str]]
) -> None:
    """Bare names: a library holds no path of the computer that has built it."""
    output = f"M{PLATFORMS[target].ending}"
    end = ["-o", output, "M.c", "-lm"]
    assert compiled(CC, target) == ["/x/cc", "-O2", *FLAGS, *end]
    words = ["-target", PLATFORMS[target].target, *ZIG_FLAGS]
    assert compiled(ZIG, target) == [*ZIG.command, *words, "-O2", *FLAGS, *end]


def test_a_build_without_optimisation_has_all_other_options(
    compiled: Callable[..., list[str]],
) -> None:
    fast, slow = (compiled(CC, "x86_64-linux", is_optimised=is_it) for is_it in (True, False))
    assert [one for one, other in zip(fast, slow, strict=True) if one != other] == ["-O2"]
    assert [other for one, other in zip(fast, slow, strict=True) if one != other] == ["-O0"]


def test_the_same_sources_give_the_same_bits_of_results() -> None:
    """No contraction, no fast maths, no folder of the build."""
    assert {"-ffp-contract=off", "-fno-fast-math", "-g0", "-std=c11"} <= set(FLAGS)


@pytest.mark.parametrize(
    ("stdout", "stderr", "words"),
    [
        ("", "M.c:3: warning: odd\nM.c:4: error: no k\nM.c:9: error: more", "M.c:4: error: no k"),
        ("", "cannot run\nmore", "cannot run"),
        ("M.c:4: error: no k", "", "M.c:4: error: no k"),
        ("output", "M.c:4: error: no k", "M.c:4: error: no k"),
        ("", "\n", "failed"),
        ("", "", "failed"),
    ],
)  # fmt: skip
def test_a_refusal_of_the_compiler_is_its_first_error(
    stdout: str, stderr: str, words: str, compiled: Callable[..., list[str]]
) -> None:
    with pytest.raises(BuildError) as caught:
        compiled(CC, "x86_64-linux", code=1, stdout=stdout, stderr=stderr)
    assert (caught.value.file, caught.value.line) == ("M.c", None)
    assert caught.value.message == f"the C compiler says: {words}"


# Several machines in one file


@pytest.mark.parametrize("sizes", [(12,), (100, 16_384), (16_385, 12, 70_000)])
def test_parts_of_a_universal_library_begin_at_pages(tmp_path: Path, sizes: Sequence[int]) -> None:
    """<mach-o/fat.h>: big-endian 0xCAFEBABE, count; type, subtype, offset, size, 2^14 of each."""
    parts = []
    for number, size in enumerate(sizes):
        head = struct.pack("<3I", 0xFEEDFACF, 0x01000007 + 5 * number, number + 3)
        parts.append(head + bytes([number + 1]) * (size - 12))
        (tmp_path / f"part{number}").write_bytes(parts[-1])
    place = tmp_path / "new" / "both.dylib"
    universal_library([tmp_path / f"part{number}" for number in range(len(sizes))], place)
    data = place.read_bytes()
    assert struct.unpack_from(">2I", data) == (0xCAFEBABE, len(sizes))
    end = 8 + 20 * len(sizes)
    for number, part in enumerate(parts):
        entry = struct.unpack_from(">5I", data, 8 + 20 * number)
        kind, subtype, begin, size, align = entry
        assert (kind, subtype, size, align) == (0x01000007 + 5 * number, number + 3, len(part), 14)
        assert begin % 16_384 == 0
        assert begin >= end
        assert data[begin : begin + size] == part
        assert not any(data[end:begin])
        end = begin + size
    assert len(data) == end
