"""Runs on real hardware: what is refused before anything moves, and what a report says after."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.paced import RealTime
from axisrig.bench.cli.main import main
from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.record.bus import real_time_of
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.real_axes import check_outside, outside_axes, simulated_plants
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.reports.parts.realtime import real_time

TESTPLANS = Path(__file__).parents[2] / "testplans"
Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def axisrig(capsys: pytest.CaptureFixture[str]) -> Call:
    """Return `call(*words) -> (exit code, standard output, standard error)`."""

    def call(*words: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as ended:
            main(words)
        code = ended.value.code
        assert isinstance(code, int)
        return (code, *capsys.readouterr())

    return call


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a rig and a program of its own."""
    shutil.copytree(TESTPLANS / "rigs", tmp_path / "rigs")
    shutil.copytree(TESTPLANS / "programs", tmp_path / "programs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def _plan(place: Path, columns: str = "", cells: str = "") -> str:
    head, row = "case,program,rig,plc:V.E.FEED", "a,programs/probe-z.nc,rigs/probe-z.toml,600"
    (place / "plan.csv").write_text(f"{head}{columns}\n{row}{cells}\n", encoding="utf-8")
    return "plan.csv"


SERIAL = ("--interface", "slcan", "--channel", "/dev/no-such-adapter")


def test_nothing_moves_unless_it_is_told_to(place: Path, axisrig: Call) -> None:
    code, _, err = axisrig("run", _plan(place), *SERIAL, "-o", "out")
    assert code == 2
    assert "axis Z: drive with node 3 on slcan /dev/no-such-adapter" in err
    assert "--yes" in err
    assert "hardware = true" in err
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("key", "found"),
    [
        ("", "104857.6 position units per mm (the lead is NOT compared with the drive)"),
        ("position_unit_um = 0.1", "10000 position units per mm (compared with the drive"),
        ("scaling_check = false", "104857.6 position units per mm (NOT compared with the drive)"),
    ],
)
def test_the_list_of_axes_says_how_far_they_will_go(
    place: Path, axisrig: Call, key: str, found: str
) -> None:
    """1048576 increments on 10 mm are 104857.6 per mm; units of 0.1 um are 10000."""
    name, _, value = key.partition(" = ")
    column = f",drive:servo.{name}" if name else ""
    _, _, err = axisrig("run", _plan(place, column, f",{value}" if name else ""), *SERIAL)
    assert f"encoder 1048576 increments per revolution, lead 10 mm, {found}" in err


def test_a_program_is_asked_for_in_the_same_way(place: Path, axisrig: Call) -> None:
    program, rig = "programs/probe-z.nc", "rigs/probe-z.toml"
    words = ["nc", program, "--rig", rig, "--set", "plc:V.E.FEED=600", *SERIAL]
    code, _, err = axisrig(*words)
    assert code == 2
    assert "axis Z: drive with node 3" in err
    code, _, err = axisrig(*words, "--yes")
    assert code == 2
    assert "slcan /dev/no-such-adapter cannot be opened" in err


@pytest.mark.long
def test_a_rig_of_real_hardware_says_so_itself(place: Path, axisrig: Call) -> None:
    rig = place / "rigs" / "probe-z.toml"
    text = rig.read_text(encoding="utf-8")
    bitrate = "bitrate = 1_000_000"
    real = f'{bitrate}\ninterface = "slcan"\nchannel = "/dev/no-such-adapter"'
    rig.write_text("hardware = true\n" + text.replace(bitrate, real), encoding="utf-8")
    code, _, err = axisrig("run", _plan(place), "-o", "out")
    assert "--yes" not in err
    assert code == 4  # it could not be opened: an error of the bench, no verdict on a drive
    assert "cannot be opened" in (place / "out" / "runs" / "plan-a.json").read_text()


@pytest.mark.parametrize(
    ("column", "cell", "found"),
    [
        ("plant:probe.surface_mm", "90", "probe is not simulated"),
        ("plant:z.kv", "20", "z is not simulated"),
        ("fault:drop", "Z.TPDO2", "faults are simulated"),
    ],
)
def test_what_only_a_simulation_can_do_is_refused(
    place: Path, axisrig: Call, column: str, cell: str, found: str
) -> None:
    code, _, err = axisrig("run", _plan(place, f",{column}", f",{cell}"), *SERIAL, "--yes")
    assert code == 2
    assert found in err
    if column.startswith("plant"):
        assert "plan.csv:2:5" in err


@pytest.mark.parametrize("words", [["-j", "2"], ["--timeout", "60"], ["--isolate"]])
def test_a_bus_is_driven_from_this_process_alone(
    place: Path, axisrig: Call, words: list[str]
) -> None:
    code, _, err = axisrig("run", _plan(place), *SERIAL, "--yes", *words)
    assert code == 2
    assert "one case after the other" in err


def test_a_rig_with_several_segments_needs_the_segment(place: Path, axisrig: Call) -> None:
    rig = place / "rigs" / "probe-z.toml"
    text = rig.read_text(encoding="utf-8")
    rig.write_text(text + "\n[segment.can2]\nbitrate = 500_000\n", encoding="utf-8")
    code, _, err = axisrig("run", _plan(place), *SERIAL, "--yes")
    assert code == 2
    assert "can1, can2" in err
    code, _, err = axisrig("run", _plan(place), *SERIAL, "--yes", "--segment", "can3")
    assert code == 2
    assert "can3" in err


def test_a_drive_outside_needs_a_real_bus(place: Path, axisrig: Call) -> None:
    rig = place / "rigs" / "probe-z.toml"
    text = rig.read_text(encoding="utf-8").replace("node = 3", "node = 3\noutside = true")
    rig.write_text(text, encoding="utf-8")
    code, _, err = axisrig("check", "rigs/probe-z.toml")
    assert code == 2
    assert "axis Z cannot have a real drive: segment can1 is simulated" in err


def test_drives_need_a_real_bus_too(place: Path, axisrig: Call) -> None:
    code, _, err = axisrig("drive", "rigs/probe-z.toml")
    assert code == 2
    assert "segment can1 is simulated" in err
    code, _, err = axisrig("drive", "rigs/probe-z.toml", *SERIAL, "--axis", "Q")
    assert code == 2
    assert "allowed: Z" in err
    code, _, err = axisrig("drive", "rigs/probe-z.toml", *SERIAL)
    assert code == 2
    assert "cannot be opened" in err


def test_the_eds_of_a_drive_can_be_had_without_a_bus(place: Path, axisrig: Call) -> None:
    code, out, err = axisrig("drive", "rigs/probe-z.toml", "--eds", "drive.eds")
    assert (code, out.strip()) == (0, "drive.eds")
    assert "the drive of axis Z (servo, profile generic)" in err
    text = (place / "drive.eds").read_text(encoding="ascii")
    assert "FileName=drive.eds" in text
    assert "[60B8]" in text


@pytest.mark.long
def test_a_replay_does_not_drive_hardware(place: Path, axisrig: Call) -> None:
    axisrig("run", _plan(place), *SERIAL, "--yes", "-o", "out")
    code, out, err = axisrig("replay", "out", "plan-a")
    assert code != 0
    assert "the rig has a real interface" in out + err


def test_one_axis_can_stand_outside_and_the_others_here() -> None:
    rig, files = read_rig(TESTPLANS / "rigs" / "probe-xyz.toml")
    settings = read_settings(rig, files, [])
    names = list(rig.axis)
    segment = settings.segment[rig.axis["X"].segment]
    real = segment.model_copy(update={"interface": "virtual", "channel": "t"})
    settings.segment[rig.axis["X"].segment] = real
    away = {name for name in names if rig.axis[name].segment == rig.axis["X"].segment}
    assert outside_axes(settings) == away
    plants = simulated_plants(settings)
    for name in names:
        assert (rig.axis[name].plant in plants) is (name not in away)
    # A probe that reads an axis outside cannot be simulated, and Y is wired to it
    assert "probe" not in plants
    with pytest.raises(UserError, match="axis Y: probe reads an axis outside") as caught:
        check_outside(settings)
    assert caught.value.file is not None
    assert caught.value.line is not None


def test_no_sensor_of_an_axis_here_reads_an_axis_outside() -> None:
    """Each by itself: probe, second encoder; the message has the place of its key."""
    rig, files = read_rig(TESTPLANS / "rigs" / "probe-xyz.toml")
    for key in ("probe_1", "probe_2", "encoder_2"):
        axes = {name: axis.model_copy(update={"probe_1": None, "probe_2": None})
                for name, axis in rig.axis.items()}  # fmt: skip
        settings = read_settings(rig.model_copy(update={"axis": axes}), files, [])
        segment = rig.axis["X"].segment
        real = settings.segment[segment].model_copy(update={"interface": "virtual", "channel": "t"})
        settings.segment[segment] = real
        check_outside(settings)
        here = next(name for name in axes if name not in outside_axes(settings))
        axes[here] = axes[here].model_copy(update={key: "probe"})
        settings = read_settings(rig.model_copy(update={"axis": axes}), files, [])
        settings.segment[segment] = real
        with pytest.raises(UserError, match=f"axis {here}: probe reads an axis outside") as caught:
            check_outside(settings)
        assert (caught.value.value, caught.value.file is None) == ("probe", False)


def test_the_report_says_in_words_what_was_late() -> None:
    deadlines = Deadlines(late_ns=100_000)
    for k in range(1000):
        deadlines.sync_sent(k * 1_000_000, k * 1_000_000 + (250_000 if k == 500 else 20_000))
    deadlines.slipped(3_000_000)
    deadlines.waited(12_000_000)
    section = real_time(real_time_of(deadlines, 1_000_000))
    assert section is not None
    rows = dict(section["rows"])
    assert rows["SYNCs sent"] == "1000"
    assert rows["later than 100 µs"] == "1 (0.10 %)"
    assert rows["lateness: median"] == "20 µs"
    assert rows["lateness: largest"] == "250 µs"
    assert rows["SYNC interval, asked for 1000 µs"] == "770 µs to 1230 µs"
    counts = {row["range"]: row["count"] for row in section["histogram"]}
    assert counts["20 µs to 50 µs"] == "999"
    assert counts["200 µs to 500 µs"] == "1"
    shares = {row["range"]: row["share"] for row in section["histogram"]}
    assert (shares["20 µs to 50 µs"], shares["200 µs to 500 µs"]) == ("99.90", "0.10")
    words = " ".join(section["words"])
    assert "does not move a latch" in words
    assert "3.0 ms" in words
    assert "12.0 ms" in words
    assert real_time(None) is None


def test_each_real_segment_waits_for_the_answers_of_its_own_drives(place: Path) -> None:
    """X, Y and Z are nodes 1, 2 and 3, each on a bus of its own."""
    rig = place / "rigs" / "own.toml"
    buses = [
        f'[segment.{bus}]\ninterface = "virtual"\nchannel = "own-{bus}"\n'
        for bus in ("can1", "can2", "can3")
    ]
    text = 'base = "probe-xyz.toml"\nhardware = true\n' + "".join(buses)
    rig.write_text(text, encoding="utf-8")
    settings = read_settings(*read_rig(rig), [])
    (place / "own.nc").write_text("%own\nN10 M30\n", encoding="utf-8")
    hardware = Hardware(RealTime(lambda: 0, lambda _seconds: None))
    program = read_program(place / "own.nc", tuple("XYZ"))
    machine = Machine(settings, program, hardware=hardware)
    try:
        can: Any = machine.installed[0]
        real = {name: s for name, s in can.segments.items() if isinstance(s, OutsideSegment)}
        nodes = {name: {cob & 0x7F for cob in s._expected} for name, s in real.items()}
        assert nodes == {"can1": {1}, "can2": {2}, "can3": {3}}
        # TPDO1 and TPDO2 come with every SYNC, on the bus of their drive alone
        assert {0x181, 0x281} <= real["can1"]._expected
    finally:
        machine.close()
