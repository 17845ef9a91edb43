"""Plans written out: a row for each run, and files as cells name them."""

import csv
import io
from functools import lru_cache
from pathlib import Path

from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import Check
from axisrig.bench.plan.info import INFO
from axisrig.bench.plan.plan import Plan
from axisrig.bench.plan.searching import HEAD


def expanded_text(plan: Plan) -> str:
    """Write a plan with a row for each run, as CSV: a plan itself, with the same ids and seeds.

    Statistics over several runs are left out, for each run is a case of its own there.
    """
    if _EXPANDED not in plan.texts:  # a plan does not change, and its results come again and again
        plan.texts[_EXPANDED] = _expanded(plan)
    return plan.texts[_EXPANDED]


_EXPANDED = "expanded"


def _expanded(plan: Plan) -> str:
    inputs = list(dict.fromkeys(column for case in plan.cases for column in case.inputs))
    noted = dict.fromkeys(column for case in plan.cases for column in case.notes)
    notes = [column for column in noted if not column.startswith(INFO)]  # of rigs and the call
    has_files = any(parse_column(column, "").names_file for column in inputs)
    every = {case.run: (*case.checks, *_probed(case)) for case in plan.cases}
    checks = list(dict.fromkeys(f"check:{c.metric}" for of in every.values() for c in of))
    searched = {
        case.run: {HEAD + case.search.column: case.search.text}
        for case in plan.cases
        if case.search is not None
    }
    inputs += dict.fromkeys(column for cells in searched.values() for column in cells)
    columns = ["case", "title", "tags", "requirement", "program", "rig", "seed", "expect", "module"]
    text = io.StringIO(newline="")
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*columns, *notes, *inputs, *checks])
    of_row = (*inputs, *checks)
    for case in plan.cases:
        conditions = {f"check:{check.metric}": check.condition.text for check in every[case.run]}
        own = [
            case.run.removeprefix(f"{plan.name}-"),
            case.title,
            " ".join(case.tags),
            case.requirement,
            *(path_from(case.folder, path) for path in (case.program, case.rig)),
            str(case.seed),
            f"fail:{' '.join(case.expected)}" if case.expected else "",
            "" if case.module is None else case.module.text_in(case.folder),
        ]
        texts = [case.notes.get(column, "") for column in notes]  # whatever they are, they stay
        of_case = {**case.inputs, **(_files(case) if has_files else {})}
        cells = {**of_case, **searched.get(case.run, {}), **conditions}
        # A value as a cell that stands for nothing else
        table.writerow([*own, *texts, *[cells.get(c, "").replace("[", "[[") for c in of_row]])
    return text.getvalue()


def _files(case: Case) -> dict[str, str]:
    """Return the cells of an included table that name a file, as the plan would name it."""
    folder, found = case.folder.resolve(), {}
    for item in case.assignments():
        place = case.places.get(item.column)
        if item.names_file and place is not None and place.file.parent != case.folder:
            found[item.column] = path_from(folder, Path(item.value))
    return found


def _probed(case: Case) -> tuple[Check, ...]:
    return () if case.search is None else case.search.checks


@lru_cache(maxsize=4096)  # a campaign asks for the same files again and again
def path_from(folder: Path, path: Path) -> str:
    """A file as a cell of a plan in `folder` names it."""
    return (path.relative_to(folder) if path.is_relative_to(folder) else path).as_posix()
