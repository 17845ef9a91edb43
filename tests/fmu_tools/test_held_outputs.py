"""An axis that steps inside more coarsely than it is asked to gives no place of an edge."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from fmu_rigs import RIG

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.plant import refuse_held_outputs

Call = Callable[..., Any]


def axis(*tick: float) -> PlantAxis:
    return cast("PlantAxis", SimpleNamespace(tick=tick, name="z"))


@pytest.mark.parametrize(
    ("tick", "is_good"),
    [
        ((0.1, 0.01, 0.1000005, 0.01), True),  # 0.5 um in 50 us at 10 mm/s
        ((0.1, 0.0, 0.1, 0.0), True),  # at rest
        ((0.1, 0.01, 0.1, 0.01), False),  # it has a speed and stands still
        ((0.1, -0.01, 0.09999, -0.01), False),  # 10 um at once
        ((0.1, 0.1, 0.1000025, 0.0), True),  # a stop half way through
        ((0.1, 0.0, 0.1000006, 0.024), True),  # from rest with 480 m/s2
        ((0.1, 1e-6, 0.1, 1e-6), True),  # 0.05 nm are below what a step shows
    ],
)
def test_a_step_must_be_one_of_the_axis(
    tick: tuple[float, float, float, float], is_good: bool
) -> None:
    if is_good:
        refuse_held_outputs(axis(*tick), 0, 50_000)
        return
    with pytest.raises(PlantError, match="steps inside more coarsely"):
        refuse_held_outputs(axis(*tick), 0, 50_000)


@pytest.mark.long
def test_a_run_with_such_an_axis_gives_no_measured_value(
    place: Path, axisrig: Call, ideal_axis: Callable[..., Path]
) -> None:
    """It was -0.62 um off, certain to 0.06 nm."""
    fmu = ideal_axis("held.fmu", FLAW="HOLDS")
    rig = RIG.format(fmu=fmu.as_posix()).replace(
        'plant = "z"\n', 'plant = "z"\nprobe_1 = "probe"\nprobe_2 = "probe"\n'
    )
    rig += "\n[cycle]\nexchange_us = 50\nfine_us = 50\n"
    rig += '\n[plant.probe]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { z = "z" }\n'
    (place / "held.toml").write_text(rig + "start = { surface_mm = 125.3 }\n", encoding="utf-8")
    (place / "touch.nc").write_text("N10 G90 G100 Z120 F600\nN20 M30\n", encoding="utf-8")
    plan = "case,program,rig,check:latch_error_um\na,touch.nc,held.toml,<= 100\n"
    (place / "plan.csv").write_text(plan, encoding="utf-8")
    code, out, err = axisrig("run", "plan.csv", "-o", "out")
    assert code == 4, out + err
    assert "steps inside more coarsely" in out + err
