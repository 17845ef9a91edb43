"""Tables of SERCOS: idents, telegrams, profiles, real-time bits of P-AXIS-00060."""

from collections import defaultdict
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.sercos.idents import Idents, rows
from axisrig.bench.drive.sercos.profiles import (
    LINEAR,
    NAMES,
    ROTARY,
    make_profile,
    units_per_turn,
)
from axisrig.bench.drive.sercos.profiles import rows as habits
from axisrig.bench.drive.sercos.service_channel import STATES
from axisrig.kernel.drives.sercos.settings import real_time_bits
from axisrig.kernel.profiles.sercos.service import Attribute, Kind, ident_number
from axisrig.kernel.profiles.sercos.words import PROBES, telegram_idents

ONE, TWO = 0x40, 0x80  # real-time bits 1 and 2


def test_what_telegrams_carry_is_as_long_in_the_drive() -> None:
    """Both ends pack by their own table."""
    by_ident = {ident_number(row["ident"]): row for row in rows()}
    for ident, carried in telegram_idents().items():
        row = by_ident[ident]
        assert int(row["bytes"]) == carried.bytes, row
        assert (Kind[row["kind"].upper()] is Kind.SIGNED) is carried.is_signed, row


@pytest.mark.parametrize(
    ("word", "attribute"),
    [
        (0x0221_03E8, Attribute(Kind.SIGNED, 2, decimals=2, factor=1000)),
        (0x0F22_FFFF, Attribute(Kind.SIGNED, 4, decimals=15, factor=0xFFFF)),
        (0x0045_0001, Attribute(Kind.TEXT, 2, is_list=True)),
        (0x0068_0100, Attribute(Kind.FLOAT, 1, is_command=True, factor=256)),
        (0x1013_0001, Attribute(Kind.UNSIGNED, 8, protected=(True, False, False))),
        (0x2003_0001, Attribute(Kind.BINARY, 8, protected=(False, True, False))),
        (0x4033_0001, Attribute(Kind.HEXADECIMAL, 8, protected=(False, False, True))),
    ],
)  # fmt: skip
def test_each_part_of_an_attribute_has_its_bits(word: int, attribute: Attribute) -> None:
    """Factor 0 to 15, length 16 and 17, list 18, command 19, type 20 to 22, decimals 24 to 27."""
    assert attribute.pack() == word.to_bytes(4, "little")
    assert Attribute.read(word.to_bytes(4, "little")) == attribute


def test_each_ident_is_there_once_and_its_default_fits() -> None:
    names = [row["ident"] for row in rows()]
    assert names == sorted(set(names))
    for row in rows():
        assert row["access"] in ("ro", "rw", "ignored"), row
        assert row["drives"] in ("both", "two"), row
    assert all(set(NAMES) <= set(row) for row in habits().values())


def test_the_table_of_the_manual() -> None:
    """FCT-C4 6.1: probe and edge, S-0-0169, measured value."""
    printed = {
        (1, "POS"): (1, "S-0-0130"), (1, "NEG"): (2, "S-0-0131"),
        (2, "POS"): (4, "S-0-0132"), (2, "NEG"): (8, "S-0-0133"),
    }  # fmt: skip
    assert {key: (p.select, p.value) for key, p in PROBES.items()} == {
        key: (select, ident_number(name)) for key, (select, name) in printed.items()
    }


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize(("edge", "word"), [("POS", "positive"), ("NEG", "negative")])
def test_what_a_probe_is_switched_and_shown_by_has_its_name_in_the_drive(
    number: int, edge: str, word: str
) -> None:
    """Enable and level are of a probe, the done measurement is of a probe and an edge."""
    names = {ident_number(row["ident"]): row["name"] for row in rows()}
    probe = PROBES[number, edge]
    assert [names[ident] for ident in (probe.enable, probe.level, probe.latched)] == [
        f"Probe {number} enable", f"Probe {number}", f"Probe {number} {word} latched",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("number", "mask", "bits"),
    [
        (1, ONE, (ONE, ONE, TWO)),
        (1, TWO, (ONE, ONE, TWO)),  # P-AXIS-00106 counts for 0 alone
        (2, ONE, (TWO, TWO, ONE)),
        (2, TWO, (TWO, TWO, ONE)),
        (0, TWO, (ONE, ONE, TWO)),  # the probe is at bit 2
        (0, ONE, (ONE, TWO, ONE)),  # the probe is at bit 1
    ],
)
def test_real_time_bits_of_the_control(number: int, mask: int, bits: tuple[int, ...]) -> None:
    found = real_time_bits(number, mask)
    assert (found.enable, found.latched, found.actuated) == bits


@pytest.mark.parametrize(
    ("kind", "per_turn"),
    [
        (ROTARY, 1 << 20),
        (LINEAR, 100_000),  # 10 mm in 1e-7 m
        (0x01, 100_000),  # preferred: 1e-7 m
        (0x02, 3_600_000),  # preferred: 1e-4 degrees
        (0x00, None),
    ],
)
def test_position_units_of_a_turn(kind: int, per_turn: int | None) -> None:
    """S-0-0076 with a lead of 10 mm; 2^20 per turn, 0.1 um by S-0-0077 and 78."""
    assert units_per_turn(kind, 1, -7, 1 << 20, 10_000) == per_turn
    if kind == LINEAR:
        assert units_per_turn(kind, 1, -6, 1 << 20, 10_000) == 10_000


def test_a_drive_that_gets_power_again_runs_no_command_of_before() -> None:
    """State and value of each procedure command are those of power on; so is a written value."""
    made = make_profile("two_probes", DriveProfile(), "rotary", 1 << 20)
    live: Any = defaultdict(lambda: lambda: 0)
    idents = Idents(made, live, lambda _: 0, lambda *_: None, lambda _: None)
    known = {ident: found.value for ident, found in idents.table.items()}
    commands = [n for n, found in idents.table.items() if found.attribute.is_command]
    assert ident_number("S-0-0170") in commands
    for state in ("RUNNING", "DONE", "FAILED", "INTERRUPTED"):
        for number in commands:
            idents.table[number].state = STATES[state]
            idents.put(number, 3)
        idents.reset()
        assert {n: found.value for n, found in idents.table.items()} == known
        assert {idents.table[number].state for number in commands} == {STATES["IDLE"]}


@pytest.mark.parametrize(
    ("kind", "per_turn"),
    [
        (ROTARY, 1 << 16),  # S-0-0079
        (LINEAR, 2_500),  # 5 mm in 2 um, S-0-0077 and 78
        (0x01, 50_000),  # preferred, whatever 77 and 78 are: 5 mm in 1e-7 m
        (0x02, 3_600_000),  # preferred, whatever 79 is: 1e-4 degrees
    ],
)
def test_preferred_units_do_not_depend_on_the_parameters_beside(kind: int, per_turn: int) -> None:
    assert units_per_turn(kind, 2, -6, 1 << 16, 5_000) == per_turn
