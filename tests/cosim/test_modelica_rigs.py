"""A carriage and a light barrier from Modelica, with names and units of their own."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from tests.small_fmus import small_fmu

from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.plants import build_plant, describe_plants
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program

LISTS = Path(__file__).parents[2] / "testplans" / "rigs" / "lists"
LIBRARY = """package Shop
  model Carriage "Speed follows a position loop with a lag of first order"
    input Real s_cmd(unit="mm") "Commanded";
    input Boolean power(start=false) "On";
    input Real draught(unit="mm/s", start=0) "Added to the speed that is asked for";
    parameter Real s_begin(unit="mm") = 0 "Where it begins";
    parameter Real kv(unit="1/min") = 2400 "Position loop";
    parameter Real lag(unit="ms") = 2 "Of the speed";
    output Real s(unit="mm", start=s_begin, fixed=true) "Actual";
    output Real v(unit="mm/s", start=0, fixed=true) "Speed";
    output Real screw(unit="deg") "Turns once per 5 mm";
  equation
    der(s) = v;
    der(v) = ((if power then kv/60*(s_cmd - s) else 0) + draught - v)/(lag*1e-3);
    screw = 72*s;
  end Carriage;
  model Barrier "Light barrier: dark below its height"
    input Real above(unit="um") "Edge of the carriage";
    parameter Real height(unit="um") = 100000 "Of the beam";
    output Boolean light "The beam arrives";
  equation
    light = above > height;
  end Barrier;
  model Eye "Optical distance sensor"
    input Real above(unit="um") "Place of the sensor";
    parameter Real surface(unit="mm") = 90 "Below it";
    parameter Real reach(unit="mm") = 15 "Farther it sees nothing";
    output Real reading(unit="mm") "Distance";
    output Boolean blind "Nothing in reach";
  equation
    reading = above*1e-3 - surface;
    blind = reading > reach;
  end Eye;
  model Tracer "With the names of the roles: straight between the ends of a step"
    input Real step_time(unit="s");
    input Real step_size(unit="s", start=1);
    input Real z_start(unit="m");
    input Real z_rate_start(unit="m/s");
    input Real z_end(unit="m");
    input Real z_rate_end(unit="m/s");
    output Real distance(unit="m");
    output Real distance_true(unit="m");
  equation
    distance = z_start + (time - step_time)/step_size*(z_end - z_start);
    distance_true = distance + 0*(z_rate_start + z_rate_end);
  end Tracer;
end Shop;
"""
RIG = f"""\
title = "from Modelica"
[channel]
list = "{LISTS}/channel.lst"
[segment.can1]
[drive.servo]
[axis.Z]
list = "{LISTS}/axis-z-fine.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "carriage"
probe_1 = "barrier"
[plant.carriage]
fmu = "carriage.fmu"
start = {{ s_begin_mm = 112 }}
[plant.carriage.map]
demand = "s_cmd"
enabled = "power"
position = "s"
velocity = "v"
motor_position = {{ variable = "screw", lead_mm = 5 }}
[plant.barrier]
fmu = "barrier.fmu"
wire = {{ z = "carriage" }}
[plant.barrier.map]
z_position = "above"
signal = {{ variable = "light", sign = -1 }}
[plant.eye]
fmu = "eye.fmu"
wire = {{ z = "carriage" }}
start = {{ surface_um = 91000 }}
[plant.eye.map]
z_position = "above"
distance = "reading"
valid = {{ variable = "blind", sign = -1 }}
[plant.tracer]
fmu = "tracer.fmu"
wire = {{ z = "carriage" }}
"""
PROGRAM = """\
N10 G90 G1 Z108 F500
N20 G100 Z96 F500
N30 M30
"""
SPEED_MM_S, KV_PER_S, TICK_S = 500 / 60, 40.0, 62.5e-6
INCREMENT_MM = 10 / 1_048_576


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Modelica package."""
    root = tmp_path_factory.mktemp("library") / "Shop"
    root.mkdir()
    (root / "package.mo").write_text(LIBRARY, encoding="utf-8")
    return root


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def place(
    request: pytest.FixtureRequest, library: Path, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """A folder with the FMUs in one version of the standard, rig and program."""
    folder = tmp_path_factory.mktemp("shop")
    for model in ("Carriage", "Barrier", "Eye", "Tracer"):
        built = small_fmu(f"Shop.{model}", library, fmi=request.param)
        shutil.copyfile(built, folder / f"{model.lower()}.fmu")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
    (folder / "part.nc").write_text(PROGRAM, encoding="utf-8")
    return folder


def settings_of(place: Path, *assignments: str) -> Settings:
    """The rig with assignments as on the command line."""
    rig, files = read_rig(place / "rig.toml")
    changes = [(parse_assignment(text), as_written) for text in assignments]
    return read_settings(rig, files, changes)


@pytest.fixture(scope="module")
def machine(place: Path) -> Machine:
    """What a run left behind."""
    settings = settings_of(place)
    machine = Machine(settings, read_program(place / "part.nc", tuple(settings.rig.axis)))
    try:
        machine.run()
    finally:
        machine.close()
    return machine


@pytest.mark.long
def test_beam_is_measured_where_the_screw_is_four_microseconds_later(machine: Machine) -> None:
    """The carriage breaks the beam at 100 mm in steady motion; the encoder sits on the screw."""
    assert machine.channel.alarms == []
    assert machine.plant.probes["barrier"].edge_uncertainty_ns == 1.0
    (record,) = machine.channel.records
    expected_mm = 100.0 - SPEED_MM_S * 4e-6
    assert record.latched_mm["Z"] == pytest.approx(expected_mm, abs=2 * INCREMENT_MM)


@pytest.mark.long
def test_steady_lag_is_that_of_the_loop_and_half_a_drive_tick(machine: Machine) -> None:
    """v/kv, and v T/2 since the held staircase lies that much behind the ramp on average."""
    trace = machine.recorder.table()
    set_mm = trace.column("Z.set_mm").to_numpy()
    steady = np.flatnonzero((set_mm < 104) & (set_mm > 101))
    lag_mm = trace.column("Z.drive_lag_mm").to_numpy()[steady]
    expected_mm = -SPEED_MM_S * (1 / KV_PER_S + TICK_S / 2)
    assert lag_mm == pytest.approx(expected_mm, abs=3 * INCREMENT_MM)
    speed_mm_s = trace.column("Z.velocity_mm_s").to_numpy()[steady]
    assert speed_mm_s == pytest.approx(-SPEED_MM_S, rel=1e-3)


@pytest.mark.long
def test_distance_sensor_is_recorded_with_the_place_of_the_axis(machine: Machine) -> None:
    """It reads the height above 91 mm, up to 15 mm."""
    trace = machine.recorder.table()
    assert set(trace.column_names) >= {"eye.distance_mm", "eye.valid"}
    assert "eye.distance_true_mm" not in trace.column_names
    truth_mm = trace.column("Z.truth_mm").to_numpy()
    distance_mm = trace.column("eye.distance_mm").to_numpy()
    assert distance_mm == pytest.approx(truth_mm - 91.0, abs=1e-9)
    valid = trace.column("eye.valid").to_numpy()
    assert list(np.unique(valid)) == [0, 1]
    assert np.array_equal(valid == 1, distance_mm <= 15.0)


@pytest.mark.long
def test_distance_sensor_with_trajectories_follows_them(machine: Machine) -> None:
    trace = machine.recorder.table()
    truth_mm = trace.column("Z.truth_mm").to_numpy()
    for column in ("tracer.distance_mm", "tracer.distance_true_mm"):
        assert trace.column(column).to_numpy() == pytest.approx(truth_mm, abs=1e-9)


@pytest.mark.long
def test_notes_tell_what_is_left_out(machine: Machine) -> None:
    lacking = {note.partition(":")[0] for note in machine.plant.notes["carriage"]}
    assert "no motor_velocity" in lacking
    assert "no velocity" not in lacking
    assert "no enabled" not in lacking


def test_input_without_a_role_is_told_and_never_wired_to_something(place: Path) -> None:
    settings = settings_of(place)
    plant = build_plant(settings)
    found = describe_plants(settings, plant)
    plant.close()
    assert "  nothing is wired to draught: start values are kept" in found


def test_input_without_a_role_takes_a_start_value_in_its_own_unit(place: Path) -> None:
    plant = build_plant(settings_of(place, "plant:carriage.draught_m_min=0.06"))
    plant.initialize()
    assert plant.axes["carriage"].slave.get("draught") == pytest.approx(1.0, rel=1e-15)
    plant.close()
