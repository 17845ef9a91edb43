"""Whole runs on FMUs of other tools: a feed table and a switch in mm, mapped by the rig.

The table is a position loop s' = gain (s_set - s), the switch closes at a depth; both are exact, so
what the bench measures is compared with closed forms.
"""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pandas as pd
import pytest

from bench.cli import main
from bench.plan.assignment import parse_assignment
from bench.rig.file import read_rig
from bench.rig.machine import Machine
from bench.rig.settings import as_written, read_settings
from kernel.nc.parser import read_program

LISTS = Path(__file__).parents[2] / "testplans" / "rigs" / "lists"
RIG = f"""\
title = "table and switch of another tool"

[channel]
list = "{LISTS}/channel.lst"

[segment.can1]

[drive.servo]

[axis.Z]
list = "{LISTS}/axis-z-fine.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "table"
probe_1 = "switch"

[plant.table]
fmu = "table.fmu"
start = {{ "table.s_start_mm" = 103, "control.gain" = 40 }}

[plant.table.map]
demand = "control.s_set"
position = "table.s"

[plant.switch]
fmu = "switch.fmu"
wire = {{ z = "table" }}
start = {{ trip_mm = -100 }}

[plant.switch.map]
z_position = {{ variable = "tip.depth", unit = "mm", sign = -1 }}
signal = {{ variable = "contact_v", threshold = 12 }}
"""
PROGRAM = """\
N10 G90 G1 Z102 F3000
N20 G100 Z98 F500
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 M30
"""
GAIN_PER_S, TICK_S = 40.0, 62.5e-6
FEED_MM_S = 500 / 60
INPUT_DELAY_S = 4e-6
INCREMENT_MM = 10 / 1_048_576

Place = Callable[..., Path]


@pytest.fixture
def place(tmp_path: Path, fmu: Callable[..., Path], version: int) -> Place:
    """A folder with FMUs, rig and program; changes: (old text, new text) of the rig.

    saves: whether states can be saved. table, switch: more that the FMUs promise.
    """

    def make(
        *changes: tuple[str, str],
        saves: bool = True,
        **promises: dict[str, str | bool],
    ) -> Path:
        flag = "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState"
        for model in ("table", "switch"):
            built = fmu(model, **{flag: saves, **promises.get(model, {})})
            (tmp_path / built.name).write_bytes(built.read_bytes())
        text = RIG
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
        (tmp_path / "part.nc").write_text(PROGRAM, encoding="utf-8")
        return tmp_path

    return make


def run(place: Path, *assignments: str) -> Machine:
    """Run the program to its end."""
    rig, files = read_rig(place / "rig.toml")
    changes = [(parse_assignment(text), as_written) for text in assignments]
    settings = read_settings(rig, files, changes)
    machine = Machine(settings, read_program(place / "part.nc", tuple(rig.axis)))
    try:
        machine.run()
    finally:
        machine.close()
    assert machine.channel.alarms == []
    return machine


def latched_mm(machine: Machine) -> float:
    """The measured value of the only run."""
    (record,) = machine.channel.records
    return record.latched_mm["Z"]


def test_edge_is_enclosed_where_the_state_can_be_saved(place: Place) -> None:
    """The switch closes at 100 mm; the drive latches 4 us later, at 500 mm/min."""
    machine = run(place())
    probe = machine.plant.probes["switch"]
    assert probe.edge_uncertainty_ns == 1.0
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    # one increment, one nanosecond, and the demand that is held for 62.5 us: v/8 of it at most
    held_mm = FEED_MM_S * GAIN_PER_S * TICK_S * TICK_S / 8
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=INCREMENT_MM + held_mm)


def test_without_saved_states_a_fine_step_is_the_recorded_uncertainty(place: Place) -> None:
    machine = run(place(saves=False))
    probe = machine.plant.probes["switch"]
    fine_ns = machine.plant.fine_ns
    assert probe.edge_uncertainty_ns == fine_ns
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    uncertain_mm = FEED_MM_S * probe.edge_uncertainty_ns * 1e-9 + INCREMENT_MM
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=uncertain_mm)


FAR = ('"table.s_start_mm" = 103', '"table.s_start_mm" = 170')


def steady_motion(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Lag (mm) and velocity (mm/s) at each SYNC while the table moves steadily at -50 mm/s."""
    (folder / "part.nc").write_text("N10 G90 G1 Z120 F3000\nN20 M30\n", encoding="utf-8")
    trace = run(folder).recorder.table()
    set_mm = trace.column("Z.set_mm").to_numpy()
    steady = np.flatnonzero((set_mm < 140) & (set_mm > 125))
    lag_mm = trace.column("Z.drive_lag_mm").to_numpy()
    return lag_mm[steady], trace.column("Z.velocity_mm_s").to_numpy()[steady]


def held_lag_mm(hold_s: float) -> float:
    """Lag of a position loop whose demand is held: e = v T / (1 - exp(-gain T)).

    From s(k+1) - e = s(k) - e exp(-gain T) with s(k+1) = s(k) + v T, v = -50 mm/s.
    """
    return -50.0 * hold_s / (1 - math.exp(-GAIN_PER_S * hold_s))


def test_lag_is_that_of_a_demand_held_between_drive_ticks(place: Place) -> None:
    """Without the hold it were v/gain, 1.6 um less."""
    lag_mm, speed_mm_s = steady_motion(place(FAR))
    assert abs(held_lag_mm(TICK_S) + 50.0 / GAIN_PER_S) > 1.5e-3
    assert lag_mm == pytest.approx(held_lag_mm(TICK_S), abs=5e-5)
    assert speed_mm_s == pytest.approx(-50.0, abs=50.0 * GAIN_PER_S * TICK_S)


def test_fmu_that_takes_one_step_size_only_is_stepped_on_its_grid(
    place: Place, version: int
) -> None:
    """The demand is then held for its step of 1 ms, and the motion is smooth between its points."""
    size = "stepSize" if version == 2 else "fixedInternalStepSize"
    fixed = {"canHandleVariableCommunicationStepSize": False, size: "0.001"}
    lag_mm, speed_mm_s = steady_motion(place(FAR, table=fixed))
    assert lag_mm == pytest.approx(held_lag_mm(1e-3), abs=5e-5)
    assert speed_mm_s == pytest.approx(-50.0, abs=0.02)


def test_edge_on_a_table_with_a_grid_is_enclosed_as_well(place: Place) -> None:
    """Measured is the place of the edge, whatever the steps of the table are."""
    fixed = {"canHandleVariableCommunicationStepSize": False, "stepSize": "0.001"}
    machine = run(place(table=fixed))
    assert machine.plant.probes["switch"].edge_uncertainty_ns == 1.0
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=2 * INCREMENT_MM)


def test_switch_with_a_grid_knows_its_edge_to_a_step(place: Place) -> None:
    fixed = {"canHandleVariableCommunicationStepSize": False, "stepSize": "0.001"}
    machine = run(place(switch=fixed))
    assert machine.plant.probes["switch"].edge_uncertainty_ns == 1e6
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=FEED_MM_S * 1e-3 + INCREMENT_MM)


def test_encoder_on_the_screw_and_on_the_table_latch_the_same(place: Place) -> None:
    motor = (
        'position = "table.s"\n',
        'position = "table.s"\n'
        'motor_position = { variable = "motor.phi", lead_mm = 10 }\n'
        'motor_velocity = { variable = "motor.n", lead_mm = 10 }\n',
    )
    machine = run(place(motor))
    held_mm = FEED_MM_S * GAIN_PER_S * TICK_S * TICK_S / 8
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=INCREMENT_MM + held_mm)


def test_inverted_switch_gives_the_falling_edge(place: Place) -> None:
    inverted = ("threshold = 12 }", "threshold = 12, sign = -1 }")
    machine = run(place(inverted), "set:Z.kenngr.measure.edge=NEG")
    ((_, level),) = machine.plant.probes["switch"].signal.edges
    assert level is False


def test_same_run_gives_the_same_frames(place: Place) -> None:
    folder = place()
    first, second = run(folder), run(folder)
    assert first.frame_hash.hexdigest() == second.frame_hash.hexdigest()


# ---- what is said


def call(capsys: pytest.CaptureFixture[str], *words: str | Path) -> tuple[object, str, str]:
    """Call `axisrig`."""
    capsys.readouterr()
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    printed = capsys.readouterr()
    return ended.value.code, printed.out, printed.err


def test_check_tells_what_the_bench_makes_of_the_fmus(
    place: Place, capsys: pytest.CaptureFixture[str], version: int
) -> None:
    code, out, err = call(capsys, "check", place() / "rig.toml")
    assert (code, err) == (0, "")
    assert f"plant table (table.fmu, FMI {version}.0) is an axis" in out
    assert "\n  no velocity: numeric derivative of position" in out
    assert f"plant switch (switch.fmu, FMI {version}.0) is a probe" in out
    assert "\n  no rising_count, falling_count, rising_time, falling_time: edges are looked" in out


def test_nc_tells_what_is_done_without(place: Place, capsys: pytest.CaptureFixture[str]) -> None:
    folder = place()
    code, out, err = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert (code, out) == (0, "V.A.MERF.Z=1\n")
    assert "plant table: no enabled: while the drive is off the demand stays" in err


PLAN = """\
case,program,rig,check:latch_mm:Z,check:latch_error_um:Z
a,part.nc,rig.toml,<= {limit},<= 1
"""


def test_uncertain_edge_makes_a_verdict_at_the_limit_inconclusive(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    """The true place of the latch is the limit; the edge is known to 50 us."""
    folder = place(saves=False)
    limit_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    (folder / "plan.csv").write_text(PLAN.format(limit=f"{limit_mm:.7f}"), encoding="utf-8")
    call(capsys, "run", folder / "plan.csv", "-o", folder / "out")
    rows = pd.read_csv(folder / "out" / "results.csv").set_index("metric")
    latch = rows.loc["latch_mm:Z"]
    assert latch["verdict"] == "inconclusive"
    assert latch["uncertainty"] == pytest.approx(FEED_MM_S * 50e-6, rel=0.01)
    assert 0.0 <= limit_mm - latch["value"] <= latch["uncertainty"] + INCREMENT_MM
    told = json.loads((folder / "out" / "runs" / "plan-a.json").read_text(encoding="utf-8"))
    assert "plant switch: edges are known to 50000 ns" in told["log"]
    assert "plant table: no velocity: numeric derivative of position" in told["log"]
    assert [e["label"] for e in told["events"] if e["kind"] == "edge"] == [
        "switch: rising edge, known to 50 us"
    ]
    assert "tells no contact" in told["notes"]["latch_error_um:Z"]


@pytest.mark.parametrize(("behaviour", "value"), [(1, "nan"), (2, "inf")])
def test_position_that_is_no_number_is_told_with_its_variable(
    place: Place, capsys: pytest.CaptureFixture[str], behaviour: int, value: str
) -> None:
    folder = place(('"control.gain" = 40', f'"control.gain" = 40, behaviour = {behaviour}'))
    code, out, err = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert (code, out) == (2, "")
    assert re.search(rf"plant table at t = 200\.\d+ ms: table.s \(position\) is {value}", err)


def test_texts_and_items_of_enumerations_are_start_values_too(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    """The nervous table warns of its text, which the log of the run then holds."""
    more = ('"control.gain" = 40', '"control.gain" = 40, mood = "nervous", text = "Hot Oil"')
    folder = place(more)
    _, _, err = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert re.search(r"plant table at 0\.0+ ms: Hot Oil", err)
    wrong = ('"control.gain" = 40', '"control.gain" = 40, mood = "nervus"')
    code, _, err = call(capsys, "check", place(wrong) / "rig.toml")
    assert code == 2
    assert "has no such item; found 'nervus'; allowed: nervous" in err


def test_unit_that_nobody_defines_takes_a_bare_number_only(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    bare = ('"control.gain" = 40', '"control.gain" = 40, oil = 3')
    assert call(capsys, "check", place(bare) / "rig.toml")[0] == 0
    suffixed = ('"control.gain" = 40', '"control.gain" = 40, oil_mm = 3')
    code, _, err = call(capsys, "check", place(suffixed) / "rig.toml")
    assert code == 2
    assert "is in parsec, which the FMU does not define" in err


@pytest.mark.parametrize("version", [2], ids=["FMI2"], indirect=True)
def test_description_that_breaks_the_standard_is_told_and_used(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    """A tool has put in an attribute of its own, which the schema does not allow."""
    folder = place()
    fmu = folder / "table.fmu"
    with ZipFile(fmu) as old:
        files = {name: old.read(name) for name in old.namelist()}
    text = files["modelDescription.xml"].decode()
    text = text.replace("<CoSimulation ", '<CoSimulation colour="red" ')
    files["modelDescription.xml"] = text.encode()
    with ZipFile(fmu, "w") as new:
        for name, content in files.items():
            new.writestr(name, content)
    code, out, err = call(capsys, "check", folder / "rig.toml")
    assert (code, err) == (0, "")
    assert "its description breaks the standard: " in out
    assert "'colour'" in out
    code, out, _ = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert (code, out) == (0, "V.A.MERF.Z=1\n")


MISTAKES = [
    (
        ('position = "table.s"', 'position = "motor.phi"'),
        "position = ",
        ["motor.phi is in rad", "lead_mm"],
    ),
    (('"table.s"', '"tabel.s"'), "position = ", ["'tabel.s'", "table.s"]),
    (("z_position =", "z_posision ="), "z_posision", ["z_posision", "z_position"]),
    (('position = "table.s"\n', ""), "fmu = ", ["a plant of the kind axis needs: position"]),
    (('wire = { z = "table" }\n', ""), "[plant.switch]", ["wired to no axis"]),
    (('unit = "mm"', 'unit = "ell"'), "z_position", ["'ell'", "unknown unit"]),
    (("sign = -1", "sign = 2"), "z_position", ["z_position.sign: input should be 1 or -1"]),
    (("sign = -1", "sgn = -1"), "z_position", ["unknown rig key", "sgn", "did you mean sign?"]),
    (("threshold = 12", 'threshold = "a"'), "signal", ["threshold: must be a number"]),
    (
        ('variable = "contact_v", ', ""),
        "signal",
        ["lacks the key", "map.signal.variable"],
    ),
    (('position = "table.s"', "position = 5"), "position = ", ["must be a text", "found 5"]),
    (('position = "table.s"', 'position = ""'), "position = ", ["no such variable; found ''"]),
    (('"table.fmu"\n', '"table.fmu"\nwire = { z = "table" }\n'), "wire = ", ["is an axis"]),
    (
        ('"table.s_start_mm" = 103', '"table.s_start" = 103'),
        "start = ",
        ["is in mm", "would be a guess", "table.s_start_mm"],
    ),
    (
        ('"table.s_start_mm" = 103', '"table.s_start_mm_s" = 103'),
        "start = ",
        ["another unit", "mm_s"],
    ),
    (("trip_mm", "tripp_mm"), "start = ", ["'tripp'", "trip"]),
    (('"control.gain" = 40', '"control.s_set_mm" = 40'), "start = ", ["control.s_set"]),
]


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
@pytest.mark.parametrize(("change", "line", "fragments"), MISTAKES)
def test_mistake_in_a_map_is_told_with_its_place(
    place: Place,
    capsys: pytest.CaptureFixture[str],
    change: tuple[str, str],
    line: str,
    fragments: list[str],
) -> None:
    folder = place(change)
    code, out, err = call(capsys, "check", folder / "rig.toml")
    assert (code, out) == (2, "")
    number = int(err.split("rig.toml:")[1].split(":")[0])
    text = (folder / "rig.toml").read_text(encoding="utf-8").splitlines()[number - 1]
    assert text.startswith(line), err
    for fragment in fragments:
        assert fragment in err
