"""Abort codes of SDO in words (`sdo_aborts.csv`). Source: CiA 301, SDO abort transfer protocol."""

import csv
from functools import cache
from importlib import resources


@cache
def _table() -> dict[int, str]:
    text = resources.files(__package__).joinpath("sdo_aborts.csv").read_text(encoding="utf-8")
    return {int(row["code"], 16): row["meaning"] for row in csv.DictReader(text.splitlines())}


def abort_text(code: int) -> str:
    """Say an abort code with its meaning."""
    return f"abort 0x{code:08X}, {_table().get(code, 'a code of the manufacturer')}"
