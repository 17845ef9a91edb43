"""The libraries in an FMU: for which system and processor each was built, read from its header.

Sources of the numbers: System V ABI (ELF header, e_machine), Microsoft PE format (Machine), Apple
`mach-o/loader.h` and `fat.h` (magic, cputype). Folders: FMI 2.0.4 section 2.3, FMI 3.0 section
2.5.1.4.
"""

import struct
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ENDINGS = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}
# Folder of FMI 2.0 -> system and processor; FMI 3.0 names the folder <processor>-<system>
FMI2_FOLDERS = {
    "win32": ("windows", "x86"),
    "win64": ("windows", "x86_64"),
    "linux32": ("linux", "x86"),
    "linux64": ("linux", "x86_64"),
    "darwin32": ("darwin", "x86"),
    "darwin64": ("darwin", "x86_64"),
}
_ELF_MACHINES = {3: "x86", 40: "aarch32", 62: "x86_64", 183: "aarch64", 243: "riscv64"}
_PE_MACHINES = {0x14C: "x86", 0x1C4: "aarch32", 0x8664: "x86_64", 0xAA64: "aarch64"}
_MACH_TYPES = {7: "x86", 12: "aarch32", 0x01000007: "x86_64", 0x0100000C: "aarch64"}
_MACH_O, _MACH_FAT = (0xFEEDFACE, 0xFEEDFACF), (0xCAFEBABE, 0xCAFEBABF)
_HEADER_BYTES = 4096


@dataclass(frozen=True)
class Binary:
    """A library of an FMU.

    folder: below `binaries/`. system, processors: by its header; empty when that is not known.
    """

    folder: str
    file: str
    system: str
    processors: tuple[str, ...]

    @property
    def is_universal(self) -> bool:
        """Whether one file holds code for several processors (macOS)."""
        return len(self.processors) > 1

    @property
    def is_in_place(self) -> bool:
        """Whether its folder names the system and a processor that it was built for."""
        system, processor = folder_platform(self.folder)
        return system == self.system and processor in self.processors

    def __str__(self) -> str:
        kind = " + ".join(self.processors) or "unknown"
        universal = "universal: " if self.is_universal else ""
        return f"{self.folder} ({universal}{kind}, {self.system or 'no library'})"


def folder_platform(folder: str) -> tuple[str, str]:
    """Return system and processor that a folder below `binaries/` is for."""
    if folder in FMI2_FOLDERS:
        return FMI2_FOLDERS[folder]
    processor, _, system = folder.partition("-")
    return system, processor


def find_binaries(folder: Path, identifier: str) -> list[Binary]:
    """Read the headers of the libraries `identifier` in an unpacked FMU, by folder."""
    return [_read(path) for path in _libraries(folder / "binaries", identifier)]


def _libraries(folder: Path, identifier: str) -> Iterable[Path]:
    if not folder.is_dir():
        return
    for place in sorted(path for path in folder.iterdir() if path.is_dir()):
        for ending in ENDINGS.values():
            if (place / f"{identifier}{ending}").is_file():
                yield place / f"{identifier}{ending}"


def _read(path: Path) -> Binary:
    with path.open("rb") as file:
        head = file.read(_HEADER_BYTES)
    try:
        system, processors = _elf(head) or _pe(head) or _mach_o(head) or ("", ())
    except struct.error:
        system, processors = "", ()
    return Binary(path.parent.name, path.name, system, processors)


def _elf(head: bytes) -> tuple[str, tuple[str, ...]] | None:
    if head[:4] != b"\x7fELF":
        return None
    order = "<" if head[5:6] == b"\1" else ">"
    (machine,) = struct.unpack_from(f"{order}H", head, 18)
    return "linux", (_ELF_MACHINES.get(machine, f"machine {machine}"),)


def _pe(head: bytes) -> tuple[str, tuple[str, ...]] | None:
    if head[:2] != b"MZ":
        return None
    (at,) = struct.unpack_from("<I", head, 0x3C)
    if head[at : at + 4] != b"PE\0\0":
        return None
    (machine,) = struct.unpack_from("<H", head, at + 4)
    return "windows", (_PE_MACHINES.get(machine, f"machine {machine:#x}"),)


def _mach_o(head: bytes) -> tuple[str, tuple[str, ...]] | None:
    (magic,) = struct.unpack_from(">I", head)
    if magic in _MACH_FAT:
        (count,) = struct.unpack_from(">I", head, 4)
        size = 20 if magic == _MACH_FAT[0] else 32
        kinds = [struct.unpack_from(">I", head, 8 + size * i)[0] for i in range(min(count, 16))]
        return "darwin", tuple(_MACH_TYPES.get(kind, f"type {kind:#x}") for kind in kinds)
    for order in "<>":
        magic, kind = struct.unpack_from(f"{order}II", head)
        if magic in _MACH_O:
            return "darwin", (_MACH_TYPES.get(kind, f"type {kind:#x}"),)
    return None
