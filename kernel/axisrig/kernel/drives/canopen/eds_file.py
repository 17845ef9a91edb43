"""An EDS or DCF as text: sections and keys with their lines, whatever editor wrote them.

Source: CiA 306-1 (keywords in any case, numbers decimal, hexadecimal with 0x, octal with a leading
0, comments after a semicolon). What is outside of it and can be meant in one way only is mended,
with a note; the rest is refused with line, section and key.
"""

import codecs
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from axisrig.kernel.errors import UserError

_HEADER: Final = re.compile(r"\[\s*([^\]]*?)\s*\]\s*(?:;.*)?")
_COMMENT: Final = re.compile(r"\s;.*")
_OBJECT: Final = re.compile(r"([0-9a-f]{1,4})(?:sub([0-9a-f]{1,3}))?", re.IGNORECASE)
_TABLE: Final = re.compile(r"([0-9a-f]{4})(name|value|denotation|objectlinks)", re.IGNORECASE)
_OCTAL: Final = re.compile(r"([+-]?)0+([0-7]+)")
_DECIMAL: Final = re.compile(r"[+-]?\d+")
_HEXADECIMAL: Final = re.compile(r"[+-]?0x[0-9a-f]+", re.IGNORECASE)
_BYTE_ORDER_MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


@dataclass(frozen=True)
class Note:
    """A mend: what was done, with section and key of the place ("" for the whole file)."""

    text: str
    section: str = ""
    key: str = ""
    line: int | None = None

    @property
    def place(self) -> str:
        """Section and key."""
        return " ".join(
            part for part in (f"[{self.section}]" * bool(self.section), self.key) if part
        )


@dataclass(frozen=True)
class Entry:
    """The value of a key, and its line from 1."""

    value: str
    line: int


@dataclass
class Section:
    """A section: its name as the file writes it, its line, and its entries by key in lower case."""

    name: str
    line: int
    entries: dict[str, Entry] = field(default_factory=dict)

    def text(self, key: str) -> str:
        """Return the value of a key, "" for a key that is missing or empty."""
        found = self.entries.get(key.lower())
        return found.value if found is not None else ""

    def line_of(self, key: str) -> int:
        """Return the line of a key, that of the section for one that is missing."""
        found = self.entries.get(key.lower())
        return found.line if found is not None else self.line


@dataclass
class EdsFile:
    """The sections of a file by name in lower case, and what was mended."""

    path: str
    sections: dict[str, Section] = field(default_factory=dict)
    notes: list[Note] = field(default_factory=list)

    def note(self, text: str, section: Section | None = None, key: str = "") -> None:
        """Write down a mend."""
        name = section.name if section is not None else ""
        line = section.line_of(key) if section is not None else None
        self.notes.append(Note(text, name, key, line))

    def refused(self, text: str, section: Section, key: str, allowed: str) -> UserError:
        """Return the error for a key that cannot be read."""
        where = f"[{section.name}] {key}" if key else f"[{section.name}]"
        value = section.text(key) if key.lower() in section.entries else None
        return UserError(
            f"the EDS cannot be read: {where}: {text}",
            file=self.path,
            line=section.line_of(key),
            value=value,
            allowed=allowed,
        )

    def number(self, section: Section, key: str) -> int | None:
        """Return a whole number, None for a key that is missing or empty; raises UserError."""
        text = section.text(key)
        if not text:
            if key.lower() in section.entries:
                self.note("is empty and counts as missing", section, key)
            return None
        found = whole_number(plain(text))
        if found is None:
            raise self.refused("no number", section, key, "decimal, 0x hexadecimal, 0 octal")
        return found


def plain(text: str) -> str:
    """Return a number or a word without a comment that follows it at once."""
    return text.partition(";")[0].strip()


def whole_number(text: str) -> int | None:
    """Return a whole number as CiA 306 writes it, None for a text that is none."""
    text = text.strip()
    octal = _OCTAL.fullmatch(text)
    if octal is not None:
        return int(octal[1] + octal[2], 8)
    if _HEXADECIMAL.fullmatch(text):
        return int(text, 16)
    return int(text) if _DECIMAL.fullmatch(text) else None


def read_eds_file(path: str) -> EdsFile:
    """Read a file into sections. Raises UserError when it is no EDS."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise UserError(f"the EDS cannot be read: {error.strerror}", file=path) from error
    found = EdsFile(path)
    current: Section | None = None
    for line, text in _lines(data, found):
        header = _HEADER.fullmatch(text)
        if header is not None:
            current = _section(found, header[1], line)
            continue
        key, mark, value = (part.strip() for part in text.partition("="))
        if current is None:
            raise UserError(
                "the EDS cannot be read: something is before the first section", file=path,
                line=line, value=text, allowed="[FileInfo] and other sections",
            )  # fmt: skip
        if not mark or not key:
            found.note(f"line {line} is neither section nor key and is left out", current)
            continue
        _add(found, current, key, Entry(_COMMENT.sub("", f" {value}").strip(), line))
    if not found.sections:
        raise UserError("the EDS cannot be read: it has no section", file=path)
    return found


def _lines(data: bytes, found: EdsFile) -> Iterator[tuple[int, str]]:
    """Yield the lines that say something."""
    encoding = next((name for mark, name in _BYTE_ORDER_MARKS if data.startswith(mark)), "utf-8")
    if encoding != "utf-8":
        found.note("the file begins with a byte order mark")
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        found.note("the file is no UTF-8 and is read as cp1252")
        text = data.decode("cp1252", errors="replace")
    for line, whole in enumerate(text.splitlines(), 1):
        plain = whole.strip().strip("\0\x1a")
        if plain and not plain.startswith((";", "#")):
            yield line, plain


def _section(found: EdsFile, name: str, line: int) -> Section:
    before = found.sections.get(name.lower())
    if before is not None:
        raise UserError(
            f"the EDS cannot be read: [{name}] is there twice, first in line {before.line}",
            file=found.path, line=line, allowed="each section once",
        )  # fmt: skip
    section = found.sections[name.lower()] = Section(name, line)
    return section


def _add(found: EdsFile, section: Section, key: str, entry: Entry) -> None:
    before = section.entries.get(key.lower())
    if before is None:
        section.entries[key.lower()] = entry
    elif before.value == entry.value:
        found.note(
            f"is there twice with one value, lines {before.line} and {entry.line}", section, key
        )
    else:
        raise UserError(
            f"the EDS cannot be read: [{section.name}] {key} is there twice, first in line"
            f" {before.line} with {before.value!r}",
            file=found.path, line=entry.line, value=entry.value, allowed="each key once",
        )  # fmt: skip


def object_of(name: str) -> tuple[int, int | None] | None:
    """Return index and sub-index of a section, sub-index None for a whole object."""
    parts = _OBJECT.fullmatch(name)
    if parts is None:
        return None
    return int(parts[1], 16), int(parts[2], 16) if parts[2] else None


def table_of(name: str) -> tuple[int, str] | None:
    """Return index and kind of a section that lists names or values of a short array."""
    parts = _TABLE.fullmatch(name)
    return (int(parts[1], 16), parts[2].capitalize()) if parts is not None else None
