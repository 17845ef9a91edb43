"""The lever of a rotary axis: what makes torques of forces, and metres of angles."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.rig.reading.file import MapTable
from axisrig.bench.rig.rotary import arm_m, is_rotary, torque_arm_m


def settings(list_says: bool = False, **leads_mm: float | None) -> Any:
    """An axis A whose plant maps these roles; None is a role that is no rotation."""
    roles = {
        role: MapTable(variable=role) if lead is None else MapTable(variable=role, lead_mm=lead)
        for role, lead in leads_mm.items()
    }
    return SimpleNamespace(
        rig=SimpleNamespace(
            axis={"A": SimpleNamespace(plant="table")},
            plant={"table": SimpleNamespace(map=roles)},
        ),
        axis={"A": SimpleNamespace(is_rotary=list_says)},
        is_settled=False,
    )


def test_the_lever_is_the_lead_by_a_turn() -> None:
    """A screw of 10 mm: 1.59 mm for a radian; a table of 360 mm for a turn: 57.3 mm."""
    assert arm_m(settings(position=10.0), "A") == pytest.approx(0.010 / math.tau)
    assert arm_m(settings(position=360.0), "A") == pytest.approx(0.360 / math.tau)
    assert arm_m(settings(position=None), "A") is None
    assert arm_m(settings(), "A") is None


def test_a_table_of_360_mm_a_turn_is_rotary_and_so_is_what_its_list_names_so() -> None:
    assert is_rotary(settings(position=360.0), "A")
    assert not is_rotary(settings(position=10.0), "A")
    assert not is_rotary(settings(), "A")
    assert is_rotary(settings(list_says=True, position=None), "A")


def test_the_lever_of_torques_is_that_of_the_force_at_the_stop_before_that_of_the_motor() -> None:
    both = settings(position=360.0, stop_force=180.0, force=90.0)
    assert torque_arm_m(both, "A") == pytest.approx(0.180 / math.tau)
    motor = settings(position=360.0, force=90.0)
    assert torque_arm_m(motor, "A") == pytest.approx(0.090 / math.tau)
    assert torque_arm_m(settings(position=10.0, force=90.0), "A") is None  # a linear axis
    assert torque_arm_m(settings(position=360.0, force=None), "A") is None
