"""Findings about an FMU: what was looked at, what came out, what to do about it."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import Enum

from rich.console import Console
from rich.table import Table as RichTable

from axisrig.kernel.errors import printable


class Level(Enum):
    """How bad a finding is; the value is the word in tables and JSON."""

    OK = "ok"
    WARN = "warn"
    FAIL = "FAIL"


@dataclass(frozen=True)
class Finding:
    """One row of `axisrig fmu check`.

    area: what was looked at. level: the word of a Level. text: what was found. remedy: what to do,
    empty where nothing is to be done.
    """

    area: str
    level: str
    text: str
    remedy: str = ""


def ok(area: str, text: str) -> Finding:
    """Make a finding that is as it should be."""
    return Finding(area, Level.OK.value, printable(text))


def warn(area: str, text: str, remedy: str = "") -> Finding:
    """Make a finding with which the bench can live."""
    return Finding(area, Level.WARN.value, printable(text), remedy)


def fail(area: str, text: str, remedy: str = "") -> Finding:
    """Make a finding with which the FMU cannot be trusted or used."""
    return Finding(area, Level.FAIL.value, printable(text), remedy)


def has_failed(findings: Sequence[Finding]) -> bool:
    """Return whether one of the findings is a FAIL."""
    return any(finding.level == Level.FAIL.value for finding in findings)


def as_rows(findings: Sequence[Finding]) -> list[dict[str, str]]:
    """Return the findings as plain data for JSON."""
    return [asdict(finding) for finding in findings]


def show_findings(findings: Sequence[Finding], title: str) -> None:
    """Print the findings as a table on standard output."""
    table = RichTable(title=title, title_justify="left", show_lines=False)
    for column in ("area", "", "found", "what to do"):
        table.add_column(column, overflow="fold", no_wrap=column in ("area", ""))
    for finding in findings:
        table.add_row(finding.area, finding.level, finding.text, finding.remedy)
    Console(highlight=False, markup=False, emoji=False).print(table)
