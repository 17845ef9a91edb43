"""The tables of EtherCAT, read: registers, commands, states, AL status codes, SII categories.

Sources: public register descriptions of slave controllers and the code of two masters
(docs/ethercat.md names them).
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from importlib import resources
from typing import Final


class Command(IntEnum):
    """What a datagram asks for (`commands.csv`)."""

    NOP = 0
    APRD = 1
    APWR = 2
    APRW = 3
    FPRD = 4
    FPWR = 5
    FPRW = 6
    BRD = 7
    BWR = 8
    BRW = 9
    LRD = 10
    LWR = 11
    LRW = 12
    ARMW = 13
    FRMW = 14


class AlState(IntEnum):
    """States of a slave (`al_states.csv`)."""

    INIT = 1
    PREOP = 2
    BOOT = 3
    SAFEOP = 4
    OP = 8


AL_ERROR: Final = 0x10
"""Bit of the AL status: error; of the AL control: acknowledge it."""


@dataclass(frozen=True)
class Register:
    """A row of `registers.csv`. master: what a master may do, r or rw."""

    address: int
    size: int
    name: str
    master: str
    meaning: str


@dataclass(frozen=True)
class CommandRow:
    """A row of `commands.csv`. addressing: none, position, station, broadcast or logical."""

    code: int
    name: str
    addressing: str
    reads: bool
    writes: bool
    meaning: str


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def commands() -> Mapping[int, CommandRow]:
    """Return the commands by their codes."""
    return {
        int(row["code"]): CommandRow(
            int(row["code"]),
            row["name"],
            row["addressing"],
            bool(row["reads"]),
            bool(row["writes"]),
            row["meaning"],
        )
        for row in _rows("commands.csv")
    }


@cache
def al_states() -> Mapping[int, str]:
    """Return the names of the states by their codes."""
    return {int(row["code"]): row["name"] for row in _rows("al_states.csv")}


@cache
def registers() -> Mapping[str, Register]:
    """Return the registers by their names."""
    rows = _rows("registers.csv")
    return {
        row["name"]: Register(
            int(row["address"], 16), int(row["bytes"]), row["name"], row["master"], row["meaning"]
        )
        for row in rows
    }


def address_of(name: str) -> int:
    """Return the address of a register."""
    return registers()[name].address


@cache
def al_status_codes() -> Mapping[str, int]:
    """Return the AL status codes by their names."""
    return {row["name"]: int(row["code"], 16) for row in _rows("al_status_codes.csv")}


@cache
def _meanings() -> Mapping[int, str]:
    return {int(row["code"], 16): row["meaning"] for row in _rows("al_status_codes.csv")}


def al_status_text(code: int) -> str:
    """Say an AL status code with its meaning."""
    return f"0x{code:04X}, {_meanings().get(code, 'a code of the manufacturer')}"


@cache
def sii_categories() -> Mapping[str, int]:
    """Return the types of SII categories by their names."""
    return {row["name"]: int(row["type"]) for row in _rows("sii_categories.csv")}


STATE_MASK: Final = 0x0F


def state_name(status: int) -> str:
    """Say an AL status in words: its state, and whether its error bit is set."""
    try:
        name = AlState(status & STATE_MASK).name
    except ValueError:
        name = f"0x{status & STATE_MASK:X}"
    return f"{name} with error" if status & AL_ERROR else name
