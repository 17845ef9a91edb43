"""Test plans: a table whose rows are cases, read and checked whole before anything runs.

A plan is CSV (UTF-8, separator comma or semicolon), XLSX or ODS (first sheet), or Parquet.
`columns.csv` declares the columns; an empty cell is a value that is not set. `composition` gives
rows their defaults and included tables, `expansion` makes runs of cells with several values. A row
without a check of `alarms` is checked for `alarms == none`, so that an alarm nobody expects fails
the case.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path
from zlib import crc32

from axisrig.bench.plan.assignment import (
    Assignment,
    find_form,
    parse_column,
)
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.case_statistics import split_statistics
from axisrig.bench.plan.checks import UNKNOWN_METRIC, Check, parse_check
from axisrig.bench.plan.composition import MeantRow, Mistakes, compose, existing
from axisrig.bench.plan.expansion import Variant, draw, parse_cell, variants
from axisrig.bench.plan.expectation import parse_expectation
from axisrig.bench.plan.own_metrics import OwnModule, own_module
from axisrig.bench.plan.probes import refuse_ids_of_probes, with_search
from axisrig.bench.plan.run_ids import SIGNS
from axisrig.bench.plan.searching import HEAD, Search, parse_row_check, parse_search
from axisrig.bench.plan.select import chosen
from axisrig.bench.plan.series import RUNS_MAX
from axisrig.bench.plan.table import Cell, Place
from axisrig.kernel.errors import UserError

__all__ = ["Plan", "default_seed", "read_plan"]

_NAME = re.compile(f"[{SIGNS}]{{1,60}}")
_SEED_MAX = 2**32 - 1
_REPEATS_MAX = 999
_FILES = ("program", "rig")


@dataclass(frozen=True)
class Plan:
    """A checked plan.

    name: the stem of the file. columns: in the order of the file, those of assignments where their
    cells are, then those of included tables.
    cases: one per run, in the order of the rows, all expanded. notes: what is not read.
    statistics: one per row of results that is over several runs of a case. texts: what was made of
    it, by name (`expanded_text`).
    """

    name: str
    path: Path
    columns: tuple[str, ...]
    cases: tuple[Case, ...]
    notes: tuple[str, ...] = ()
    statistics: tuple[Case, ...] = ()
    texts: dict[str, str] = field(init=False, default_factory=dict, repr=False, compare=False)

    @cached_property
    def rows(self) -> tuple[Case, ...]:
        """All rows of results, each of statistics after the last of its runs."""
        after = {case.runs[-1]: case for case in self.statistics}
        pairs = ((case, after.get(case.run)) for case in self.cases)
        return tuple(row for pair in pairs for row in pair if row is not None)

    def with_cases(self, change: Callable[[Case], Case]) -> "Plan":
        """Change every row, those of statistics too."""
        return replace(
            self,
            cases=tuple(change(case) for case in self.cases),
            statistics=tuple(change(case) for case in self.statistics),
        )

    def with_inputs(self, assignments: Sequence[Assignment], select: str | None = None) -> "Plan":
        """Set inputs of every case, over what the cells say (`--set` of the command line).

        A file is named from the working folder.

        select: of `-k`; a case that it does not choose keeps a column with several values. Raises
        UserError for one that it chooses, or that cannot be read.
        """
        extra = {item.column: item.anchored(Path()).value for item in assignments}
        wanted = self.cases if select is None else chosen(self.cases, select)
        for case in wanted:
            for column, header in _several(case).items():
                if column in extra:
                    raise UserError(
                        f"--set {column}: the plan gives this column several values"
                        f" (case {case.case!r}, {case.places[header].words})",
                        value=extra[column],
                        hint="choose other runs with -k, or change the cell",
                    )
        columns = (*self.columns, *(name for name in extra if name not in self.columns))
        cases, statistics = (
            tuple(_with_inputs(case, extra) for case in group)
            for group in (self.cases, self.statistics)
        )
        return replace(self, columns=columns, cases=cases, statistics=statistics)


def selected(plan: Plan, select: str | None, *, may_be_none: bool = False) -> Plan:
    """Return a plan with the cases that fit `-k`; None: all.

    Raises UserError for an expression that cannot be read, and where nothing fits, unless that may
    be.
    """
    if select is None:
        return plan
    cases = chosen(plan.cases, select)
    if not cases and not may_be_none:
        hint = f"axisrig check {plan.path} -v lists the cases"
        raise UserError("no case fits", value=select, hint=hint)
    return replace(plan, cases=cases)


def counted(runs: int, statistics: int) -> str:
    """Say how many runs there are, and how many rows of statistics over several of them."""
    words = f"{runs} run{'s' if runs != 1 else ''}"
    if not statistics:
        return words
    return f"{words} and {statistics} row{'s' if statistics != 1 else ''} of statistics"


def _several(case: Case) -> dict[str, str]:
    """Return the columns to which the row of a case gives several values, with their headers."""
    searched = {} if case.search is None else {case.search.column: HEAD + case.search.column}
    return {**{column: column for column in case.swept}, **searched}


def _with_inputs(case: Case, extra: Mapping[str, str]) -> Case:
    several = _several(case)
    extra = {column: value for column, value in extra.items() if column not in several}
    return replace(case, inputs={**case.inputs, **extra}, overridden=frozenset(extra))


def default_seed(run: str) -> int:
    """Return the seed of a run whose row gives none."""
    return crc32(run.encode())


def _nothing_more(_case: Case) -> None:
    """Look at nothing."""


def read_plan(path: Path, look: Callable[[Case], object] = _nothing_more) -> Plan:
    """Read and check a plan.

    look: raises UserError for what is wrong with a run beyond the plan itself. It is called where
    the plan is refused, so that all is reported at once, for the first run of each row as far as
    it could be read; its program or some of its checks may be missing.
    Raises UserError, with file, line and column, for everything that is wrong, the first by its
    place with the others in `further`: a table that cannot be read, an unknown or doubled column,
    a missing or bad value, a doubled case, a cell that cannot be expanded.
    """
    mistakes = Mistakes()
    if not _NAME.fullmatch(path.stem):
        mistakes.add(
            UserError(
                "the name of the plan becomes part of file names",
                file=path,
                value=path.stem,
                allowed="letters, digits, _ . -",
            )
        )
    composed = compose(path, mistakes)
    cases: list[Case] = []
    first_of_rows: list[Case] = []
    places: dict[str, Place] = {}
    for row in composed.rows:
        with mistakes.kept():
            read = _Row(path, row, mistakes)
            for case in read.cases(len(cases), first_of_rows):
                # File systems that ignore case would let the second one overwrite the first
                first = places.setdefault(case.run.casefold(), row.place)
                if first != row.place:
                    where = f"line {first.line}"
                    where += "" if first.file == row.place.file else f" of {first.file}"
                    raise row.place.error(f"the case makes the same run as {where}", value=case.run)
                cases.append(case)
    refuse_ids_of_probes(cases, mistakes)
    for case in first_of_rows if mistakes else ():
        with mistakes.kept():
            look(case)
    mistakes.refuse(path)
    runs, statistics = split_statistics(cases)
    return Plan(path.stem, path, composed.columns, runs, composed.notes, statistics)


class _Row:
    """A row on its way to its runs; what is wrong with single cells is kept in `mistakes`."""

    def __init__(self, path: Path, row: MeantRow, mistakes: Mistakes) -> None:
        self._plan, self._folder = path.stem, path.parent
        self._row = row
        self._mistakes = mistakes
        self._is_good = True
        self._has_wrong_check = False
        self._module: OwnModule | None = None
        self._has_module = True  # as far as the row names one
        if "module" in row.cells:
            try:
                self._module = own_module(row.cells["module"])
            except UserError as error:
                self._has_module = False
                self._refuse(error)
        forms = {column: find_form(column) for column in row.cells}
        kinds = {column: form for column, form in forms.items() if form is not None}
        self._inputs = [column for column, form in kinds.items() if form.is_input]
        self._checks = [column for column, form in kinds.items() if form.kind == "check"]
        self._notes = [column for column, form in kinds.items() if form.kind == "note"]
        self._searched = [column for column in kinds if column.startswith(HEAD)]
        # A value of a cell is read once, however many runs have it
        self._file_of = cache(self._file)
        self._check_of = cache(self._check)
        self._is_value = cache(self._is_number)

    def cases(self, index: int, first_of_rows: list[Case]) -> list[Case]:
        """Make the runs; none where a cell is wrong. index: place of the first in the plan.

        first_of_rows: gets the first of them, also where a cell is wrong.
        """
        name = self._row.text("case")
        if name and not _NAME.fullmatch(name):
            self._refuse(
                self._row.place.error(
                    "the name of the case becomes part of file names",
                    value=name,
                    allowed="letters, digits, _ . -; * gives defaults, include takes a table",
                )
            )
        search = self._search()
        self._refuse_two_units([] if search is None else self._searched)
        repeats = self._integer("repeats", 1, _REPEATS_MAX) or 1
        samples = self._integer("samples", 1, RUNS_MAX)
        try:
            count, expanded = variants(
                self._row,
                [*_FILES, "seed", *self._inputs],
                self._checks,
                repeats=repeats,
                samples=samples,
                seed=self._row.text("seed"),
            )
        except UserError as error:
            self._refuse(error)
            self._look_at_each_cell()
            return []
        if index + count > RUNS_MAX:
            raise self._row.place.error(
                f"the plan has more than {RUNS_MAX} runs", value=index + count
            )
        made = (self._case(name, index + at, variant) for at, variant in enumerate(expanded))
        found = [case for case in made if case is not None]
        if search is not None:
            found = [with_search(case, search) for case in found]
        found = [self._expecting(case) for case in found]
        first_of_rows += found[:1]
        return found if self._is_good else []

    def _refuse_two_units(self, searched: Sequence[str]) -> None:
        """Refuse a variable that two columns with different units set: the later one would win."""
        columns: dict[tuple[str, str, str], str] = {}
        for column in [*self._inputs, *searched]:
            item = parse_column(column.removeprefix(HEAD), "0")
            first = columns.setdefault((item.kind, item.target, item.name), column)
            if first != column:
                place = self._row.cells[column].place
                self._refuse(
                    place.error("the row sets this twice", value=column, hint=f"also {first}")
                )

    def _search(self) -> Search | None:
        """What the row searches; None where it searches nothing, or the cell is wrong."""
        try:
            for column in self._searched[1:]:
                raise self._row.cells[column].place.error("a row searches one value")
            for column in self._searched:
                return parse_search(column, self._row.cells[column], self._row.cells)
        except UserError as error:
            self._refuse(error)
        return None

    def _look_at_each_cell(self) -> None:
        """Find what else is wrong in a row that cannot be expanded."""
        for column in [*_FILES, *self._inputs, *self._checks]:
            cell = self._row.cells.get(column)
            is_condition = column in self._checks
            if cell is None or ("[" in cell.text and is_condition):
                continue
            with self._mistakes.kept():
                pattern = parse_cell(cell, is_condition=is_condition)
                if pattern.lists or pattern.drawn:
                    continue
                if column in _FILES:
                    self._file_of(column, cell.text)
                elif is_condition:
                    self._check_of(column, cell.text)
                else:
                    self._is_value(column, cell.text)

    def _expecting(self, case: Case) -> Case:
        """Say which checks of a case must fail."""
        if "expect" not in self._row.cells or self._has_wrong_check:
            return case
        try:
            return replace(case, expected=parse_expectation(self._row.cells["expect"], case.checks))
        except UserError as error:
            self._refuse(error)
        return case

    def _case(self, name: str, index: int, variant: Variant) -> Case | None:
        texts = variant.texts
        run = f"{self._plan}-{name}" + (f"-{variant.label}" if variant.swept else "")
        run += f"-{variant.number:03}" if variant.number else ""
        files = [self._file_of(column, texts.get(column, "")) for column in _FILES]
        seed = default_seed(run)
        if (given := self._seed(texts.get("seed", ""))) is not None:
            seed = (given + max(variant.number - 1, 0)) % (_SEED_MAX + 1)
        inputs = {column: texts[column] for column in self._inputs if column in texts}
        for column, (mean, deviation) in variant.drawn.items():
            inputs[column] = draw(column, mean, deviation, seed)
        for column, text in inputs.items():
            self._is_value(column, text)
        read = [self._check_of(c, texts[c]) for c in self._checks if c in texts]
        checks = [check for check in read if check is not None]
        if not name or files[1] is None:
            return None
        if not any(check.name == "alarms" for check in checks):
            checks.append(parse_check("alarms", "none", "no alarm unless a row expects it"))
        return Case(
            plan=self._plan,
            case=name,
            run=run,
            index=index,
            program=files[0] or Path(),
            rig=files[1],
            inputs=inputs,
            checks=tuple(checks),
            title=texts.get("title", ""),
            tags=tuple(texts.get("tags", "").split()),
            requirement=texts.get("requirement", ""),
            seed=seed,
            repeat=variant.number,
            file=self._row.place.file,
            line=self._row.place.line,
            places=self._places,
            swept=variant.swept,
            module=self._module,
            notes={column: texts[column] for column in self._notes if column in texts},
            folder=self._folder,
        )

    @property
    def _places(self) -> Mapping[str, Place]:
        return {column: cell.place for column, cell in self._row.cells.items()}

    def _refuse(self, error: UserError) -> None:
        self._is_good = False
        self._mistakes.add(error)

    def _cell(self, column: str, text: str) -> Cell:
        return Cell(text, self._row.cells[column].place)

    def _file(self, column: str, text: str) -> Path | None:
        """The file of a cell; None for one that is missing, which is kept."""
        if text:
            try:
                return existing(self._cell(column, text), column)
            except UserError as error:
                self._refuse(error)
        return None

    def _check(self, column: str, text: str) -> Check | None:
        place = self._row.cells[column].place
        try:
            own = None if self._module is None else self._module.metrics
            metric, reference = column.partition(":")[2], f"{place.file.name}:{place.line}"
            is_searching = bool(self._searched)
            return parse_row_check(metric, text, reference, own, is_searching=is_searching)
        except UserError as error:
            self._has_wrong_check = True
            for one in (error, *error.further):
                if self._has_module or one.message != UNKNOWN_METRIC:
                    self._refuse(place.error_from(one))
        return None

    def _is_number(self, column: str, text: str) -> None:
        """A value with a unit must be a number."""
        assignment = parse_column(column, text)
        if assignment.unit:
            try:
                assignment.si()
            except UserError as error:
                self._refuse(self._row.cells[column].place.error_from(error))

    def _seed(self, text: str) -> int | None:
        return self._whole("seed", text, 0, _SEED_MAX)

    def _integer(self, column: str, lowest: int, highest: int) -> int | None:
        return self._whole(column, self._row.text(column), lowest, highest)

    def _whole(self, column: str, text: str, lowest: int, highest: int) -> int | None:
        if not text:
            return None
        if not re.fullmatch("[0-9]{1,10}", text) or not lowest <= int(text) <= highest:
            self._refuse(
                self._row.cells[column].place.error(
                    "not an integer in the range", value=text, allowed=f"{lowest} to {highest}"
                )
            )
            return None
        return int(text)
