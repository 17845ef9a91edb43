"""The tables and the example of docs/coordinates.md are those of the kernel."""

from pathlib import Path
from typing import cast

import pytest

from axisrig.kernel.nc.canon import Message
from axisrig.kernel.nc.coordinates.lists import TOOLS, ZERO_OFFSETS, forms
from axisrig.kernel.nc.coordinates.places import PLANES
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.nc.decoder import Interpreter, MachineView
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.parameters import Origin

PAGE = Path("docs/coordinates.md").read_text(encoding="utf-8")


def _rows(first: str) -> list[list[str]]:
    """The rows of the page whose first cell begins so."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.splitlines()
        if line.startswith("|")
    ]
    return [row for row in rows if row[0].startswith(first)]


def test_every_name_of_the_lists_stands_in_the_page() -> None:
    acts = {"yes": "yes", "ignored": "no, ignored"}
    expected = [
        [
            form.number,
            f"`{form.path}`",
            form.unit,
            acts.get(form.acts, f"only {form.acts}"),
            form.meaning,
        ]
        for name in (ZERO_OFFSETS, TOOLS)
        for form in forms(name).values()
    ]
    assert _rows("P-") == expected


def test_the_planes_of_the_page() -> None:
    expected = [
        [
            plane.g,
            "XYZ"[plane.first],
            "XYZ"[plane.second],
            "XYZ"[plane.third],
            f"{'IJK'[plane.first]}, {'IJK'[plane.second]}",
        ]
        for plane in PLANES.values()
    ]
    assert _rows("G1") == expected


class _Still:
    """Axes that stand at 0 when the program begins."""

    def position_acs_mm(self, axis: str) -> float:
        return 0.0

    def channel_distance(self) -> None:
        return None


def _numbers(cell: str) -> list[float]:
    return [float(number) for number in cell.split(",")]


def test_the_example_of_the_page_comes_out_as_printed() -> None:
    lists = Lists()
    for line in PAGE.splitlines():
        for name, first in ((ZERO_OFFSETS, "    np_grp"), (TOOLS, "    wz[")):
            if line.startswith(first):
                path, value, *_ = line.split()
                lists.set(name, path, value, Origin("docs/coordinates.md"))
    rows = [row for row in _rows("`") if len(row) == 4 and row[1][0].isdigit()]
    assert len(rows) == 7
    asked = [f"V.A.{name}.{axis}" for name in ("PROG", "ABS", "ACS.ABS") for axis in "XYZ"]
    show = f'#MSG ["{"%f " * len(asked)}", {", ".join(asked)}]'
    text = "\n".join(f"{row[0].strip('`')}\n{show}" for row in rows)
    interpreter = Interpreter(
        parse_program(text, file="page.nc", axes=("X", "Y", "Z")),
        ("X", "Y", "Z"),
        cast("MachineView", _Still()),
        external={},
        tables=lists.tables(rotary=(), ball_radius_counts=True),
    )
    messages = [c for c in interpreter.commands() if isinstance(c, Message)]
    for row, message in zip(rows, messages, strict=True):
        expected = [number for cell in row[1:] for number in _numbers(cell)]
        assert list(message.values) == pytest.approx(expected, abs=1e-9), row[0]
