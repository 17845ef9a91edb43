"""P-AXIS-00276: optimised access to the bus acts only where every axis has it."""

from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.parameters.start_up import OPTIMISED

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "distance-xz.toml"


def settings_of(*axes: str) -> Settings:
    changes = [(parse_assignment(f"set:{axis}.{OPTIMISED}=1"), as_written) for axis in axes]
    return read_settings(*read_rig(RIG), changes)


@pytest.mark.provokes(70212, 1, axes="Z", others="X")
def test_one_axis_without_it_takes_it_from_all() -> None:
    settings = settings_of("Z")
    (warning,) = [alarm for alarm in settings.warnings if alarm.id == 70212]
    assert "Z have 1 and X 0" in str(warning)
    assert not any(axis.flag(OPTIMISED) for axis in settings.axis.values())


@pytest.mark.parametrize("axes", [(), ("X", "Z")])
def test_alike_on_every_axis_it_is_as_listed(axes: tuple[str, ...]) -> None:
    settings = settings_of(*axes)
    assert [alarm for alarm in settings.warnings if alarm.id == 70212] == []
    assert {axis.flag(OPTIMISED) for axis in settings.axis.values()} == {bool(axes)}
