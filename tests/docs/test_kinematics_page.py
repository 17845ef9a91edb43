"""docs/kinematics.md: its tables are those of the code, and each example is computed."""

import re
from pathlib import Path

import pytest

from axisrig.kernel.kinematics import KinematicData, build, kinematic_types, offsets
from axisrig.kernel.parameters import Origin, ParameterSet

PAGE = (Path(__file__).parents[2] / "docs" / "kinematics.md").read_text(encoding="utf-8")
EXAMPLES = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.partition("| tool coordinates |\n|---|---|---|---|---|\n")[2].splitlines()
    if line.startswith("|")
]
LISTS = re.findall(r"(?:^    trafo.*\n)+", PAGE, re.MULTILINE)


def test_every_kinematic_has_its_row() -> None:
    for row in kinematic_types().values():
        acts = "yes" if row.acts else f"no: {row.reason}"
        axes = " ".join(row.axes) or "-"
        assert f"| {row.id} | {row.name} | {axes} | {acts} | {row.source} |\n" in PAGE


def test_every_offset_has_its_row() -> None:
    for row in offsets():
        place = f"HD{row.hd} | `param[{row.hd - 1}]`"
        assert f"| {row.id} | {place} | {row.unit} | {row.meaning} |\n" in PAGE


def _data(kinematic_id: int) -> KinematicData:
    channel = ParameterSet("channel")
    for text in LISTS:
        if text.startswith(f"    trafo[0].id {kinematic_id}\n"):
            for line in text.splitlines():
                channel.load(*line.split(), Origin("kinematics.md"))
    return KinematicData.read(channel)


@pytest.mark.parametrize("row", EXAMPLES, ids=lambda row: f"{row[0]} at {row[3]}")
def test_each_example_is_right(row: list[str]) -> None:
    ids = [int(number) for number in row[0].split(",")]
    written: dict[tuple[int, ...], float] = {}
    for number, value in re.findall(r"HD(\d+) (-?[\d.]+)", row[1]):
        written[len(ids) - 1, ids[-1], int(number) - 1] = 1e4 * float(value)
    kinematic = build(ids, _data(ids[0]), written, float(row[2]))
    axes, tool = (tuple(map(float, row[column].split())) for column in (3, 4))
    assert kinematic.forward(axes) == pytest.approx(tool, abs=5e-5)
    assert kinematic.inverse(kinematic.forward(axes), axes) == pytest.approx(axes, abs=1e-9)


def test_there_is_an_example_of_each_kinematic_that_acts() -> None:
    shown = {int(number) for row in EXAMPLES for number in row[0].split(",")}
    assert shown == {row.id for row in kinematic_types().values() if row.acts}
    assert len(LISTS) == 2
