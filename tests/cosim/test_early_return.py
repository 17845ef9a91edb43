"""Whole runs with a light gate that cannot save its state but returns early at its edges.

The axis is where its demand is, at 10 mm/s a whole number of encoder increments further in each
cycle: a straight line, of which each row of the trace is a point.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from axisrig.bench.cli.main import main
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.nc.text.parser import read_program

LISTS = Path(__file__).parents[2] / "testplans" / "rigs" / "lists"
TRIP_MM, BEAM_MM, FEED_MM_S = 100.0001234, 200e-6, 10.0
DELAY_S, INCREMENT_MM = 4e-6, 10e-6
RIG = f"""\
title = "rod in a light gate"
[channel]
list = "{LISTS}/channel.lst"
[segment.can1]
[drive.servo]
encoder_increments = 1_000_000
lead_mm = 10
[axis.Z]
list = "{LISTS}/axis-z-fine.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "rod"
probe_1 = "gate"
[plant.rod]
fmu = "rod.fmu"
start = {{ position_start_mm = 102 }}
[plant.gate]
fmu = "gate.fmu"
kind = "probe"
wire = {{ z = "rod" }}
start = {{ trip_mm = {TRIP_MM}, beam_mm = {BEAM_MM} }}
[plant.gate.map]
signal = "level"
"""
WIDE = RIG.replace(f"beam_mm = {BEAM_MM}", "beam_mm = 50")
PROGRAM = "N10 G100 Z98 F600\nN20 M30\n"

Make = Callable[..., Path]


@pytest.fixture
def place(tmp_path: Path, fmu: Make) -> Make:
    """A folder with rod and gate, rig and program. promises: of the gate."""

    def make(**promises: bool) -> Path:
        for model, found in (("rod", {}), ("gate", promises)):
            built = fmu(model, **found)
            (tmp_path / built.name).write_bytes(built.read_bytes())
        (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
        (tmp_path / "part.nc").write_text(PROGRAM, encoding="utf-8")
        return tmp_path

    return make


def run(place: Path) -> Machine:
    """Run the program to its end."""
    rig, files = read_rig(place / "rig.toml")
    program = read_program(place / "part.nc", tuple(rig.axis))
    machine = Machine(read_settings(rig, files, []), program)
    try:
        machine.run()
    finally:
        machine.close()
    assert machine.channel.alarms == []
    return machine


def passes_ns(machine: Machine, place_mm: float) -> float:
    """When the rod is at a place, by the last SYNC before; it goes straight down there."""
    trace = machine.recorder.table()
    times, z_mm = trace.column("time_ns").to_numpy(), trace.column("Z.truth_mm").to_numpy()
    near = np.flatnonzero((z_mm > place_mm) & (z_mm < place_mm + 0.1))
    assert np.diff(z_mm[near]) == pytest.approx(-FEED_MM_S * 1e-3, abs=1e-12)
    last = near[-1]
    return float(times[last] + (z_mm[last] - place_mm) / FEED_MM_S * 1e9)


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
def test_both_edges_of_a_narrow_beam_are_known_to_a_nanosecond(place: Make) -> None:
    """The rod is in the beam for 20 us, which is less than a fine step."""
    machine = run(place(mightReturnEarlyFromDoStep=True))
    probe = machine.plant.probes["gate"]
    assert not probe.slave.can.can_save_state
    (dark_ns, dark), (light_ns, light) = probe.signal.edges
    assert (dark, light) == (True, False)
    assert dark_ns == pytest.approx(passes_ns(machine, TRIP_MM), abs=1.0)
    assert light_ns == pytest.approx(passes_ns(machine, TRIP_MM - BEAM_MM), abs=1.0)
    assert probe.edge_uncertainty_ns == 1.0
    (record,) = machine.channel.records
    expected_mm = TRIP_MM - FEED_MM_S * DELAY_S
    # half an increment, and the nanosecond to which edges are counted
    assert record.latched_mm["Z"] == pytest.approx(expected_mm, abs=0.51 * INCREMENT_MM)


@pytest.mark.long
@pytest.mark.parametrize("version", [2, 3], ids=["FMI2", "FMI3"], indirect=True)
def test_without_the_offer_a_fine_step_is_the_uncertainty(place: Make) -> None:
    """The gate would return early, but nobody allows what its description does not offer."""
    folder = place()
    (folder / "rig.toml").write_text(WIDE, encoding="utf-8")
    machine = run(folder)
    probe = machine.plant.probes["gate"]
    ((edge_ns, _),) = probe.signal.edges
    assert probe.edge_uncertainty_ns == machine.plant.fine_ns
    assert 0.0 <= edge_ns - passes_ns(machine, TRIP_MM) <= probe.edge_uncertainty_ns


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
@pytest.mark.parametrize(("behaviour", "text"), [(1, "does not advance"), (2, "is no number")])
def test_gate_whose_time_stops_is_no_run_without_an_edge(
    place: Make, behaviour: int, text: str
) -> None:
    """Nothing comes of it any more; the run must not say that the probe met nothing."""
    folder = place()
    stopped = WIDE.replace("beam_mm = 50", f"beam_mm = 50, behaviour = {behaviour}")
    (folder / "rig.toml").write_text(stopped, encoding="utf-8")
    with pytest.raises(
        PlantError, match=rf"plant gate at t = 10\.\d+ ms: doStep: ok, but .*{text}"
    ):
        run(folder)


PLAN = """\
case,program,rig,check:latch_mm:Z,check:latch_error_um:Z
a,part.nc,rig.toml,<= {limit},<= 1
"""


@pytest.mark.long
@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
@pytest.mark.parametrize(
    ("offers", "known_ns", "verdict"), [(True, 0, "fail"), (False, 50e3, "inconclusive")]
)
def test_early_return_decides_a_verdict(
    place: Make, offers: bool, known_ns: float, verdict: str
) -> None:
    """The limit is not quite half a micrometre below the latch, which is the way of a fine step."""
    folder = place(mightReturnEarlyFromDoStep=offers)
    (folder / "rig.toml").write_text(WIDE, encoding="utf-8")
    (folder / "plan.csv").write_text(PLAN.format(limit=TRIP_MM - 5e-4), encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["run", str(folder / "plan.csv"), "-o", str(folder / "out")])
    rows = pd.read_csv(folder / "out" / "results.csv").set_index("metric")
    latch = rows.loc["latch_mm:Z"]
    assert latch["verdict"] == verdict
    assert latch["uncertainty"] == pytest.approx(FEED_MM_S * known_ns * 1e-9, abs=INCREMENT_MM)
