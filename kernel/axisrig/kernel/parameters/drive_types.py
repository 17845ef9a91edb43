"""Drive types of P-AXIS-00020 (`drive_types.csv`): what each has, and what simulates it."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Final


@dataclass(frozen=True)
class DriveType:
    """A row of the table.

    family: the folder of `kernel/drives` and `bench/drive` that speaks it, empty where none does.
    distance_control: P-AXIS-00328 may be on. edge_banding: it has that input (P-AXIS-00539).
    inputs: probing inputs at most (P-AXIS-00517).
    """

    number: int
    name: str
    family: str
    distance_control: bool
    edge_banding: bool
    inputs: int


def _read() -> Mapping[int, DriveType]:
    text = resources.files(__package__).joinpath("drive_types.csv").read_text(encoding="utf-8")
    found = [
        DriveType(
            int(row["number"]),
            row["name"],
            row["family"],
            row["distance_control"] == "yes",
            row["edge_banding"] == "yes",
            int(row["inputs"]),
        )
        for row in csv.DictReader(text.splitlines())
    ]
    return {row.number: row for row in found}


DRIVE_TYPES: Final = _read()
SIMULATED: Final = tuple(row.number for row in DRIVE_TYPES.values() if row.family)
