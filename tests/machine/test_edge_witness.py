"""The edge of a probe against a witness inside the axis.

The axis of these runs notes by itself, as an event of its own integration, when it passes the wall.
The bench never reads that: it hands the motion to the probe's FMU in steps of its own choice.
"""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.fmus.build import LIBRARY, build

WITNESS = """within AxisRig.Drives;
model WitnessAxis "Servo axis that notes when it passes a place"
  extends ServoAxis;
  parameter Units.Position wall = 0 "Place";
  discrete output Units.Time hit_time(start = -1, fixed = true) "When";
  output Integer hits(start = 0, fixed = true) "How often";
equation
  when position < wall then
    hit_time = time;
    hits = pre(hits) + 1;
  end when;
end WitnessAxis;
"""
START_MM = 120.0
DELAY_NS = 120_000


@pytest.fixture(scope="module")
def witness(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU of the axis with the witness."""
    folder = tmp_path_factory.mktemp("witness")
    library = folder / LIBRARY.name
    shutil.copytree(LIBRARY, library)
    (library / "Drives" / "WitnessAxis.mo").write_text(WITNESS, encoding="utf-8")
    return build("AxisRig.Drives.WitnessAxis", folder / "witness.fmu", library, 25e-6)


@pytest.fixture
def answer(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, float]]:
    """What the witness tells: instant (s) and count, read when a machine is closed."""
    found: list[tuple[float, float]] = []
    close = Machine.close

    def read_and_close(machine: Machine) -> None:
        for axis in machine.plant.axes.values():
            found.append((axis.slave.get("hit_time"), axis.slave.get("hits")))
        close(machine)

    monkeypatch.setattr(Machine, "close", read_and_close)
    return found


# From standstill, in speeding up, at the end of speeding up (5 mm), in steady motion, in braking
@pytest.mark.long
@pytest.mark.parametrize("depth_mm", [0.002, 0.1, 4.99, 7.0, 15.5])
@pytest.mark.parametrize("cycle", ["", "exchange_us = 100", "period_us = 10000"])
@pytest.mark.parametrize("feed_forward", [0.0, 1.0])
def test_edge_comes_when_the_axis_passes_the_wall(
    run_nc: Callable[..., Any],
    witness: Path,
    answer: list[tuple[float, float]],
    depth_mm: float,
    cycle: str,
    feed_forward: float,
) -> None:
    """To the rounding of a nanosecond, and the trigger delay later."""
    wall = f"{START_MM - depth_mm!r}"
    axis = f"position_start_mm = {START_MM}, feed_forward = {feed_forward}, wall_mm = {wall}"
    rig = f"""
    [cycle]
    {cycle}
    [plant.z]
    fmu = "{witness.as_posix()}"
    start = {{ {axis} }}
    [plant.probe]
    start = {{ surface_mm = {wall}, trigger_delay_us = {DELAY_NS / 1000} }}
    """
    out = run_nc("N10 G100 Z100 F6000", rig, base="probe-z.toml")
    ((hit_s, hits),) = answer
    (probe,) = out.machine.plant.probes.values()
    assert hits == 1
    assert abs(probe.contacts[0].time_ns - hit_s * 1e9) < 1.0
    assert abs(probe.signal.edges[0][0] - DELAY_NS - hit_s * 1e9) < 1.0
