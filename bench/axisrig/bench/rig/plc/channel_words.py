"""What the PLC side does to the channel: the columns `plc:<column>` of `channel_columns.csv`."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources

from axisrig.bench.rig.plc.override import OverrideCourse, read_override
from axisrig.bench.rig.plc.times import duration
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

HIGHEST_PCT = 200
ACT_ONCE = ("reset", "program_start")
"""Columns whose action comes once without `nth`: what it causes could cause it again."""


@dataclass(frozen=True)
class ChannelColumn:
    """One row of `channel_columns.csv`. keys: what an action may contain, as `at=M50`."""

    name: str
    cell: str
    keys: tuple[str, ...]
    meaning: str


@dataclass(frozen=True)
class Feedhold:
    """The path is held for a time; None until a moment that the rule names."""

    for_ns: TimeNs | None


@dataclass(frozen=True)
class Reset:
    """The channel is reset."""


@dataclass(frozen=True)
class ProgramStart:
    """A program is started. file: beside the program of the run, None is that program again."""

    file: str | None


ChannelAction = Feedhold | OverrideCourse | Reset | ProgramStart


@cache
def channel_columns() -> Mapping[str, ChannelColumn]:
    """Read `channel_columns.csv`, by name."""
    text = resources.files(__package__).joinpath("channel_columns.csv").read_text(encoding="utf-8")
    return {
        row["column"]: ChannelColumn(
            row["column"], row["cell"], tuple(row["keys"].split()), row["meaning"]
        )
        for row in csv.DictReader(text.splitlines())
    }


def read_channel_action(
    name: str, column: str, values: Sequence[str], keys: Mapping[str, str]
) -> ChannelAction:
    """Read one action of a column; values: the words without `=`, keys: those with.

    Raises UserError for what cannot be.
    """
    example = channel_columns()[name].cell
    if name == "override":
        if len(values) != 1:
            raise UserError(
                "one value and its keys", value=" ".join(values) or "nothing", allowed=example
            )
        return read_override(None, column, values[0], keys, HIGHEST_PCT)
    if values:
        raise UserError(f"a {name} has no value", value=values[0], allowed=example)
    if name == "feedhold":
        return Feedhold(duration(keys))
    if "at" not in keys:
        raise UserError(f"a {name} needs its moment", value="nothing", allowed=example)
    return Reset() if name == "reset" else ProgramStart(keys.get("file"))
