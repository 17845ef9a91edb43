"""Test plans: a table whose rows are cases, read and checked whole before anything runs.

A plan is CSV (UTF-8, separator comma or semicolon), XLSX or ODS (first sheet). `columns.csv`
declares the columns; an empty cell is a value that is not set. A row without a `check:alarms`
cell is checked for `alarms == none`, so that an alarm nobody expects fails the case.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from zlib import crc32

from axisrig.bench.plan.assignment import (
    Assignment,
    ColumnForm,
    column_forms,
    find_form,
    parse_assignment,
    parse_column,
)
from axisrig.bench.plan.checks import Check, parse_check
from axisrig.bench.plan.statistic_checks import StatisticCheck, parse_any_check, split_statistics
from axisrig.bench.plan.table import Row, Table, read_table
from axisrig.kernel.errors import UserError, nearest

__all__ = ["Assignment", "Case", "Plan", "parse_assignment", "read_plan"]

_NAME = re.compile(r"[A-Za-z0-9_.-]{1,60}")
_SEED_MAX = 2**32 - 1
_REPEATS_MAX = 999


@dataclass(frozen=True)
class Case:
    """One run of one row of a plan.

    run: id, unique in a results folder, the same on every repeat, safe as a file name.
    index: place of the run in its plan, from 0. program, rig: existing files.
    inputs: input column -> cell, set cells only, in the order of the columns.
    repeat: 0 when the row asks for one run, else counted from 1.
    file, line: place of the row. columns: column -> its number in the file, from 1.
    overridden: input columns whose values come from the command line.
    sampled: statistics of the case to which the run gives values. runs: of the row of results that
    is over several runs, the ids of these; empty for a run.
    """

    plan: str
    case: str
    run: str
    index: int
    program: Path
    rig: Path
    inputs: Mapping[str, str]
    checks: tuple[Check, ...]
    title: str
    tags: tuple[str, ...]
    requirement: str
    seed: int
    repeat: int
    file: Path
    line: int
    columns: Mapping[str, int]
    overridden: frozenset[str] = frozenset()
    sampled: tuple[StatisticCheck, ...] = ()
    runs: tuple[str, ...] = ()

    def assignments(self) -> tuple[Assignment, ...]:
        """Give the inputs taken apart, in the order of the columns."""
        return tuple(parse_column(column, value) for column, value in self.inputs.items())

    def error(
        self,
        message: str,
        column: str,
        *,
        value: object = None,
        allowed: Sequence[object] | str | None = None,
        hint: str | None = None,
    ) -> UserError:
        """Make the error that points at the cell of this case in `column`."""
        if column in self.overridden:
            return UserError(
                f"--set {column}={self.inputs[column]}: {message}",
                value=value,
                allowed=allowed,
                hint=hint,
            )
        return UserError(
            f"{message} (case {self.case!r}, column {column!r})",
            file=self.file,
            line=self.line if column in self.columns else None,
            column=self.columns.get(column),
            value=value,
            allowed=allowed,
            hint=hint,
        )


@dataclass(frozen=True)
class Plan:
    """A checked plan.

    name: the stem of the file. columns: headers in the order of the file.
    cases: one per run, in the order of the rows, repeats expanded. notes: what is not read.
    statistics: one per row of results that is over several runs of a case.
    """

    name: str
    path: Path
    columns: tuple[str, ...]
    cases: tuple[Case, ...]
    notes: tuple[str, ...] = ()
    statistics: tuple[Case, ...] = ()

    @property
    def rows(self) -> tuple[Case, ...]:
        """All rows of results, each of statistics after the last of its runs."""
        after = {case.runs[-1]: case for case in self.statistics}
        pairs = ((case, after.get(case.run)) for case in self.cases)
        return tuple(row for pair in pairs for row in pair if row is not None)

    def with_inputs(self, assignments: Sequence[Assignment]) -> "Plan":
        """Set inputs of every case, over what the cells say (`--set` of the command line)."""
        extra = {item.column: item.value for item in assignments}
        columns = (*self.columns, *(name for name in extra if name not in self.columns))
        cases, statistics = (
            tuple(
                replace(case, inputs={**case.inputs, **extra}, overridden=frozenset(extra))
                for case in group
            )
            for group in (self.cases, self.statistics)
        )
        return replace(self, columns=columns, cases=cases, statistics=statistics)


def default_seed(run: str) -> int:
    """Return the seed of a run whose row gives none."""
    return crc32(run.encode())


def read_plan(path: Path) -> Plan:
    """Read and check a plan.

    Raises UserError, with file, line and column, for the first thing that is wrong: a table that
    cannot be read, an unknown or doubled column, a missing or bad value, a doubled case.
    """
    table = read_table(path)
    if not _NAME.fullmatch(path.stem):
        raise UserError(
            "the name of the plan becomes part of file names",
            file=path,
            value=path.stem,
            allowed="letters, digits, _ . -",
        )
    forms = _check_columns(table)
    if not table.rows:
        raise UserError("the plan has no case", file=path, hint="add a row below the header")
    cases: list[Case] = []
    lines: dict[str, int] = {}
    for row in table.rows:
        for case in _read_row(table, row, forms, len(cases)):
            # File systems that ignore case would let the second one overwrite the first.
            first = lines.setdefault(case.run.casefold(), row.line)
            if first != row.line:
                raise table.error(
                    f"the case makes the same run as line {first}", row, "case", value=case.run
                )
            cases.append(case)
    runs, statistics = split_statistics(cases)
    return Plan(path.stem, path, tuple(table.columns), runs, tuple(table.notes), statistics)


def _check_columns(table: Table) -> dict[str, ColumnForm]:
    """Find the declaration of each column. Raises UserError for unknown, doubled, missing ones."""
    forms: dict[str, ColumnForm] = {}
    for column in table.columns:
        form = find_form(column)
        if form is None:
            close = nearest(column, [form.column for form in column_forms()])
            raise table.header_error(
                "unknown column",
                column,
                allowed=close or [form.column for form in column_forms()],
            )
        if column in forms:
            raise table.header_error("the column is given twice", column)
        forms[column] = form
    for form in column_forms():
        if form.required and form.column not in forms:
            raise UserError(
                f"column {form.column!r} is missing",
                file=table.path,
                line=table.header_line,
                hint=f"it holds the {form.meaning}",
            )
    return forms


def _read_row(table: Table, row: Row, forms: Mapping[str, ColumnForm], index: int) -> list[Case]:
    """Read one row into its runs."""
    for column, form in forms.items():
        if form.required and not row.cells[column]:
            raise table.error("the value is missing", row, column)
    name = row.cells["case"]
    if not _NAME.fullmatch(name):
        raise table.error(
            "the name of the case becomes part of file names",
            row,
            "case",
            value=name,
            allowed="letters, digits, _ . -",
        )
    repeats = _integer(table, row, "repeats", 1, _REPEATS_MAX) or 1
    seed = _integer(table, row, "seed", 0, _SEED_MAX)
    inputs = {c: row.cells[c] for c, form in forms.items() if form.is_input and row.cells[c]}
    for column, value in inputs.items():
        _check_unit_value(table, row, parse_column(column, value))
    base = f"{table.path.stem}-{name}"
    runs = [base] if repeats == 1 else [f"{base}-{count:03}" for count in range(1, repeats + 1)]
    return [
        Case(
            plan=table.path.stem,
            case=name,
            run=run,
            index=index + count,
            program=_existing(table, row, "program"),
            rig=_existing(table, row, "rig"),
            inputs=inputs,
            checks=_checks(table, row, forms),
            title=row.cells.get("title", ""),
            tags=tuple(row.cells.get("tags", "").split()),
            requirement=row.cells.get("requirement", ""),
            seed=default_seed(run) if seed is None else (seed + count) % (_SEED_MAX + 1),
            repeat=0 if repeats == 1 else count + 1,
            file=table.path,
            line=row.line,
            columns=table.numbers,
        )
        for count, run in enumerate(runs)
    ]


def _check_unit_value(table: Table, row: Row, assignment: Assignment) -> None:
    """A value with a unit must be a number."""
    if assignment.unit:
        try:
            assignment.si()
        except UserError as error:
            raise table.error_from(error, row, assignment.column) from None


def _checks(table: Table, row: Row, forms: Mapping[str, ColumnForm]) -> tuple[Check, ...]:
    """The checks of a row, with the one for alarms added where the row has none."""
    reference = f"{table.path.name}:{row.line}"
    checks = []
    for column, form in forms.items():
        if form.kind == "check" and row.cells[column]:
            metric = column.partition(":")[2]
            try:
                checks.append(parse_any_check(metric, row.cells[column], reference))
            except UserError as error:
                raise table.error_from(error, row, column) from None
    if not any(check.name == "alarms" for check in checks):
        checks.append(parse_check("alarms", "none", "no alarm unless a row expects it"))
    return tuple(checks)


def _existing(table: Table, row: Row, column: str) -> Path:
    """The file a cell names, relative to the folder of the plan."""
    path = table.path.parent / row.cells[column]
    if not path.is_file():
        folder = path.parent
        beside = [item.name for item in folder.iterdir()] if folder.is_dir() else []
        close = nearest(path.name, beside)
        raise table.error(
            f"there is no such {column} file",
            row,
            column,
            value=row.cells[column],
            hint=f"near it: {', '.join(close)}" if close else f"looked in {folder}",
        )
    return path


def _integer(table: Table, row: Row, column: str, lowest: int, highest: int) -> int | None:
    text = row.cells.get(column, "")
    if not text:
        return None
    if not re.fullmatch("[0-9]{1,10}", text) or not lowest <= int(text) <= highest:
        raise table.error(
            "not an integer in the range", row, column, value=text, allowed=f"{lowest} to {highest}"
        )
    return int(text)
