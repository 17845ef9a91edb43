"""The words of the field with their meanings: one table for report, documents and README."""

import csv
from importlib import resources
from pathlib import Path

from axisrig.kernel.errors import UserError

NAME = "glossary.csv"
# A wheel holds the documents inside this package; a checkout has them beside it.
PACKAGED = "documents"
CHECKOUT = Path(__file__).parents[3] / "docs" / NAME


def glossary() -> list[dict[str, str]]:
    """Return the rows of the table, in its order, with the keys of its first line.

    Keys: term, meaning, unit, object (CANopen indices and parameter numbers, blank between),
    german. Raises UserError when the installation has no such table.
    """
    packaged = resources.files(__package__).joinpath(PACKAGED, NAME)
    source = packaged if packaged.is_file() else CHECKOUT
    if not source.is_file():
        raise UserError(
            f"the table {NAME} is missing in the package {__package__}",
            hint="install axisrig again",
        )
    return list(csv.DictReader(source.read_text(encoding="utf-8").splitlines()))
