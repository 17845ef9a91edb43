"""Words of a PROFIdrive drive as both ends take them: telegrams, control and status words.

Telegrams are big-endian. Sources: SINAMICS S function charts 2420 for the telegrams, SIMODRIVE 611
universal (encoder interface, DSC), SINAMICS S120 4-113 (flying measurement), MASTERDRIVES MC 8.2
(error codes); docs/profidrive.md has what is inferred.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from struct import Struct
from typing import Final

# STW1
ON: Final = 1 << 0
NO_OFF2: Final = 1 << 1
NO_OFF3: Final = 1 << 2
ENABLE: Final = 1 << 3
SET_VALUE: Final = 1 << 6
SETPOINT: Final = 1 << 4 | 1 << 5 | SET_VALUE
"""Ramp generator enabled, not frozen, set value enabled: one of them 0 stops the axis."""
ACKNOWLEDGE: Final = 1 << 7
BY_CONTROL: Final = 1 << 10
"""Without it the drive takes nothing of the telegram but the sign of life."""
# ZSW1
OPERATES: Final = 1 << 2
READY: Final = 1 << 0 | 1 << 1
FAULT: Final = 1 << 3
ALARM: Final = 1 << 7
INHIBITED: Final = 1 << 6
CONTROL_REQUESTED: Final = 1 << 9
# STW2, ZSW2
LIFE_SHIFT: Final = 12
LIFE_VALUES: Final = 15
"""Signs of life run from 1 to 15; 0: there is none yet."""
LIFE_WRONG, LIFE_RIGHT = 10, 1
"""What a wrong sign of life counts up and a right one counts down."""
# Gn_STW
FUNCTIONS: Final = 0x000F
COMMAND_SHIFT: Final = 4
COMMAND_MASK: Final = 7
NOTHING, ACTIVATE, READ, ABORT = range(4)
FLYING: Final = 1 << 7
"""Mode of the functions: flying measurement; 0 = search of reference marks."""
ABSOLUTE: Final = 1 << 13
PARK: Final = 1 << 14
ENCODER_ACKNOWLEDGE: Final = 1 << 15
# Gn_ZSW
ACTIVE: Final = 0x000F
VALUE_SHIFT: Final = 4
VALUES: Final = FUNCTIONS << VALUE_SHIFT
DEFLECTED: Final = (1 << 8, 1 << 9)
ACKNOWLEDGING: Final = 1 << 11
ENCODER_ERROR: Final = 1 << 15

FUNCTION_OF: Final[Mapping[tuple[int, str], int]] = {
    (1, "POS"): 1 << 0,
    (1, "NEG"): 1 << 1,
    (2, "POS"): 1 << 2,
    (2, "NEG"): 1 << 3,
}
"""Function bit of flying measurement by probing input and edge."""
SPEED_BASE: Final = 1 << 30
"""NSOLL_B of the speed P0880 (P2000 of SINAMICS)."""
KPC_PER_S: Final = 1000
"""KPC counts 0.001 1/s."""
KPC_MAX: Final = 4000 * KPC_PER_S
PROBE_AT_INPUT: Final = 80
"""P0660: the fast input I0.x is that of a probe (FCT-C4 6.5)."""
INCREMENTS: Final = 1 << 32
"""Positions wrap with so many increments."""


def next_life(value: int) -> int:
    """Return the sign of life that follows on one."""
    return value % LIFE_VALUES + 1


def signed(value: int) -> int:
    """Return a difference of two positions with the wrap taken out."""
    return (value + INCREMENTS // 2) % INCREMENTS - INCREMENTS // 2


@dataclass(frozen=True)
class Telegram:
    """A telegram. to_drive, from_drive: names of its words in their order."""

    number: int
    to_drive: tuple[str, ...]
    from_drive: tuple[str, ...]

    @property
    def has_dsc(self) -> bool:
        """Whether the drive can close the position loop: it gets deviation and gain."""
        return {"XERR", "KPC"} <= set(self.to_drive)

    @property
    def has_second(self) -> bool:
        """Whether it carries a second encoder."""
        return "G2_XIST1" in self.from_drive


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def telegrams() -> Mapping[int, Telegram]:
    """Return the telegrams by their numbers."""
    return {
        int(row["number"]): Telegram(
            int(row["number"]), tuple(row["to_drive"].split()), tuple(row["from_drive"].split())
        )
        for row in _rows("telegrams.csv")
    }


@cache
def _formats() -> Mapping[str, str]:
    known = {("16", "no"): "H", ("32", "yes"): "i"}
    return {row["name"]: known[row["bits"], row["signed"]] for row in _rows("signals.csv")}


def codec_of(names: tuple[str, ...]) -> Struct:
    """Return the codec of the words of a telegram."""
    return Struct(">" + "".join(_formats()[name] for name in names))


@cache
def encoder_errors() -> Mapping[str, int]:
    """Return the error codes of Gn_XIST2 by their names."""
    return {row["name"]: int(row["code"]) for row in _rows("encoder_errors.csv")}


def encoder_error_text(code: int) -> str:
    """Return the words of an error code."""
    known = {int(row["code"]): row["meaning"] for row in _rows("encoder_errors.csv")}
    return known.get(code, "a code of the manufacturer")
