"""The filters by name, as `filters.csv` lists them."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True)
class FilterKind:
    """One row of `filters.csv`.

    ident: the word of P-AXIS-00782. model: which code builds it (`build`). parameters: the names
    that act on it. formula: in words. delay: after a ramp, in cycles. source: manual, section.
    """

    ident: str
    model: str
    parameters: tuple[str, ...]
    formula: str
    delay: str
    source: str


@cache
def filter_kinds() -> Mapping[str, FilterKind]:
    """Read `filters.csv`, keyed by ident."""
    text = resources.files(__package__).joinpath("filters.csv").read_text(encoding="utf-8")
    return {
        row["ident"]: FilterKind(
            row["ident"],
            row["model"],
            tuple(row["parameters"].split()),
            row["formula"],
            row["delay"],
            row["source"],
        )
        for row in csv.DictReader(text.splitlines())
    }
