"""The page on the drive's communication says what tables and code say."""

import re
from itertools import groupby, takewhile
from pathlib import Path

from axisrig.bench.drive.canopen import exchange, slave, sync
from axisrig.bench.drive.canopen.lss import BIT_RATES
from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode
from axisrig.bench.drive.cia402.dictionary.objects import ObjectRow, object_rows
from axisrig.bench.drive.cia402.error_register import NO_ERROR

PAGE = Path(__file__).parents[2] / "docs" / "drive-communication.md"
HEAD = "| object | name | type | access | values | default | meaning | acts |"


def object_table() -> list[str]:
    """The objects 1000 to 1FFF; those that differ in their number and default are one row.

    Left out: sub-indices 0 that only say how many there are.
    """
    rows = [row for row in object_rows() if row.index < 0x2000]
    rows = [row for row in rows if not (row.sub == 0 and row.access == "const")]
    rows.sort(key=lambda row: (_family(row), -1 if row.sub is None else row.sub, row.index))
    lines = [HEAD, "|" + "---|" * HEAD.count(" | ") + "---|"]
    for _, group in groupby(rows, key=lambda row: (_family(row), _numberless(row))):
        members = list(group)
        first, last = members[0], members[-1]
        index = f"{first.index:04X}"
        if last.index != first.index:
            index += f"..{last.index:04X}"
        sub = "" if first.sub is None else f":{first.sub}"
        if last.sub != first.sub:
            sub += f"..{last.sub}"
        cells = (
            index + sub,
            first.name if last is first else re.sub(r" \d+\b", "", first.name),
            first.type,
            "" if first.is_head else first.access,
            _values(first),
            _defaults(members),
            first.meaning + (f" ({first.unit})" if first.unit else ""),
            first.effect,
        )
        lines.append(re.sub(r"(?<=\|) +(?=\|)", " ", f"| {' | '.join(cells)} |"))
    return lines


def _family(row: ObjectRow) -> int:
    """The four PDOs of a direction have the same objects."""
    return row.index & ~3 if 0x1400 <= row.index < 0x1C00 else row.index


def _numberless(row: ObjectRow) -> tuple[object, ...]:
    name = re.sub(r" \d+\b", "", row.name)
    is_of_pdo = 0x1400 <= row.index < 0x1600 or 0x1800 <= row.index < 0x1A00
    sub = row.sub if row.sub in (None, 0) or is_of_pdo else 1
    return (name, row.type, row.access, row.allowed, row.meaning, sub)


def _values(row: ObjectRow) -> str:
    if row.allowed.ranges is not None:
        ends = [(r.start, r.stop - 1) for r in row.allowed.ranges]
        return ", ".join(f"{a}" if a == b else f"{a} to {b}" for a, b in ends)
    if row.low is not None or row.high is not None:
        return f"{row.low or 0} to {row.high}"
    return ""


def _defaults(members: list[ObjectRow]) -> str:
    found = [row.default for row in members]
    if len(set(found)) == 1:
        return found[0]
    return ", ".join(found) if len(found) <= 4 else "see above"


def test_object_table_is_that_of_the_csv() -> None:
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    shown = takewhile(lambda line: line.startswith("|"), lines[lines.index(HEAD) :])
    expected = object_table()
    assert list(shown) == expected, "\n".join(expected)


def test_default_pdos() -> None:
    """Identifier for node 0, transmission type and mapped objects of every PDO that has any."""
    page = PAGE.read_text(encoding="utf-8")
    rows = {row.key: row.default for row in object_rows() if not row.is_head}
    for first, name in ((0x1400, "RPDO"), (0x1800, "TPDO")):
        for number in range(4):
            cob_id = int(rows[first + number, 1].removeprefix("$NODEID+"), 0)
            entries = [int(rows[first + 0x200 + number, sub], 0) for sub in range(1, 9)]
            mapped = ", ".join(f"{entry >> 16:04X}" for entry in entries if entry)
            use = "no" if cob_id >> 31 else "yes"
            kind = rows[first + number, 2]
            line = f"| {name}{number + 1} | {cob_id & 0x7FF:X} | {use} | {kind} | {mapped} |"
            assert line.replace("|  |", "| |") in page, line


def test_every_abort_code_is_explained() -> None:
    page = PAGE.read_text(encoding="utf-8")
    shown = {
        int(a + b, 16) for a, b in re.findall(r"^\| ([0-9A-F]{4}) ([0-9A-F]{4}) \|", page, re.M)
    }
    assert shown == {int(code) for code in AbortCode}


def test_every_emergency_code_of_the_communication_is_explained() -> None:
    page = PAGE.read_text(encoding="utf-8")
    section = page.split("## Emergencies")[1].split("\n## ")[0]
    shown = {int(code, 16) for code in re.findall(r"^\| ([0-9A-F]{4}) \|", section, re.M)}
    codes = {
        value
        for module in (exchange, slave, sync)
        for value in vars(module).values()
        if isinstance(value, int) and 0x8100 <= value <= 0x8FFF
    }
    assert shown == codes | {NO_ERROR}


def test_states_and_bit_rates() -> None:
    page = PAGE.read_text(encoding="utf-8")
    for state in NmtState:
        assert f"| {state.name.lower().replace('_', '-')} | {state.value} |" in page
    rates = ", ".join(str(rate // 1000) for rate in BIT_RATES.values())
    assert rates in " ".join(page.split())


if __name__ == "__main__":
    print("\n".join(object_table()))
