"""What the printed manuals write and what they mean.

Underscores got lost, letters replace digits, lines are broken: `errata.csv` says for each place
what is meant. The kernel reads what is meant; this table helps a reader who copies a printed page.
"""

import re
from dataclasses import dataclass
from functools import cache

from axisrig.kernel.nc.text.words import rows


@dataclass(frozen=True)
class Erratum:
    """One row of `errata.csv`.

    printed: as it is in the manual. meant: what it should be. kind: program or parameter.
    treatment: refused (the error names what is meant) or accepted (read as what is meant, with a
    note), or elsewhere for what is no NC text. pattern: finds the damage in a block, empty where
    nothing can be found. place: manual and section. reason: how the damage shows.
    """

    printed: str
    meant: str
    kind: str
    treatment: str
    pattern: str
    place: str
    reason: str


@cache
def errata() -> tuple[Erratum, ...]:
    """Give the table in its order."""
    return tuple(Erratum(**row) for row in rows("errata.csv"))


@cache
def _patterns() -> tuple[tuple[re.Pattern[str], Erratum], ...]:
    return tuple(
        (re.compile(row.pattern), row) for row in errata() if row.pattern and row.kind == "program"
    )


def meant_in(block: str) -> str | None:
    """Return what is meant by a block that has a known damage; None for any other block."""
    for pattern, row in _patterns():
        if pattern.search(block) is not None:
            return f"the manual prints {row.printed!r} and means {row.meant!r}"
    return None
