"""What was tested: the device, its serial number, its software, the order, who tested it.

It comes from the table `[info]` of a rig and from `--info` of the command line, which wins. It acts
on nothing and is written to the results: a column `info:<key>` of `cases.csv`.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace

from axisrig.bench.plan.case import Case
from axisrig.kernel.errors import UserError

INFO = "info:"
"""Begin of the names of its columns."""
INFO_KEY = r"^[a-z][a-z0-9_]{0,39}$"


def parse_info(texts: Iterable[str]) -> dict[str, str]:
    """Read `key=value` of the command line. Raises UserError for any other text."""
    found = {}
    for text in texts:
        key, sign, value = text.partition("=")
        if not sign or not re.match(INFO_KEY, key) or not value.strip():
            raise UserError(
                "--info is key=value; a key has small letters, digits and _",
                value=text,
                hint="--info device=axis-z --info serial=0042",
            )
        found[key] = value.strip()
    return found


def with_info(case: Case, found: Mapping[str, object]) -> Case:
    """Return a case that has these entries among its notes."""
    if not found:
        return case
    return replace(case, notes={**case.notes, **{f"{INFO}{k}": str(v) for k, v in found.items()}})


def info_of(case: Mapping[str, str]) -> dict[str, str]:
    """Return the entries of a row of `cases.csv`, by their keys."""
    return {
        column.removeprefix(INFO): value
        for column, value in case.items()
        if column.startswith(INFO) and value
    }
