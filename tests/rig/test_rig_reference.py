"""docs/rigs.md against the tables it describes: every key with its default, every variable."""

import re
from pathlib import Path

import pytest
from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from axisrig.bench.rig.canopen.keys import DriveTable, SegmentTable
from axisrig.bench.rig.reading.file import (
    AxisTable,
    ChannelTable,
    CycleTable,
    LanguageTable,
    PlantTable,
    RealtimeTable,
)
from axisrig.bench.rig.reading.law import DistanceTable
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, TerminalTable
from axisrig.kernel.cosim.fmi.role_table import role_table

TEXT = (Path(__file__).parents[2] / "docs" / "rigs.md").read_text(encoding="utf-8")
MODELS: dict[str, type[BaseModel]] = {
    "[cycle]": CycleTable,
    "[realtime]": RealtimeTable,
    "[distance]": DistanceTable,
    "[channel]": ChannelTable,
    "[language]": LanguageTable,
    "[segment.S]": SegmentTable,
    "[drive.D]": DriveTable,
    "[axis.A]": AxisTable,
    "[plant.P]": PlantTable,
    "[plc] V": PlcSensorTable,
    "[plc]": PlcTaskTable,
    "[plc.terminal]": TerminalTable,
}


def _described(table: str) -> dict[str, str]:
    """Key -> default as the reference prints them."""
    rows = [[cell.strip(" `") for cell in line.split("|")] for line in TEXT.splitlines()]
    return {row[2]: row[4] for row in rows if len(row) == 7 and row[1] == table}


def _written(default: object) -> str:
    if default is PydanticUndefined:
        return "required"
    if default is None:
        return "none"
    if isinstance(default, str):
        return f'"{default}"'
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, int) and default > 99_999:
        return f"{default:_}"
    return str(default)


@pytest.mark.parametrize("table", MODELS)
def test_every_key_is_described_with_its_default(table: str) -> None:
    expected = {
        name: _written(
            info.default_factory() if info.default_factory else info.default  # type: ignore[call-arg]
        )
        for name, info in MODELS[table].model_fields.items()
    }
    assert _described(table) == expected


def test_every_role_of_an_own_fmu_is_described() -> None:
    described = set(re.findall(r"`(\w+)`", TEXT))
    assert {role.role.replace("<g>", "g") for role in role_table()} <= described
