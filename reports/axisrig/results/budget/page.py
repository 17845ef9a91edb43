"""Writes a budget of errors: a table, or a page with a waterfall."""

import csv
from collections.abc import Callable, Mapping
from importlib import resources
from io import StringIO
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.files import write_whole
from axisrig.bench.tools.budget.budget import Budget
from axisrig.bench.tools.budget.words import budget_table, not_explained
from axisrig.kernel.errors import UserError
from axisrig.reports.budget.drawing import budget_style, waterfall
from axisrig.reports.budget.section import budget_path, budget_rows
from axisrig.reports.parts.shipped import page_style


def write_budget(path: Path, budget: Budget) -> Path:
    """Write a budget as what the ending of the file says.

    Raises UserError for another ending, OSError with the name of the file.
    """
    kinds: Mapping[str, Callable[[Budget], str]] = {".csv": _csv, ".html": _html}
    if path.suffix.lower() not in kinds:
        raise UserError("no kind of a budget", value=str(path), allowed=list(kinds))
    write_whole(path, kinds[path.suffix.lower()](budget))
    return path


def add_budget(folder: Path, budget: Budget) -> Path:
    """Put a budget into the results folder that has its run, for the report; return its path.

    Raises UserError where the folder is none, has no such run, or one with other frames.
    """
    found = [run for run in read_results(folder).runs if run.run == budget.run]
    if not found or found[0].case["frame_log_sha256"] != budget.frame_log_sha256:
        what = "other frames than this budget" if found else "no such run"
        raise UserError(
            f"the results folder has {what}",
            file=folder,
            value=budget.run,
            hint="run the row with the same settings into the folder first",
        )
    path = budget_path(folder, budget.run)
    path.parent.mkdir(exist_ok=True)
    write_whole(path, _csv(budget))
    return path


def _csv(budget: Budget) -> str:
    rows = budget_table(budget)
    text = StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _html(budget: Budget) -> str:
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    here = resources.files(__package__)
    template = environment.from_string(here.joinpath("budget.html").read_text(encoding="utf-8"))
    steps = [("left with all causes off", budget.left_um)]
    steps += [(share.cause.cause, share.in_turn_um) for share in budget.shares]
    rows = [
        {k: "" if v is None else str(v) for k, v in row.items()} for row in budget_table(budget)
    ]
    view = {
        "budget": budget,
        "unexplained": not_explained(budget),
        "waterfall": Markup(waterfall(steps, budget.error_um)),
        "table": Markup(budget_rows(rows)),
    }
    return template.render(style=page_style() + budget_style(), **view)
