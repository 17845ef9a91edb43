"""Long steps lose no edge: three axes wander about a workpiece, seen twice.

Once every step is fine and the probe follows all the time, once steps are as long as the bench
thinks right. Edges, contacts and the motion must be the same bits.
"""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS, US

Fmu = Callable[[str], Path]
PLANE, WORKPIECE = "AxisRig.Sensors.TouchProbe", "AxisRig.Sensors.WorkpieceProbe"
SURFACES: dict[str, tuple[str, dict[str, float]]] = {
    "inclined plane, delay, three-leg seat": (
        PLANE,
        {"normal_x": 1 / 3, "normal_y": 2 / 3, "normal_z": 2 / 3, "surface": 0.0}
        | {"pretravel": 2e-6, "trigger_delay": 180e-6, "seat_force": 0.5},
    ),
    "bounce, radio with jitter, switched on late": (
        WORKPIECE,
        {"trigger_delay": 2e-4, "radio_delay": 1e-3, "radio_jitter": 2e-4, "bounce_count": 3}
        | {"bounce_time": 0.4e-3, "release_bounce_count": 2, "switch_on_time": 0.3},
    ),
    "waves under a ball": (
        WORKPIECE,
        {"workpiece.plane.level": -5e-4, "ball_radius": 5e-4, "pretravel": 2e-6}
        | {"workpiece.sine.amplitude": 3e-4, "workpiece.sine.wavelength": 0.02}
        | {"workpiece.sine.azimuth": 0.4},
    ),
    "end of the material": (WORKPIECE, {"workpiece.border.position": 2e-4, "ball_radius": 2e-4}),
}


def wander(fmu: Fmu, surface: str, seed: int, exchange_ns: int) -> tuple[Any, ...]:
    """Move for 0.9 s from place to place near the surface; instants of commands are irregular."""
    choose = random.Random(seed)
    plant = Plant(exchange_ns, hold_ns=333_000)
    try:
        for name in "xyz":
            slave = load_fmu(fmu("AxisRig.Drives.ServoAxis"), name)
            slave.set_start("kv", 60.0)
            plant.add_axis(slave)
        model, start = SURFACES[surface]
        slave = load_fmu(fmu(model), "probe")
        for variable, value in start.items():
            slave.set_start(variable, value)
        plant.add_probe(slave, {name: name for name in "xyz"})
        plant.initialize(0)
        now_ns, where = 0, []
        while now_ns < 900 * MS:
            span_ns = choose.choice([MS, 3 * MS, 7 * MS + 12_345, 20 * MS, 45 * MS])
            reach_m = choose.choice([2e-6, 2e-5, 3e-4, 4e-3])
            for axis in plant.axes.values():
                here = axis.demand_position_m()
                rate = (choose.uniform(-reach_m, reach_m) - here) / max(span_ns * 1e-9, 5e-3)
                axis.command(now_ns, here, rate, now_ns + span_ns, True)
            now_ns += span_ns
            plant.advance_to(now_ns)
            where.append([axis.position_m() for axis in plant.axes.values()])
        probe = plant.probes["probe"]
        return probe.signal.edges, probe.contacts, where
    finally:
        plant.close()


@pytest.mark.long
@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("seed", range(2))
def test_long_steps_find_what_fine_steps_find(fmu: Fmu, surface: str, seed: int) -> None:
    fine, long = (wander(fmu, surface, seed, exchange_ns) for exchange_ns in (50 * US, 20 * MS))
    assert len(fine[0]) >= 4
    assert len(fine[1]) >= 2
    assert long == fine
