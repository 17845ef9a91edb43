"""Programs and moments of the tests of 3D distance control in a channel."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

Make = Callable[..., Any]
LONG = partial(pytest.param, marks=pytest.mark.long)
INCREMENT_MM = 10 / 2**20
SENSOR = "#DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]\n"
HEAD = "V.G.KIN_STEP[0].ID[9].PARAM[0]=1000000\nV.G.WZ_AKT.L=80\n#TRAFO [9]\n"
TILTED = HEAD + "G1 F60000 A-40\n" + SENSOR


def rising(ms: float) -> float:
    """A plane that rises by 1 mm within 0.5 s, from 500 ms on."""
    return min(max(0.0, (ms - 500) * 2e-3), 1.0)


def dwell(ms: int) -> str:
    return f"#TIME {ms / 1e3}\n"


def inclined(c_deg: float, a_deg: float) -> Callable[[int], tuple[tuple[float, ...], float, float]]:
    """A program that stays at one place with the tool turned and tilted."""
    return lambda _cycle: ((10.0, 20.0, 0.0), c_deg, a_deg)
