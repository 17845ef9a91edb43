"""The budget of a run in its card, from the table that `axisrig budget -o FOLDER` left."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from markupsafe import Markup

from axisrig.bench.campaign.results.layout import BUDGETS
from axisrig.bench.campaign.results.stored import StoredRun, read_rows
from axisrig.reports.budget.drawing import waterfall

FRAMES = "frame_log_sha256"
COLUMNS = (
    *("run", "axis", "cause", "setting", "effect", "alone_um", "in_turn_um"),
    *("closed_form_um", "bound_um", "meaning", FRAMES),
)
"""Of the table: a row for each cause, the last one for what is left with all of them off."""
TERM, COMBINED, DIFFERS = "term", "combined_um", "differs_um"
"""More columns of it; a table of an older release has none of them."""
_HEAD = (
    *(("Cause", ""), ("Setting", ""), ("Effect", ""), ("alone, um", "right")),
    *(("in turn, um", "right"), ("mean, um", "right"), ("closed form, um", "right")),
    ("Meaning", ""),
)


def budget_path(folder: Path, run: str) -> Path:
    """Return where a results folder has the budget of a run."""
    return folder / BUDGETS / f"{run}.csv"


def budget_section(folder: Path, run: StoredRun) -> Markup:
    """Write waterfall and table of a run; empty without a budget, a note for one of other frames.

    Raises UserError for a table that lacks columns, ValueError for cells that are no numbers.
    """
    path = budget_path(folder, run.recorded)
    if not path.is_file():
        return Markup("")
    rows = read_rows(path, COLUMNS)[1]
    frames = {row[FRAMES] for row in rows}
    if frames != {run.case[FRAMES]}:
        words = "The budget of this run was made of other frames: <code>axisrig budget</code>"
        return Markup(f'<p class="note">{words} makes it again.</p>')
    axis = escape(rows[0]["axis"]) if rows else ""
    return Markup(
        f'<section class="budget"><h4>Budget of the measured value, axis {axis}</h4>'
        f"<figure>{_picture(rows)}</figure>{budget_rows(rows)}</section>"
    )


def _picture(rows: Sequence[Mapping[str, str]]) -> str:
    *causes, left = [(row["cause"], float(row["in_turn_um"])) for row in rows]
    return waterfall([left, *causes], sum(size for _, size in (left, *causes)))


def budget_rows(rows: Sequence[Mapping[str, str]]) -> str:
    """Write the table of a budget; rows: as in its file."""
    head = "".join(
        f'<th scope="col"{f" class={side}" if side else ""}>{name}</th>' for name, side in _HEAD
    )
    body = "".join(
        f'<tr><th scope="row">{escape(row["cause"])}</th><td>{escape(row["setting"])}</td>'
        f'<td>{_effect(row)}</td><td class="right">{_signed(row["alone_um"])}</td>'
        f'<td class="right">{_signed(row["in_turn_um"])}</td>'
        f'<td class="right">{_signed(row.get(COMBINED) or "")}</td>'
        f'<td class="right">{_form(row)}</td>'
        f"<td>{escape(row['meaning'])}</td></tr>"
        for row in rows
    )
    return (
        f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
        '</div><p class="note">Alone: the error less that of the same run without this cause. In'
        " turn: the same with all causes off that act after it; these add up to the error of the"
        " published value. Mean: over all orders, where causes act on each other. Systematic"
        " and random as in the GUM.</p>"
    )


def _effect(row: Mapping[str, str]) -> str:
    """Write the effect in the word of the GUM, and the term of the standard for it."""
    return escape(", ".join(filter(None, [row["effect"], row.get(TERM) or ""])))


def _signed(text: str) -> str:
    return f"{float(text):+z.4f}" if text else ""


def _form(row: Mapping[str, str]) -> str:
    form = _signed(row["closed_form_um"])
    if row["bound_um"]:
        form = f"&plusmn; {float(row['bound_um']):.4f}"
    differs = row.get(DIFFERS)
    return f"{form}, differs by {_signed(differs)}" if differs else form
