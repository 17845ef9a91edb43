"""Homing methods as a table: `homing_methods.csv`."""

import csv
from collections.abc import Mapping
from importlib import resources
from typing import Final, NamedTuple


class Method(NamedTuple):
    """A row of the table.

    switch: "negative", "positive", "home", "stop" or "none". search: direction in which the switch
    or stop is looked for (speed 6099:1). approach: direction in which its edge is passed, then the
    zero pulse (speed 6099:2); 0 = no way to go. level: of the switch after that edge.
    zero_pulse: home is the first one after the edge, else the edge. reverses: the search turns
    round once at a limit switch. home: where home is, in words.
    """

    method: int
    switch: str
    search: int
    approach: int
    level: bool
    zero_pulse: bool
    reverses: bool
    home: str


def _read() -> dict[int, Method]:
    text = resources.files(__package__).joinpath("homing_methods.csv").read_text(encoding="utf-8")
    return {
        int(row["method"]): Method(
            int(row["method"]),
            row["switch"],
            int(row["search"]),
            int(row["approach"]),
            row["level"] == "1",
            row["zero_pulse"] == "yes",
            row["reverses"] == "yes",
            row["home"],
        )
        for row in csv.DictReader(text.splitlines())
    }


METHODS: Final[Mapping[int, Method]] = _read()
"""By the value of 6098. Source: CiA 402-2, homing mode, methods 1 to 14, 17 to 30, 33 to 37; the
negative ones as maxon's EPOS drives number theirs (current threshold, with and without index)."""
