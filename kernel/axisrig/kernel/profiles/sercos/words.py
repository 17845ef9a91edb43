"""Words of a SERCOS drive as both ends take them: control and status word, telegrams, probes.

Sources: AX5000 ident descriptions (S-0-0134, S-0-0135, S-0-0169, S-0-0170, S-0-0301 to S-0-0307,
S-0-0405), FCT-C4 section 6.1; which ident of a telegram means what is `telegram_idents.csv`.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Final, Literal

from axisrig.kernel.profiles.sercos.service import ident_number

# S-0-0134
ON: Final = 1 << 15
ENABLE: Final = 1 << 14
RUN: Final = 1 << 13
"""0 halts the drive: it stops with torque and follows nothing."""
TOGGLE: Final = 1 << 10
"""Another one with each set of command values."""
REAL_TIME: Final = (1 << 6, 1 << 7)
"""Real-time bits 1 and 2, in S-0-0134 and in S-0-0135."""
# S-0-0135
READY_SHIFT: Final = 14
READY_MASK: Final = 3
NOT_READY, LOGIC_READY, POWER_READY, OPERATES = range(4)
C1D: Final = 1 << 13
C2D_CHANGED: Final = 1 << 12
C3D_CHANGED: Final = 1 << 11
COMMAND_CHANGED: Final = 1 << 5
FOLLOWS: Final = 1 << 3

CONTROL_WORD: Final = ident_number("S-0-0134")
STATUS_WORD: Final = ident_number("S-0-0135")
WORD_BITS: Final = 16
TELEGRAM_TYPE: Final = ident_number("S-0-0015")
LISTED: Final = 7
"""Telegram type: what S-0-0016 and S-0-0024 list."""
AT_LIST: Final = ident_number("S-0-0016")
MDT_LIST: Final = ident_number("S-0-0024")
CONTROL_BITS: Final = (ident_number("S-0-0301"), ident_number("S-0-0303"))
STATUS_BITS: Final = (ident_number("S-0-0305"), ident_number("S-0-0307"))
REAL_TIME_BITS: Final = CONTROL_BITS + STATUS_BITS
"""What each real-time bit is: an ident in the value of each of these."""
"""What real-time bits 1 and 2 are assigned to."""
PROBE_CONTROL: Final = ident_number("S-0-0169")
PROBE_COMMAND: Final = ident_number("S-0-0170")
EDGES: Final = ("POS", "NEG")


@dataclass(frozen=True)
class ProbeIdents:
    """What belongs to one edge of one probe. select: its bit of S-0-0169."""

    select: int
    value: int
    latched: int
    enable: int
    level: int


def _probe(number: int, edge: str) -> ProbeIdents:
    place = 2 * (number - 1) + EDGES.index(edge)
    return ProbeIdents(
        1 << place,
        ident_number(f"S-0-{130 + place:04}"),
        ident_number(f"S-0-{409 + place:04}"),
        ident_number(f"S-0-{404 + number:04}"),
        ident_number(f"S-0-{400 + number:04}"),
    )


PROBES: Final[Mapping[tuple[int, str], ProbeIdents]] = {
    (number, edge): _probe(number, edge) for number in (1, 2) for edge in EDGES
}
"""By probe and edge."""


@dataclass(frozen=True)
class TelegramIdent:
    """An ident that a telegram may carry. field: what the control takes it for, "" = nothing."""

    ident: int
    telegram: Literal["at", "mdt"]
    bytes: int
    is_signed: bool
    field: str


@cache
def telegram_idents() -> Mapping[int, TelegramIdent]:
    """Return what telegrams may carry, by ident."""
    text = resources.files(__package__).joinpath("telegram_idents.csv").read_text(encoding="utf-8")
    rows = [
        TelegramIdent(
            ident_number(row["ident"]),
            "at" if row["telegram"] == "at" else "mdt",
            int(row["bytes"]),
            row["signed"] == "yes",
            row["field"],
        )
        for row in csv.DictReader(text.splitlines())
    ]
    return {row.ident: row for row in rows}
