"""A case: one run of one row of a plan."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from axisrig.bench.plan.assignment import Assignment, parse_column
from axisrig.bench.plan.checks import Check
from axisrig.bench.plan.own_metrics import OwnModule
from axisrig.bench.plan.searching import Search
from axisrig.bench.plan.statistic_checks import StatisticCheck
from axisrig.bench.plan.table import Place
from axisrig.kernel.errors import UserError


@dataclass(frozen=True)
class Case:
    """One run of one row of a plan.

    run: id, unique in a results folder, the same on every repeat, safe as a file name.
    index: place of the run in its plan, from 0. program, rig: existing files.
    inputs: input column -> value, set ones only, in the order of the columns.
    repeat: 0 when the row asks for one run, else counted from 1, over samples and repeats.
    file, line: place of the row. places: column -> place of its cell, set cells only.
    overridden: input columns whose values come from the command line.
    swept: columns whose cells hold several values -> the value of this run.
    module: metrics of the user. expected: metrics of checks that must fail.
    notes: columns `note:` -> cell.
    folder: of the plan, which is not that of an included table.
    sampled: statistics of the case to which the run gives values. runs: of the row of results that
    is over several runs, the ids of these; empty for a run.
    search: of a row that searches a value; its runs are probes. probe_of: of a probe, the row.
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
    places: Mapping[str, Place]
    overridden: frozenset[str] = frozenset()
    swept: Mapping[str, str] = field(default_factory=dict)
    module: OwnModule | None = None
    expected: tuple[str, ...] = ()
    notes: Mapping[str, str] = field(default_factory=dict)
    folder: Path = Path()
    sampled: tuple[StatisticCheck, ...] = ()
    runs: tuple[str, ...] = ()
    search: Search | None = None
    probe_of: str = ""

    def assignments(self) -> tuple[Assignment, ...]:
        """Give the inputs taken apart, in the order of the columns.

        A cell that names a file does so from the folder of its table.
        """
        found = []
        for column, value in self.inputs.items():
            place = self.places.get(column)
            table = self.file if place is None else place.file
            found.append(parse_column(column, value).anchored(table.parent))
        return tuple(found)

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
        place = self.places.get(column)
        words = f"column {column!r}" if place is None else place.words
        return UserError(
            f"{message} (case {self.case!r}, {words})",
            file=self.file if place is None else place.file,
            line=None if place is None else place.line,
            column=None if place is None else place.column,
            value=value,
            allowed=allowed,
            hint=hint,
        )
