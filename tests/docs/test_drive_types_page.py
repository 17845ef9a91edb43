"""The table of drive types in docs/drives-and-kernel.md is that of the code."""

from itertools import takewhile
from pathlib import Path

from axisrig.kernel.parameters.drive_types import DRIVE_TYPES

PAGE = Path(__file__).parents[2] / "docs" / "drives-and-kernel.md"
HEAD = (
    "| P-AXIS-00020 | runs here | latch | inputs | edges | distance control"
    " | run to a fixed stop | position loop | #DRIVE |"
)


def type_table() -> list[str]:
    rows = [
        f"| {kind.number} {kind.name} | {'yes' if kind.family else f'no: {kind.why}'}"
        f" | {kind.latch} | {kind.inputs}{'' if kind.may_change_input else ', not by #MEAS'}"
        f" | {' '.join(kind.edges)} | {'yes' if kind.distance_control else 'no'}"
        f" | {' '.join(kind.fixed_stop)} | {', '.join(kind.position_loop)} | {kind.access} |"
        for kind in DRIVE_TYPES.values()
    ]
    return [HEAD, "|---|---|---|---|---|---|---|---|---|", *rows]


def test_type_table_is_that_of_the_csv() -> None:
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    expected = type_table()
    assert HEAD in lines, "\n".join(expected)
    found = takewhile(lambda line: line.startswith("|"), lines[lines.index(HEAD) :])
    assert list(found) == expected, "\n".join(expected)


if __name__ == "__main__":
    print("\n".join(type_table()))
