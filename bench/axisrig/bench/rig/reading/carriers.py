"""What commands do on each carrier: `carriers.csv`. Rows are of carriers other than CAN."""

import csv
from functools import cache
from importlib import resources
from pathlib import Path
from typing import NamedTuple

from axisrig.kernel.errors import UserError


class OnCarrier(NamedTuple):
    """A row: a command on a carrier. acts: `yes`, or `no` = refused with the words and the hint.

    words: what differs from CAN, or of a refusal what it says; `{segment}` is the name of one.
    """

    command: str
    carrier: str
    acts: str
    words: str
    hint: str


@cache
def on_carriers() -> tuple[OnCarrier, ...]:
    """Return all rows in the order of the table."""
    text = resources.files(__package__).joinpath("carriers.csv").read_text(encoding="utf-8")
    return tuple(OnCarrier(**row) for row in csv.DictReader(text.splitlines()))


def refusal(command: str, segment: str = "", *, file: Path | None = None) -> UserError:
    """Return the error of a command that does nothing on the carrier of a segment."""
    row = next(row for row in on_carriers() if row.command == command and row.acts == "no")
    return UserError(row.words.format(segment=segment), file=file, hint=row.hint or None)
