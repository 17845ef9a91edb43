"""Headers of libraries: both orders of bytes, every processor, universal files, where they are.

Numbers: System V ABI (e_machine), Microsoft PE format (Machine), Apple `mach-o/loader.h`, `fat.h`.
"""

import struct
from pathlib import Path

import pytest

from axisrig.bench.tools.fmu.binaries import Binary, find_binaries, folder_platform

X86_MAC, ARM32_MAC, INTEL_MAC, ARM_MAC, POWER_MAC = 7, 12, 0x01000007, 0x0100000C, 18


def elf(machine: int, order: str = "<") -> bytes:
    return b"\x7fELF\2" + (b"\1" if order == "<" else b"\2") + bytes(10) + struct.pack(
        f"{order}HH", 3, machine
    )  # fmt: skip


def pe(machine: int, at: int = 64, sign: bytes = b"PE\0\0") -> bytes:
    head = b"MZ" + bytes(58) + struct.pack("<I", at)
    return head.ljust(at, b"\0") + sign + struct.pack("<H", machine)


def mach_o(kind: int, magic: int = 0xFEEDFACF, order: str = "<") -> bytes:
    return struct.pack(f"{order}II", magic, kind) + bytes(24)


def universal(*kinds: int, magic: int = 0xCAFEBABE) -> bytes:
    """fat_arch has 20 bytes, fat_arch_64 has 32: cputype comes first in both."""
    size = 20 if magic == 0xCAFEBABE else 32
    entries = (struct.pack(">II", kind, 3).ljust(size, b"\xee") for kind in kinds)
    return struct.pack(">II", magic, len(kinds)) + b"".join(entries)


def put(folder: Path, place: str, file: str, head: bytes) -> None:
    path = folder / "binaries" / place / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(head)


@pytest.mark.parametrize(
    ("ending", "head", "system", "processors"),
    [
        (".so", elf(3), "linux", ("x86",)),
        (".so", elf(40), "linux", ("aarch32",)),
        (".so", elf(243), "linux", ("riscv64",)),
        (".so", elf(183, ">"), "linux", ("aarch64",)),
        (".so", elf(62 << 8), "linux", ("machine 15872",)),
        (".dll", pe(0x1C4), "windows", ("aarch32",)),
        (".dll", pe(0x8664, at=0x108), "windows", ("x86_64",)),
        (".dll", pe(0x5064), "windows", ("machine 0x5064",)),
        (".dll", pe(0x8664, sign=b"NE\0\0"), "", ()),
        (".dll", pe(0x8664)[:-1], "", ()),
        (".dylib", mach_o(X86_MAC, 0xFEEDFACE), "darwin", ("x86",)),
        (".dylib", mach_o(ARM32_MAC, 0xFEEDFACE), "darwin", ("aarch32",)),
        (".dylib", mach_o(ARM_MAC, order=">"), "darwin", ("aarch64",)),
        (".dylib", mach_o(POWER_MAC, 0xFEEDFACE, ">"), "darwin", ("type 0x12",)),
        (".dylib", universal(ARM_MAC, INTEL_MAC), "darwin", ("aarch64", "x86_64")),
        (".dylib", universal(INTEL_MAC, ARM_MAC, magic=0xCAFEBABF), "darwin",
         ("x86_64", "aarch64")),
        (".dylib", universal(X86_MAC, POWER_MAC, INTEL_MAC), "darwin",
         ("x86", "type 0x12", "x86_64")),
        (".dylib", universal(INTEL_MAC, ARM_MAC)[:-20], "", ()),
    ],
)  # fmt: skip
def test_a_header_has_its_system_and_its_processors_in_their_order(
    tmp_path: Path, ending: str, head: bytes, system: str, processors: tuple[str, ...]
) -> None:
    """A file that is cut in its header is no library."""
    put(tmp_path, "any", f"model{ending}", head)
    (found,) = find_binaries(tmp_path, "model")
    assert (found.file, found.system) == (f"model{ending}", system)
    assert found.processors == processors


@pytest.mark.parametrize(
    ("folder", "system", "processors", "is_in_place"),
    [
        ("darwin64", "darwin", ("x86_64", "aarch64"), True),
        ("darwin64", "darwin", ("aarch64", "x86_64"), True),
        ("aarch64-darwin", "darwin", ("x86_64", "aarch64"), True),
        ("x86_64-darwin", "darwin", ("aarch64", "x86_64"), True),
        ("darwin32", "darwin", ("x86_64", "aarch64"), False),
        ("darwin32", "darwin", ("x86",), True),
        ("x86_64-darwin", "darwin", ("aarch64",), False),
        ("linux32", "linux", ("x86",), True),
        ("linux32", "linux", ("x86_64",), False),
        ("x86_64-linux", "darwin", ("x86_64", "aarch64"), False),
        ("win64", "windows", ("x86",), False),
        ("mips-plan9", "plan9", ("mips",), True),
        ("x86_64-linux", "", (), False),
    ],
)
def test_a_library_is_in_place_where_its_folder_names_one_of_its_processors(
    folder: str, system: str, processors: tuple[str, ...], is_in_place: bool
) -> None:
    """A universal one has the place of each, whichever comes first in its header."""
    found = Binary(folder, "model", system, processors)
    assert found.is_in_place is is_in_place
    assert found.is_universal is (len(processors) == 2)


@pytest.mark.parametrize(
    ("folder", "platform"),
    [("win32", ("windows", "x86")), ("linux32", ("linux", "x86")), ("darwin32", ("darwin", "x86")),
     ("darwin64", ("darwin", "x86_64")), ("aarch64-darwin", ("darwin", "aarch64")),
     ("x86-windows", ("windows", "x86")), ("other", ("", "other"))],
)  # fmt: skip
def test_a_folder_is_for_a_system_and_a_processor(folder: str, platform: tuple[str, str]) -> None:
    assert folder_platform(folder) == platform


@pytest.mark.parametrize(
    ("binary", "words"),
    [
        (Binary("win64", "m.dll", "windows", ("x86_64",)), "win64 (x86_64, windows)"),
        (Binary("darwin64", "m", "darwin", ("x86_64", "aarch64")),
         "darwin64 (universal: x86_64 + aarch64, darwin)"),
        (Binary("linux64", "m.so", "", ()), "linux64 (unknown, no library)"),
    ],
)  # fmt: skip
def test_a_library_in_words(binary: Binary, words: str) -> None:
    assert str(binary) == words


def test_libraries_are_found_by_folder_whatever_their_ending(tmp_path: Path) -> None:
    """Of the name of the model alone; what is no folder, or holds no library, is left out."""
    for place, file in (
        ("x86_64-linux", "model.so"), ("x86_64-linux", "model.dll"), ("aarch64-darwin", "m.dylib"),
        ("win64", "model.dll"), ("darwin64", "model.dylib"), ("empty", "notes.txt"),
        ("x86_64-windows", "modeler.dll"),
    ):  # fmt: skip
        put(tmp_path, place, file, elf(62))
    (tmp_path / "binaries" / "model.so").write_bytes(elf(62))
    (tmp_path / "binaries" / "dir" / "model.so").mkdir(parents=True)
    found = [(each.folder, each.file) for each in find_binaries(tmp_path, "model")]
    assert found == [("darwin64", "model.dylib"), ("win64", "model.dll"),
                     ("x86_64-linux", "model.so"), ("x86_64-linux", "model.dll")]  # fmt: skip
    assert find_binaries(tmp_path / "none", "model") == []
