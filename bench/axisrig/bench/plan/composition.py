"""Rows of a plan as they are meant: defaults, included tables, and cells with several assignments.

`case` = `*` gives defaults to the rows below, until the next one. `case` = `include` takes the
rows of the table that its `program` cell names, with its other cells as defaults. `inputs` and
`checks` hold assignments, each as if it had a column of its own. `-` is an empty cell that no
default fills.
"""

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from axisrig.bench.plan.assignment import ColumnForm, column_forms, find_form, meant_columns
from axisrig.bench.plan.table import CASE_COLUMN, DEFAULTS, Cell, Place, Row, Table, read_table
from axisrig.kernel.errors import UserError, near_files, together

INCLUDE = "include"
EMPTY = "-"
"""A cell that is empty although a default or a column gives a value."""

ASSIGNING = {"inputs": "", "checks": "check:"}
"""Columns that hold assignments, and what the names of their columns begin with."""
_INCLUDED_FILE = "program"
# A sign of equality comes before the condition, unless it begins with a comparison of its own
_CHECK = re.compile(
    r"\s*([^<>=!(]+?(?:\([^()]*\))?)\s*(?:=\s*(?!=[^=])|(?=[<>=!]))(.*?)\s*", re.DOTALL
)
_SEPARATOR = re.compile(r"\s+;;(?:\s+|$)|\s*\n\s*")


class Mistakes:
    """What is wrong with a plan, all of it; each mistake once."""

    def __init__(self) -> None:
        self._found: dict[str, UserError] = {}

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, error: UserError) -> None:
        """Keep a mistake."""
        each = (error, *error.further)
        error.further = ()
        for one in each:
            self._found.setdefault(str(one), one)

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keep what is raised inside, and go on after it."""
        try:
            yield
        except UserError as error:
            self.add(error)

    def refuse(self, first: Path) -> None:
        """Raise UserError when there is any: those of the file `first`, then others, by place."""
        if self._found:
            raise together(sorted(self._found.values(), key=lambda one: _order(one, str(first))))


def _order(error: UserError, first: str) -> tuple[bool, str, int, int]:
    return (error.file != first, error.file or "", error.line or 0, error.column or 0)


@dataclass(frozen=True)
class MeantRow:
    """A row with its defaults.

    place: of its cell `case`. cells: by column, in the order of the columns, those with content;
    an assignment is a cell of the column that it names.
    """

    place: Place
    cells: Mapping[str, Cell]

    def text(self, column: str) -> str:
        """Give the content of a cell."""
        cell = self.cells.get(column)
        return "" if cell is None else cell.text


@dataclass(frozen=True)
class Composed:
    """The rows of a plan, its columns with those of assignments, and notes for the reader."""

    columns: tuple[str, ...]
    rows: Sequence[MeantRow]
    notes: tuple[str, ...]


def compose(path: Path, mistakes: Mistakes) -> Composed:
    """Read a plan and the tables that it includes.

    Raises UserError for a table that cannot be read; what is wrong in rows and headers is kept in
    `mistakes`.
    """
    table = read_table(path)
    columns: dict[str, None] = {}
    notes = list(table.notes)
    rows = list(_Reader(mistakes, columns, notes).rows(table, {}, (), (path.resolve(),)))
    return Composed(tuple(columns), rows, tuple(notes))


class _Reader:
    """Reads tables into rows; columns and notes grow while it does."""

    def __init__(self, mistakes: Mistakes, columns: dict[str, None], notes: list[str]) -> None:
        self._mistakes = mistakes
        self._columns = columns
        self._notes = notes

    def rows(
        self,
        table: Table,
        outer: Mapping[str, Cell],
        via: tuple[str, ...],
        open_tables: tuple[Path, ...],
    ) -> Iterator[MeantRow]:
        """Yield the rows of a table; outer: defaults of the row that includes it."""
        forms = self._forms(table, outer, via)
        self._columns.update(dict.fromkeys(c for c in forms if c not in ASSIGNING))
        if not table.rows:
            self._mistakes.add(
                UserError(
                    "the plan has no case", file=table.path, hint="add a row below the header"
                )
            )
        if CASE_COLUMN not in forms:
            return
        defaults = dict(outer)
        for row in table.rows:
            own = self._cells(table, row, forms, via)
            place = table.place(row, CASE_COLUMN, via)
            name = row.cells[CASE_COLUMN]
            if name == DEFAULTS:
                defaults = _over(outer, own)
                continue
            cells = _filled(forms, defaults, own)
            if name == INCLUDE:
                cells.pop(_INCLUDED_FILE, None)
                with self._mistakes.kept():
                    yield from self._included(place, own.get(_INCLUDED_FILE), cells, open_tables)
                continue
            self._columns.update(dict.fromkeys(c for c in cells if c not in ASSIGNING))
            for form in column_forms():
                if form.required and form.column not in (CASE_COLUMN if name else "", *cells):
                    known = form.column in forms
                    if not known and form.column not in outer:
                        continue  # the header has been reported
                    at = table.place(row, form.column if known else CASE_COLUMN, via)
                    at = replace(at, header=form.column)
                    self._mistakes.add(at.error("the value is missing"))
            yield MeantRow(place, {CASE_COLUMN: Cell(name, place), **cells})

    def _included(
        self,
        place: Place,
        file: Cell | None,
        defaults: Mapping[str, Cell],
        open_tables: tuple[Path, ...],
    ) -> Iterator[MeantRow]:
        if file is None or file.text == EMPTY:
            raise place.error(
                "the table to include is missing", hint=f"its path belongs in {_INCLUDED_FILE!r}"
            )
        path = existing(file, "table")
        if path.resolve() in open_tables:
            raise file.place.error("the table includes itself", value=file.text)
        try:
            table = read_table(path)
        except UserError as error:
            every = [_of_include(one, place) for one in (error, *error.further)]
            raise together(every) from None
        via = (f"{place.file.name}:{place.line}", *place.via)
        self._notes += [f"{path}: {note}" for note in table.notes]
        yield from self.rows(table, defaults, via, (*open_tables, path.resolve()))

    def _forms(
        self, table: Table, outer: Mapping[str, Cell], via: tuple[str, ...]
    ) -> dict[str, ColumnForm]:
        """Find the declaration of each column; keep what is unknown, doubled or missing."""
        included = "".join(f" (included by {row})" for row in via)
        forms: dict[str, ColumnForm] = {}
        meant: list[str] = []
        for column in dict.fromkeys(table.columns):
            form = find_form(column)
            if form is None:
                known = [form.column for form in column_forms()]
                near = meant_columns(column, column_forms())
                meant += near[:1]
                allowed = near or known
                self._mistakes.add(
                    table.header_error(f"unknown column{included}", column, allowed=allowed)
                )
            elif list(table.columns).count(column) > 1:
                self._mistakes.add(
                    table.header_error(f"the column is given twice{included}", column)
                )
            else:
                forms[column] = form
        for form in column_forms():
            if form.required and form.column not in (*table.columns, *outer, *meant):
                self._mistakes.add(
                    UserError(
                        f"column {form.column!r} is missing{included}",
                        file=table.path,
                        line=table.header_line,
                        hint=f"it holds the {form.meaning}",
                    )
                )
        return forms

    def _cells(
        self, table: Table, row: Row, forms: Mapping[str, ColumnForm], via: tuple[str, ...]
    ) -> dict[str, Cell]:
        """Give the cells of a row that have content, assignments as cells of their own."""
        found: dict[str, Cell] = {}
        for column in forms:
            text = row.cells[column]
            if not text or column == CASE_COLUMN:
                continue
            cell = Cell(text, table.place(row, column, via))
            parts = [(column, cell)]
            if column in ASSIGNING:
                parts = [] if text != EMPTY else [(column, cell)]
                for part in _SEPARATOR.split(text) if text != EMPTY else ():
                    if part:
                        with self._mistakes.kept():
                            parts.append(_assigned(cell.place, part))
            for name, part_cell in parts:
                if name in found:
                    self._mistakes.add(
                        part_cell.place.error(
                            f"{name} is given twice",
                            value=part_cell.text,
                            hint=f"the other one is in {found[name].place.words}",
                        )
                    )
                found[name] = part_cell
        return found


def _assigned(place: Place, text: str) -> tuple[str, Cell]:
    """Take an assignment of a cell apart into its column and a cell of its own."""
    head = ASSIGNING[place.header]
    if head:
        match = _CHECK.fullmatch(text)
        name, value = match.groups() if match else (text, "")
    else:
        name, _, value = (part.strip() for part in text.partition("="))
    if not value:
        allowed = "METRIC=CONDITION" if head else "COLUMN=VALUE"
        raise place.error("the assignment has no value", value=text, allowed=allowed)
    if head:
        name = head + name.removeprefix(head)
    form = find_form(name)
    fits = form is not None and (form.kind == "check" if head else form.is_input)
    if not fits:
        forms = [f for f in column_forms() if (f.kind == "check" if head else f.is_input)]
        raise place.error(
            f"the column cannot be assigned in {place.header}",
            value=name,
            allowed=meant_columns(name, forms) or [form.column for form in forms],
        )
    own = Place(place.file, place.line, place.column, place.header, name, place.via)
    return name, Cell(value, own)


def _filled(
    columns: Iterable[str], defaults: Mapping[str, Cell], own: Mapping[str, Cell]
) -> dict[str, Cell]:
    """Fill what a row leaves empty with its defaults; `-` empties a cell.

    The order is that of the columns; assignments are where their column is, those of the defaults
    first.
    """
    both = _over(defaults, own)
    by_header: dict[str, list[str]] = {}
    for name, cell in both.items():
        origin = defaults.get(name, cell)
        by_header.setdefault(origin.place.header, []).append(name)
    headers = [*(c for c in columns if c in by_header), *by_header]
    names = dict.fromkeys(name for header in headers for name in by_header[header])
    return {name: both[name] for name in names if both[name].text != EMPTY}


def _over(defaults: Mapping[str, Cell], own: Mapping[str, Cell]) -> dict[str, Cell]:
    """Put cells over defaults; a whole cell of assignments that is empty leaves none of theirs."""
    emptied = {c for c in ASSIGNING if c in own and own[c].text == EMPTY}
    kept = {n: c for n, c in defaults.items() if not c.place.name or c.place.header not in emptied}
    return {**kept, **own}


def existing(cell: Cell, word: str) -> Path:
    """Return the file that a cell names, relative to the folder of its table.

    word: what the file is, for the message. Raises UserError when there is no such file.
    """
    folder = cell.place.file.parent
    path = folder / cell.text
    if cell.place.via:
        path = Path(os.path.normpath(path))  # results name it from the folder of the plan
    if not path.is_file():
        hint = near_files(folder, cell.text)
        raise cell.place.error(f"there is no such {word} file", value=cell.text, hint=hint)
    return path


def _of_include(error: UserError, place: Place) -> UserError:
    """Say in the error of a table which row includes it."""
    return UserError(
        f"{error.message} (included by {place.file.name}:{place.line})",
        file=error.file,
        line=error.line,
        column=error.column,
        value=error.value,
        allowed=error.allowed,
        hint=error.hint,
    )
