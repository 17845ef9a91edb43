"""What an FMU holds beside its description and code: documentation, licences, icon, terminals.

Source: FMI specifications 2.0.4, section 2.3, and 3.0.2, sections 2.5 (folders) and 2.4.9
(terminals: members of terminals with one name and rule are to be joined).
"""

import csv
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from axisrig.fmus.reading.target import TARGET
from axisrig.fmus.reading.texts import Texts
from axisrig.fmus.writing.description import AUTHOR, templates
from axisrig.fmus.writing.icon import draw
from axisrig.fmus.writing.variables import Variable

TERMINALS_FILE = Path(__file__).parent / "terminals.csv"
# Of a model with two of a kind, as in its names of variables
_SUFFIXES = ("", "_1", "_2", "_z", "_a")


def other_files(
    model: str, texts: Texts, variables: Sequence[Variable], head: Mapping[str, str], fmi: str
) -> dict[str, bytes]:
    """Content by name in the archive. head: attributes that the model description has."""
    icon = draw(texts, model)
    found = {
        "documentation/index.html": _page(model, texts, variables, head).encode(),
        "documentation/licenses/license.txt": _licences(head).encode(),
        "documentation/licenses/Apache-2.0.txt": (TARGET / "Apache-2.0.txt").read_bytes(),
    }
    if fmi == "2.0":
        return found | {"model.png": icon}
    terminals = {
        "terminalsAndIcons/icon.png": icon,
        "terminalsAndIcons/terminalsAndIcons.xml": _terminals(variables).encode(),
    }
    return found | terminals


def _licences(head: Mapping[str, str]) -> str:
    """What may be done with which part of the FMU."""
    return (
        templates()
        .get_template("license.txt.jinja")
        .render(is_own=head.get("author") == AUTHOR, copyright=head.get("copyright", ""))
    )


def _page(model: str, texts: Texts, variables: Sequence[Variable], head: Mapping[str, str]) -> str:
    """The documentation of the class and of its parts, and tables of what can be set and read."""
    kinds = {
        "Inputs": "input",
        "Outputs": "output",
        "Parameters": "parameter",
        "Parameters that follow from others": "calculatedParameter",
    }
    return (
        templates(start=_start, limits=_limits)
        .get_template("index.html.jinja")
        .render(
            model=model,
            head=head,
            classes=[
                (found.name, found.title, found.documentation()) for found in texts.used(model)
            ],
            tables={
                title: [v for v in variables if v.causality == causality]
                for title, causality in kinds.items()
            },
        )
    )


def _start(variable: Variable) -> str:
    """Start values as a reader expects them."""
    if variable.start is None:
        return ""
    if variable.literals:
        return " ".join(variable.literals[int(value) - 1] for value in variable.start)
    if variable.type == "Boolean":
        return " ".join("true" if value else "false" for value in variable.start)
    return " ".join(f"{value:.15g}" for value in variable.start)


def _limits(variable: Variable) -> str:
    """The range of a variable, an open end left out."""
    low, high = variable.minimum, variable.maximum
    if variable.literals or (low is None and high is None):
        return ""
    return f"{'' if low is None else f'{low:.15g}'} .. {'' if high is None else f'{high:.15g}'}"


@cache
def _rows() -> tuple[dict[str, str], ...]:
    with TERMINALS_FILE.open(encoding="utf-8", newline="") as file:
        return tuple(csv.DictReader(file))


def _terminals(variables: Sequence[Variable]) -> str:
    """The terminals of a model: those of the table whose variables it all has."""
    names = {v.name for v in variables if v.causality in ("input", "output")}
    terminals = []
    for name in dict.fromkeys(row["terminal"] for row in _rows()):
        rows = [row for row in _rows() if row["terminal"] == name]
        for suffix in _SUFFIXES:
            members = [(row["member"], row["variable"] + suffix) for row in rows]
            if all(variable in names for _, variable in members):
                terminals.append(
                    {
                        "name": name + suffix,
                        "rule": rows[0]["rule"],
                        "description": rows[0]["description"],
                        "members": members,
                    }
                )
    template = templates().get_template("terminalsAndIcons.xml.jinja")
    return template.render(terminals=terminals)
