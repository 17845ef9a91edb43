"""Two ways a run can go wrong for a reason that its user can mend, and the alarm catalogue.

`UserError`  input is rejected before anything runs: file, line, column, value, what is allowed.
             The command line ends with exit code 2.
`Alarm`      the machine stops or warns while running: an ID of `errors.csv` with its values.
             A class above 1 ends the program; the command line ends with exit code 1.

Anything else that escapes is a defect of the bench.
"""

import csv
import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

_VALUE_LENGTH_MAX = 80
WORKBOOKS = (".xlsx", ".ods")
"""Suffixes of files whose places are cells of a sheet."""


class Guess(list[str]):
    """Names that may have been meant, out of many that are allowed."""


class _GuessedText(str):
    """Such names as one text; it stays a guess in an error that is made of another one."""

    __slots__ = ()


class UserError(Exception):
    """Input that cannot be accepted, with a message by which the reader can correct it.

    message: what is wrong, one sentence without full stop.
    file, line, column: where (line and column count from 1).
    value: what was found. allowed: what is allowed there, or a `Guess`. hint: what to do.
    excerpt: the line with a mark under the place, for a reader at a terminal; no part of the text.
    further: what else is wrong in the same file, in its order; no part of the text either.
    """

    excerpt: str | None = None
    further: Sequence["UserError"] = ()

    def __init__(
        self,
        message: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        column: int | None = None,
        value: object = None,
        allowed: Iterable[object] | str | None = None,
        hint: str | None = None,
    ) -> None:
        self.message = message
        self.file = None if file is None else str(file)
        self.line, self.column = line, column
        self.value, self.hint = value, hint
        self.allowed: str | None = None
        if allowed is not None:
            if not isinstance(allowed, str):
                text = ", ".join(str(item) for item in allowed)
                allowed = _GuessedText(text) if isinstance(allowed, Guess) else text
            self.allowed = allowed
        super().__init__(str(self))

    def __str__(self) -> str:
        place = place_text(self.file, self.line, self.column)
        parts = [f"{place}: {self.message}" if place else self.message]
        if self.value is not None:
            parts.append(f"found {_short(repr(self.value))}")
        if self.allowed is not None:
            is_guess = isinstance(self.allowed, _GuessedText)
            parts.append(f"{'did you mean' if is_guess else 'allowed'}: {self.allowed}")
        if self.hint is not None:
            parts.append(self.hint)
        return "; ".join(parts)


def cell_name(row: int, column: int) -> str:
    """Return the name of a cell of a sheet, `A1` for row 1 and column 1."""
    letters = ""
    while column:
        column, digit = divmod(column - 1, 26)
        letters = chr(ord("A") + digit) + letters
    return f"{letters}{row}"


def place_text(file: str | None, line: int | None, column: int | None) -> str:
    """Write a place as `plan.csv:3:1`, that of a workbook as its program does, `plan.xlsx:A3`."""
    if file and line and column and file.lower().endswith(WORKBOOKS):
        return f"{file}:{cell_name(line, column)}"
    return ":".join(str(part) for part in (file, line, column) if part is not None)


def together(errors: Sequence[UserError]) -> UserError:
    """Make one error of all that are wrong with a file; at least one."""
    first, *others = (one for error in errors for one in (error, *error.further))
    first.further = tuple(others)
    return first


def _short(text: str) -> str:
    return text if len(text) <= _VALUE_LENGTH_MAX else f"{text[:_VALUE_LENGTH_MAX]}..."


def printable(text: str) -> str:
    """Return foreign text without what could steer a terminal or turn the reading direction."""
    return "".join(sign if sign.isprintable() else " " for sign in text)


def nearest(word: str, known: Iterable[str], count: int = 3) -> Guess:
    """Return the names of `known` that look most like `word`, best first."""
    names = {name.lower(): name for name in known}
    return Guess(names[hit] for hit in difflib.get_close_matches(word.lower(), names, n=count))


def near_files(folder: Path, text: str) -> str:
    """Return a hint for a path that names no file: what is near it, or where it was looked for.

    folder: what the path is relative to.
    """
    forward = text.replace("\\", "/")
    if forward != text and (folder / forward).is_file():
        return f"folders are separated by /: {forward}"
    if text and (folder / forward).is_dir():
        return "it is a folder"
    parent = (folder / forward).parent if forward else folder
    beside = [item.name for item in parent.iterdir()] if parent.is_dir() else []
    close = nearest(Path(forward).name, beside)
    return f"near it: {', '.join(close)}" if close else f"looked in {parent}"


def why_unread(path: str | Path, error: OSError) -> str:
    """Return a hint for a file that cannot be opened: the reason, or what is near its name."""
    if isinstance(error, FileNotFoundError):
        return f"there is no such file; {near_files(Path(), str(path))}"
    return error.strerror or str(error)


OF_PARAMETER_LISTS = 2
"""Error type of what comes up while lists are taken over."""


@dataclass(frozen=True)
class CatalogueEntry:
    """One row of `errors.csv`.

    id: the manual's ID, or one of ours from 900000 where none is documented.
    newer_id: what newer builds report instead; older_id: the other way round.
    reaction_class: what the alarm does (`kernel.channel.reactions`), reaction: the same in words.
    error_type: 1 from the NC program, 2 parameter transfer, 11 position controller, None where the
        manuals say none. area: the function that it belongs to.
    is_raised: whether the function is implemented; else nothing raises it yet.
    text: our words with `{name}` places. values: these names, with their unit at the end.
    remedy: what to do. source: where the ID is documented. inferred: columns that no source gives.
    """

    id: int
    newer_id: int | None
    older_id: int | None
    reaction_class: int
    reaction: str
    error_type: int | None
    area: str
    is_raised: bool
    text: str
    values: tuple[str, ...]
    remedy: str
    source: str
    inferred: tuple[str, ...]

    @property
    def family(self) -> tuple[int, ...]:
        """The IDs of the same cause, the one that is reported first."""
        return tuple(i for i in (self.older_id, self.id, self.newer_id) if i is not None)

    @property
    def relation(self) -> str:
        """A sentence about the other ID of the same cause, or nothing."""
        if self.newer_id is not None:
            return f"Newer builds report {self.newer_id}."
        return f"Older builds report {self.older_id}." if self.older_id is not None else ""


@cache
def catalogue() -> Mapping[int, CatalogueEntry]:
    """Read `errors.csv`, keyed by ID."""
    text = resources.files(__package__).joinpath("errors.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(text.splitlines()))
    older = {int(row["newer_id"]): int(row["id"]) for row in rows if row["newer_id"]}
    entries = [
        CatalogueEntry(
            id=int(row["id"]),
            newer_id=int(row["newer_id"]) if row["newer_id"] else None,
            older_id=older.get(int(row["id"])),
            reaction_class=int(row["class"]),
            reaction=row["reaction"],
            error_type=int(row["type"]) if row["type"] else None,
            area=row["area"],
            is_raised=row["raised"] == "yes",
            text=row["text"],
            values=tuple(row["values"].split()),
            remedy=row["remedy"],
            source=row["source"],
            inferred=tuple(row["inferred"].split()),
        )
        for row in rows
    ]
    return {entry.id: entry for entry in entries}


@cache
def reaction_classes() -> Mapping[int, dict[str, str]]:
    """Read `reaction_classes.csv`: per class the reaction, what the machine does, what is next."""
    name = "reaction_classes.csv"
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return {int(row["class"]): row for row in csv.DictReader(text.splitlines())}


def same_cause(alarm_id: int) -> int:
    """Return the ID under which the cause of this one is reported; an unknown ID as it is."""
    entry = catalogue().get(alarm_id)
    return alarm_id if entry is None else entry.family[0]


class Alarm(Exception):  # noqa: N818
    """An entry of the catalogue that has come up, with the values of its text.

    Raises KeyError for an ID or a value that is not in the catalogue: that is a defect.
    """

    def __init__(self, alarm_id: int, *, place: str | None = None, **values: object) -> None:
        self.entry = catalogue()[alarm_id]
        self.place = place
        self.values = {name: values[name] for name in self.entry.values}
        super().__init__(str(self))

    @property
    def id(self) -> int:
        """The ID that the report and the exit code use."""
        return self.entry.id

    def at(self, place: str) -> "Alarm":
        """Return this alarm with its place, or itself where it has one."""
        return self if self.place else Alarm(self.entry.id, place=place, **self.values)

    @property
    def ends_program(self) -> bool:
        """Whether the program ends: every class above the warning does.

        What is wrong with a parameter list comes up before there is a program: its job was to take
        the list over.
        """
        return self.entry.reaction_class > 1 and self.entry.error_type != OF_PARAMETER_LISTS

    def __str__(self) -> str:
        text = self.entry.text.format(**self.values)
        place = f" ({self.place})" if self.place else ""
        head = f"ID {self.entry.id} class {self.entry.reaction_class}: {text}{place}."
        return " ".join(filter(None, (head, self.entry.remedy, self.entry.relation)))
