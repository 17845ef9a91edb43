"""The page on the drive lists every object of CiA 402 as the table says it."""

import re
from itertools import groupby, takewhile
from pathlib import Path

from axisrig.bench.drive.cia402.dictionary.objects import ObjectRow, object_rows
from axisrig.bench.drive.cia402.dictionary.profiles import make_profile

PAGE = Path(__file__).parents[2] / "docs" / "drive.md"
HEAD = "| object | name | type | access | PDO | default | range | unit | meaning | acts |"


def object_table() -> list[str]:
    """The objects from 6000 on; sub-indices that differ in number and default only are one row.

    Left out: heads of objects, and sub-indices 0 that only say how many there are.
    """
    rows = [row for row in object_rows() if row.index >= 0x6000 and not row.is_head]
    rows = [row for row in rows if not (row.sub == 0 and row.access == "const")]
    lines = [HEAD, "|" + "---|" * (HEAD.count("|") - 1)]
    for _, group in groupby(rows, key=_numberless):
        first, *more = group
        last = more[-1] if more else first
        place = f"{first.index:04X}" + ("" if first.sub is None else f":{first.sub}")
        cells = (
            place + (f"..{last.sub}" if more else ""),
            re.sub(r" \d+$", "", first.name) if more else first.name,
            first.type,
            first.access,
            {"rx": "R", "tx": "T", "": ""}[first.pdo],
            _default(first) if not more else "see homing.md",
            _range(first),
            first.unit,
            first.meaning,
            first.effect,
        )
        line = " | ".join(cell.replace("|", "\\|") for cell in cells)
        lines.append(re.sub(r"(?<=\|) +(?=\|)", " ", f"| {line} |"))
    return lines


def _numberless(row: ObjectRow) -> tuple[object, ...]:
    name = re.sub(r" \d+$", "", row.name) if row.index == 0x60E3 else (row.name, row.sub)
    return (row.index, name)


def _default(row: ObjectRow) -> str:
    """With its value for the profile `generic` where it follows from the profile."""
    if not row.default.startswith("{"):
        return row.default
    value = make_profile({}).object_defaults[row.default.strip("{}")]
    return f"{value} (generic)"


def _range(row: ObjectRow) -> str:
    if row.allowed.ranges is not None:
        ends = sorted((r.start, r.stop - 1) for r in row.allowed.ranges)
        joined: list[list[int]] = []
        for low, high in ends:
            if joined and joined[-1][1] == low - 1:
                joined[-1][1] = high
            else:
                joined.append([low, high])
        return ", ".join(f"{a}" if a == b else f"{a} to {b}" for a, b in joined)
    if row.allowed.mask is not None:
        return f"bits of 0x{row.allowed.mask:X}"
    if row.low is not None and row.high is not None:
        return f"{row.low} to {row.high}"
    if row.low is not None:
        return f"from {row.low}"
    return "" if row.high is None else f"up to {row.high}"


def test_object_table_is_that_of_the_csv() -> None:
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    assert HEAD in lines, "\n".join(object_table())
    message = takewhile(lambda line: line.startswith("|"), lines[lines.index(HEAD) :])
    expected = object_table()
    assert list(message) == expected, "\n".join(expected)


if __name__ == "__main__":
    print("\n".join(object_table()))
