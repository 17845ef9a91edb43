"""What parameters there are: a list, one explained, a CSV table, the page for the documents."""

import csv
import io
from collections.abc import Sequence
from textwrap import fill

from axisrig.bench.rig.parameter_words import (
    acts,
    chain,
    chosen,
    default,
    every_parameter,
    named,
    range_of,
    unit_of,
    warning,
)
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.parameters import UNITS, Parameter, names, table
from axisrig.kernel.parameters.errata import errata
from axisrig.kernel.parameters.relations import relations
from axisrig.kernel.parameters.table import TOPICS

COLUMNS = (
    "number", "kind", "topic", "path", "older_names", "type", "unit", "rotary_unit", "range",
    "default", "while_unset", "warning", "acts", "meaning", "source",
)  # fmt: skip
_PAGE = """\
# Parameters

Made by `axisrig params --format markdown`; do not edit. `axisrig params` lists them; with a number,
a path or an older name it explains one (`axisrig params P-AXIS-00774`), with other words it lists
those they fit. `axisrig params LIST` shows what a list sets, `axisrig params --rig RIG` what a rig
has and where each value comes from, `axisrig params diff A B` what two lists or rigs differ in,
`axisrig params write RIG` prints its axis lists as one.

A list has one name and one value in a line; `#`, `;` and ` (` begin a comment, texts with blanks
are in quotes, whole numbers may be hexadecimal (`0x40`), a BOOL is 0 or 1. Several axes may be
in one list: each begins with its `kopf.achs_nr`, and `[axis.A]` of a rig takes the part whose
`kopf.log_achs_name` is `A`. Older names set the same parameter as the present one.

**Acts.** A list may hold everything below. `axisrig check` and the log of a run report what does
not act yet; in a cell `set:` of a plan it is refused
([decision 3](decisions/0003-inert-parameters.md)).

**While unset.** Who decides while the value says that it is not set, link by link.

**Warning.** A value out of its range is corrected as the control does it, and the warning of class
1 comes up when the run begins. Where there is none, the list is refused. Where the limit is another
parameter, `axisrig params NUMBER` names it: speeds are corrected to it (900522), accelerations and
ramp times are noted.
"""


def parameters_text(words: Sequence[str], form: str) -> str:
    """Return the parameters that fit all `words`, as text, csv or markdown.

    A single word that means one parameter explains it. Raises UserError if nothing fits.
    """
    one = named(words[0]) if len(words) == 1 and form == "text" else None
    if one is not None:
        return explained(one)
    rows = chosen(words)
    if not rows:
        known = [name for row in every_parameter() for name in (row.number, *names(row)) if name]
        text = " ".join(words)
        raise UserError("no parameter fits", value=text, allowed=nearest(text, known) or None)
    return {"text": _list, "csv": _csv, "markdown": page}[form](rows)


def _list(rows: Sequence[Parameter]) -> str:
    lines = []
    for row in rows:
        what = f"{row.type} {row.unit}".rstrip()
        lines.append(f"{row.number or '-':<13} {row.path:<58} {what:<14} {default(row):<12}"
                     f" {acts(row)}".rstrip())  # fmt: skip
    head = f"{'number':<13} {'path':<58} {'type, unit':<14} {'default':<12} acts"
    return "\n".join([head, *lines])


def explained(row: Parameter) -> str:
    """Say all about one parameter."""
    unit = UNITS.get(row.unit)
    rotary = ""
    if unit is not None and unit.rotary != unit.name:
        rotary = f" (rotary axis: {unit.rotary})"
    scale = f"; {unit.divisor} are 1 {unit.kernel}" if unit and unit.divisor > 1 else ""
    facts = {
        "type": f"{row.type} {row.unit}".rstrip() + rotary + scale,
        "range": range_of(row),
        "limits": _limits(row),
        "default": default(row),
        "while unset": chain(row),
        "warning": warning(row),
        "older names": ", ".join(row.old_paths),
        "acts": acts(row),
        "list": f"{row.kind}, {TOPICS[row.topic]}",
        "source": row.source,
    }
    lines = [f"  {name:<12} {text}" for name, text in facts.items() if text]
    head = f"{row.number}  {row.path}".strip()
    return "\n".join(
        [head, fill(row.meaning, 96, initial_indent="  ", subsequent_indent="  "), *lines]
    )


def _limits(row: Parameter) -> str:
    """Say which other parameters limit this one, of those of an axis."""
    find = table("axis").find
    return "; ".join(
        f"{each.relation} {each.limit} ({find(each.limit)[0].number}), {each.reaction}"
        for each in relations()
        if find(each.path)[0] is row
    )


def _csv(rows: Sequence[Parameter]) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        writer.writerow(
            [row.number, row.kind, row.topic.removesuffix(".csv"), row.path,
             " ".join(row.old_paths), row.type, row.unit, unit_of(row, is_rotary=True),
             range_of(row), default(row), chain(row), warning(row), acts(row), row.meaning,
             row.source]
        )  # fmt: skip
    return out.getvalue().rstrip("\n")


def page(rows: Sequence[Parameter]) -> str:
    """Return the page of the documents, with the topics that `rows` have."""
    parts = [_PAGE]
    for topic, title in TOPICS.items():
        of_topic = [row for row in rows if row.topic == topic]
        if of_topic:
            parts.append("\n".join([f"## {title}", "", _HEAD, *map(_line, of_topic), ""]))
    parts.append(_units())
    parts.append(_errata())
    return "\n".join(parts).rstrip("\n")


_HEAD = (
    "| parameter | value | default | while unset | acts | meaning | source |\n" + "|---" * 7 + "|"
)


def _line(row: Parameter) -> str:
    name = f"`{row.path}`" + (f" {row.number}" if row.number else "")
    if row.old_paths:
        name += "; older: " + ", ".join(f"`{path}`" for path in row.old_paths)
    value = f"{row.type}, {range_of(row)} {row.unit}".rstrip()
    if row.correction:
        value += f"; warning {warning(row)}"
    cells = [name, value, default(row), chain(row), acts(row), row.meaning, row.source]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _units() -> str:
    lines = ["## Units", "", "| linear axis | rotary axis | so many | are |", "|---|---|---|---|"]
    for unit in UNITS.values():
        if unit.divisor > 1 or unit.rotary != unit.name:
            kernel = unit.kernel
            if unit.rotary_kernel != kernel:
                kernel += f" ({unit.rotary_kernel})"
            lines.append(f"| {unit.name} | {unit.rotary} | {unit.divisor} | 1 {kernel} |")
    return "\n".join([*lines, ""])


def _errata() -> str:
    lines = [
        "## Damaged names of the printed lists",
        "",
        "A damaged name is refused, and the message says what it means. The sample lists of the"
        " manuals have these:",
        "",
        "| printed | meant | place |",
        "|---|---|---|",
    ]
    for printed, right, source in sorted(errata(), key=lambda row: (row[2], row[0])):
        before, after = (" / ".join(text.splitlines()) for text in (printed, right))
        lines.append(f"| `{before}` | `{after}` | {source} |")
    return "\n".join([*lines, ""])
