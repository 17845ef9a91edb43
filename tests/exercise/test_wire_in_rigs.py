"""The toy family in a rig and in a machine, beside a CANopen drive: by one row of the registry."""

import dataclasses
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import cast

import pytest
from tests.architecture.sources import imported_names, trees
from typer.testing import CliRunner

from axisrig.bench.campaign.results.build_info import is_compiled
from axisrig.bench.cli.main import app
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading import families
from axisrig.bench.rig.reading.families import FAMILIES, Joined
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES, DriveType

pytestmark = pytest.mark.skipif(is_compiled(), reason="the toy is written in Python alone")

SCENARIOS = Path(families.__file__).parents[2] / "tools" / "scenarios"
SURFACE_MM, INCREMENTS_PER_MM = -0.4321, 10_000
RIG = """
title = "a drive on a wire beside one on CAN"
[channel]
list = "channel.lst"
[segment.bundle]
carrier = "wire"
[segment.can1]
[drive.wired]
family = "wire"
[drive.servo]
[axis.Z]
list = "axis-z.lst"
segment = "bundle"
drive = "wired"
plant = "z"
probe_1 = "probe"
[axis.X]
list = "axis-x.lst"
segment = "can1"
node = 1
drive = "servo"
plant = "x"
[plant.z]
fmu = "AxisRig.Drives.ServoAxis"
start = { position_start_mm = 0.5, kv = 100 }
[plant.x]
fmu = "AxisRig.Drives.ServoAxis"
start = { kv = 100 }
[plant.probe]
fmu = "AxisRig.Sensors.TouchProbe"
start = { surface_mm = SURFACE }
wire = { z = "z" }
""".replace("SURFACE", str(SURFACE_MM))
PROGRAM = """%wire
N10 G90 G01 X2 F3000
N20 G100 Z-1 F300
N30 #MSG SYN["z=%f", V.A.MEAS.ACS.VALUE.Z]
N40 G01 Z0.5 X3 F3000
N50 M30
"""


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    """A folder with rig, lists and program; the toy has its rows in the registry.

    A bundle of wires carries drives of its own family, and such with the keys of CANopen.
    """
    keys, family = "tests.exercise.wire.keys", "tests.exercise.wire.family"
    servo = next(row.drive for row in FAMILIES if row.family == "canopen")
    rows = [
        Joined("wire", "wire", keys, keys, family, family),
        Joined("canopen", "wire", servo, keys, family, family),
    ]
    for name in ("channel.lst", "axis-z.lst"):
        shutil.copy(SCENARIOS / name, tmp_path / name)
    of_z = (tmp_path / "axis-z.lst").read_text(encoding="utf-8")
    of_x = re.sub(r"(log_achs_name\s+)Z", r"\1X", re.sub(r"(achs_nr\s+)1", r"\g<1>2", of_z))
    of_x = re.sub(r"(messachse\s+)1", r"\g<1>0", of_x)
    assert sum(a != b for a, b in zip(of_x.split(), of_z.split(), strict=True)) == 3
    (tmp_path / "axis-x.lst").write_text(of_x, encoding="utf-8")
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    (tmp_path / "wire.nc").write_text(PROGRAM, encoding="utf-8")
    FAMILIES.extend(rows)
    yield tmp_path
    del FAMILIES[-2:]


def settings_of(folder: Path, *changes: str, rig: str = RIG) -> Settings:
    (folder / "rig.toml").write_text(rig, encoding="utf-8")
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(folder / "rig.toml"), assigned)
    check_rig(settings)
    return settings


def test_both_drives_move_in_one_machine_and_the_wire_measures(folder: Path) -> None:
    """The latch is where the motor was at the edge, in increments of the drive."""
    settings = settings_of(folder)
    machine = Machine(settings, read_program(folder / "wire.nc", tuple(settings.rig.axis)))
    try:
        machine.run()
        facts = facts_of(machine)
        seen = Observed(facts, machine.recorder.series())
    finally:
        machine.close()
    assert [str(alarm) for alarm in machine.channel.alarms] == []
    ((_, edge_level), *_) = machine.plant.probes["probe"].signal.edges
    assert edge_level
    (line,) = [message.shown for message in machine.messages]
    assert float(line.partition("=")[2]) == pytest.approx(SURFACE_MM, abs=2.0 / INCREMENTS_PER_MM)
    assert [latch.probe for latch in facts.axes["Z"].latches] == [1]
    assert facts.axes["Z"].telegrams == ()
    assert [telegram.name for telegram in facts.axes["X"].telegrams] != []
    assert [bus.segment for bus in facts.buses] == ["can1"]
    assert seen.column("X", "truth_mm")[-1] == pytest.approx(3.0, abs=0.05)
    assert seen.column("Z", "truth_mm")[-1] == pytest.approx(0.5, abs=0.05)


@pytest.mark.long
def test_a_plan_with_it_passes_and_its_report_is_written(folder: Path) -> None:
    heads = "case,rig,program,check:alarms,check:latch_error_um"
    plan = f"{heads}\nfirst,rig.toml,wire.nc,none,0 +- 0.2\n"
    (folder / "plan.csv").write_text(plan, encoding="utf-8")
    words = ["run", str(folder / "plan.csv"), "-j", "1", "-o", str(folder / "out")]
    ended = CliRunner().invoke(app, words)
    assert ended.exit_code == 0, ended.output
    assert "<html" in (folder / "out" / "report.html").read_text(encoding="utf-8")


def test_a_rig_is_described_with_both(folder: Path) -> None:
    ended = CliRunner().invoke(app, ["check", str(folder / "rig.toml")])
    assert ended.exit_code == 0, ended.output
    assert "axis Z: on bundle, drive wired (10000 increments per mm)" in ended.output
    assert "axis Z: on a wire of its own" in ended.output
    assert "axis X: node 1 on can1, drive servo (profile generic)" in ended.output


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('family = "wire"', 'family = "wier"', "there is no such family; allowed: wire"),
        ('carrier = "wire"', 'carrier = "wir"', "there is no such carrier; allowed: wire"),
        ('carrier = "wire"', 'carrier = "wire"\ncolour = "pink"', "colour"),
        ('carrier = "wire"', 'carrier = "wire"\nbitrate = 500000', "unknown rig key"),
        (
            'segment = "bundle"',
            'segment = "can1"\nnode = 4',
            "does not carry drives of the family wire",
        ),
        ('segment = "bundle"', 'segment = "bundle"\nnode = 4', "there are no nodes"),
        ("node = 1\n", "", "the rig lacks the key axis.X.node"),
        ('probe_1 = "probe"', 'probe_2 = "probe"', "a drive on a wire has one input"),
    ],
)
def test_what_does_not_fit_together_is_refused_with_its_place(
    folder: Path, old: str, new: str, words: str
) -> None:
    with pytest.raises(UserError, match=words) as caught:
        settings_of(folder, rig=RIG.replace(old, new, 1))
    assert caught.value.file == str(folder / "rig.toml")
    assert caught.value.line is not None


def test_cells_reach_the_keys_of_each_kind(folder: Path) -> None:
    """`all` means those that have the key."""
    settings = settings_of(
        folder,
        "drive:wired.increments_per_mm=5000",
        "bus:all.overload=run",
        "bus:bundle.colour=blue",
    )
    assert settings.rig.drive["wired"].facts().units_per_mm == 5000
    assert settings.segment["bundle"].model_dump()["colour"] == "blue"
    assert settings.segment["can1"].model_dump()["overload"] == "run"
    for change in ("drive:wired.profile=generic", "bus:bundle.bitrate=500000", "bus:all.weight=1"):
        with pytest.raises(UserError, match="has no such key"):
            settings_of(folder, change)
    for change in ("bus:bundle.carrier=can", "drive:wired.family=canopen"):
        with pytest.raises(UserError, match="a run does not change"):
            settings_of(folder, change)


def test_a_segment_carries_drives_of_two_families_and_a_family_is_on_two_carriers(
    folder: Path,
) -> None:
    """Z and X on one bundle, X with the keys of CANopen; beside them W with the same on CAN."""
    of_w = (folder / "axis-x.lst").read_text(encoding="utf-8")
    of_w = re.sub(r"(log_achs_name\s+)X", r"\1W", re.sub(r"(achs_nr\s+)2", r"\g<1>3", of_w))
    (folder / "axis-w.lst").write_text(of_w, encoding="utf-8")
    begin = RIG.index("[axis.X]")
    of_x = RIG[begin : RIG.index("[plant.z]")]
    both = of_x.replace('segment = "can1"\nnode = 1\n', 'segment = "bundle"\n')
    both += of_x.replace("axis.X", "axis.W").replace("axis-x", "axis-w").replace('"x"', '"w"')
    plant = RIG[RIG.index("[plant.x]") : RIG.index("[plant.probe]")]
    rig = RIG.replace(of_x, both) + plant.replace("plant.x", "plant.w")
    settings = settings_of(folder, rig=rig)
    (folder / "two.nc").write_text("%two\nG01 G90 X2 W-1 Z0.25 F3000\nM30\n", encoding="utf-8")
    machine = Machine(settings, read_program(folder / "two.nc", tuple(settings.rig.axis)))
    try:
        machine.run()
        ends = [machine.links[axis].actual_mm for axis in "ZXW"]
    finally:
        machine.close()
    assert len(machine.installed) == 2
    assert ends == pytest.approx([0.25, 2.0, -1.0], abs=0.05)
    # A CANopen drive counts 2^20 increments in 10 mm, on a wire too
    per_mm = [machine.links[axis].settings.increments_per_mm for axis in "ZXW"]
    assert per_mm == [INCREMENTS_PER_MM, 2**20 / 10, 2**20 / 10]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("fault:drop=Z.TPDO1 at=1ms", "there are no such faults of segments of the kind wire"),
        (
            "fault:babble=bundle id=0x1 at=1ms",
            "there are no such faults of segments of the kind wire",
        ),
        ("plc:Z.6072=300", "drive wired of axis Z has no objects"),
    ],
)
def test_what_only_canopen_has_is_refused_for_others(folder: Path, change: str, words: str) -> None:
    settings_of(folder, change.replace("Z", "X").replace("bundle", "can1"))
    with pytest.raises(UserError, match=words) as caught:
        settings_of(folder, change)
    assert f"--set {change}" in str(caught.value)  # the place of what was wrong


PLC = f"""
[plc]
period_us = 1000
offset_us = 300
program = "{Path(__file__).parents[2] / "testplans" / "plc" / "probe_timestamp.py"}"
[plc.terminal]
input_1 = "probe"
"""
SENSOR = """
[plc]
"V.E.GAP" = { sensor = "gap", period_ms = 1 }
[plant.gap]
fmu = "AxisRig.Sensors.DistanceSensor"
start = { "workpiece.plane.level_mm" = -2, range_mm = 10, order = 0 }
wire = { z = "z" }
"""
AT_PLC = "set:Z.kenngr.measure.signal=PLC_TIMESTAMP"
MEASURED = [  # changes, um beside the surface, the alarm
    (("fault:probe_late=probe by=2ms at=armed",), -10.0, None),  # v t at 5 mm/s
    ((AT_PLC, "fault:clock_off=terminal by=100us at=motion"), -0.5, None),  # v t
    # Of 10 000 in a mm; after a way up, so that less is counted
    (("fault:encoder_loss=Z increments=300 at=armed",), -30.0, None),
    (("fault:encoder_loss=Z increments=300 at=seen",), 0.0, None),
    (("fault:probe_late=probe by=2ms",), -10.0, None),
    (("fault:probe_late=probe by=2ms at=latched",), 0.0, None),  # the edge is past
    (("fault:probe_stick=probe at=edge for=5ms",), 0.0, None),
    (("fault:probe_stick=probe at=armed",), None, 900101),
    ((AT_PLC, "fault:clock_off=terminal by=100us at=motion for=1ms"), 0.0, None),
    ((AT_PLC, "fault:plc_lost=plc at=motion nth=2"), None, 900402),
]


def without_frames(folder: Path, *changes: str, plc: str = PLC) -> Machine:
    """Build the rig with the drive on the wire alone, and a PLC."""
    begin, end = RIG.index("[axis.X]"), RIG.index("[plant.z]")
    alone = (RIG[:begin] + RIG[end:]).replace("[segment.can1]\n", "") + plc
    program = PROGRAM.replace("X2", "Z0.6").replace("X3 ", "")
    if plc == SENSOR:
        program = program.replace("N40", 'N35 #MSG SYN["gap=%f", V.E.GAP]\nN40')
    (folder / "wire.nc").write_text(program, encoding="utf-8")
    settings = settings_of(folder, *changes, rig=alone)
    return Machine(settings, read_program(folder / "wire.nc", ("Z",)))


@pytest.mark.long(but=3)
@pytest.mark.parametrize(("changes", "off_um", "alarm"), MEASURED)
def test_faults_beside_the_frames_need_no_frames(
    folder: Path, changes: tuple[str, ...], off_um: float | None, alarm: int | None
) -> None:
    """No segment of this rig has any: moments come from channel, drive and plant."""
    machine = without_frames(folder, *changes)
    try:
        machine.run()
    finally:
        machine.close()
    assert [known.id for known in machine.channel.alarms] == ([] if alarm is None else [alarm])
    assert machine.faults[0].begin_ns is not None
    if off_um is not None:
        line = machine.messages[0].shown
        expected_mm = SURFACE_MM + off_um * 1e-3
        tolerance_mm = 2.0 / INCREMENTS_PER_MM
        assert float(line.partition("=")[2]) == pytest.approx(expected_mm, abs=tolerance_mm)


@pytest.mark.long
def test_faults_of_sensors_need_no_frames(folder: Path) -> None:
    """In 0.1 um; without the fault it is the way to the surface of its plane, 1.5 to 2.6 mm."""
    machine = without_frames(folder, "fault:sensor_full=gap um=4321 at=motion nth=2", plc=SENSOR)
    try:
        machine.run()
    finally:
        machine.close()
    assert float(machine.messages[1].shown.partition("=")[2]) == 43_210.0


@pytest.mark.parametrize(
    "command",
    [
        "#DRIVE WR SYN [AX=Z KEY=A VAL=1]",
        "#IDENT WR SYN [AX=Z ID=S-0-0092 TYP=2 DEC=0 VAL=1]",
    ],
)
def test_a_drive_command_for_it_is_an_alarm(folder: Path, command: str) -> None:
    """NC program: the drive has no such function."""
    (folder / "own.nc").write_text(f"%own\n{command}\nM30\n", encoding="utf-8")
    settings = settings_of(folder)
    machine = Machine(settings, read_program(folder / "own.nc", tuple(settings.rig.axis)))
    try:
        machine.run()
    finally:
        machine.close()
    assert [alarm.id for alarm in machine.channel.alarms] == [900110]


def test_a_drive_without_a_family_has_that_of_its_lists(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P-AXIS-00020 of the axes that it moves; a list of another family is refused."""
    virtual = dataclasses.replace(DRIVE_TYPES[16], family="wire")
    monkeypatch.setitem(cast("dict[int, DriveType]", DRIVE_TYPES), 16, virtual)
    with (folder / "axis-z.lst").open("a") as file:
        file.write("kenngr.antr_typ 16\n")
    rig = RIG.replace('family = "wire"\n', "")
    assert settings_of(folder, rig=rig).rig.drive["wired"].family_name == "wire"
    given = RIG.replace('family = "wire"', 'family = "canopen"')
    on_can = given.replace('segment = "bundle"', 'segment = "can1"\nnode = 4', 1)
    with pytest.raises(UserError, match=r"of the type virtual .* is of the family canopen"):
        settings_of(folder, rig=on_can)


@pytest.mark.long
def test_no_module_of_the_product_names_it() -> None:
    """A new family is its folders and a row of the registry."""
    for module, tree in trees().items():
        assert not [name for _, name in imported_names(tree) if "wire" in name.split(".")], module
