"""`axisrig bus` on EtherCAT: frames of a run in words, and files that are none."""

import struct
from pathlib import Path

import pytest

from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, read_settings
from axisrig.bench.tools.bus_log.bus_log import tell_log
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-ethercat.toml"
PROGRAM = "%moves\nN10 G01 G90 Z129.9 F6000\nN20 M30\n"


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Settings]:
    """The file of a short run, and the settings of the run."""
    folder = tmp_path_factory.mktemp("run")
    (folder / "moves.nc").write_text(PROGRAM, encoding="utf-8")
    settings = read_settings(*read_rig(RIG), [])
    program = read_program(folder / "moves.nc", ("Z",))
    machine = Machine(settings, program, bus_logs=[folder / "run.blf"])
    try:
        machine.run()
    finally:
        machine.close()
    return folder / "run@ec1.pcapng", settings


def said(log: tuple[Path, Settings], *only: str, to_ms: float = 1e9) -> list[str]:
    path, settings = log
    return list(tell_log([path], settings, Selection(only, to_ms=to_ms)))


@pytest.mark.long
def test_the_start_up_is_said_by_registers_objects_and_states(log: tuple[Path, Settings]) -> None:
    lines = said(log, "al_control", "al_status")
    asked = [line.split("AL_CONTROL ")[1] for line in lines if "AL_CONTROL" in line]
    assert asked == ["INIT, acknowledges an error", "PREOP", "SAFEOP", "OP"]
    assert "Z.FPRD           WKC 1  AL_STATUS OP" in lines[-1]
    assert any("SDO write 0x6060:0 Modes of operation = 8" in line for line in said(log, "6060"))


@pytest.mark.long
def test_values_of_the_image_are_said_with_their_objects(log: tuple[Path, Settings]) -> None:
    lines = said(log, "Z.inputs")
    assert "Position actual value" in lines[-1]
    assert "(operation enabled)" in lines[-1]
    assert "mm)" in lines[-1]
    assert len(lines) > 10
    assert all("WKC 3  " in line for line in lines[1:])
    (none,) = said(log, "Z.inputs", to_ms=1.0)
    assert none.startswith("no frame for Z.inputs")


@pytest.mark.long
def test_what_each_cycle_has_needs_all(log: tuple[Path, Settings]) -> None:
    path, settings = log
    usual = list(tell_log([path], settings, Selection(("FRMW",), to_ms=20.0)))
    everything = list(tell_log([path], settings, Selection(("FRMW",), to_ms=20.0, is_all=True)))
    assert "no frame for FRMW" in usual[0]
    assert len(everything) > 5


def test_what_is_new_on_one_line_is_not_old_by_another_one(tmp_path: Path) -> None:
    """Slaves of two lines are led to the same state; again nothing is new, until it changes."""

    def frame(status: int) -> bytes:
        datagram = struct.pack("<BBHHHH", 5, 0, 1001, 0x120, 2, 0) + struct.pack("<HH", status, 1)
        head = struct.pack("<H", len(datagram) | 1 << 12)
        return (b"\xff" * 6 + b"\x02" * 6 + b"\x88\xa4" + head + datagram).ljust(60, b"\0")

    both = tmp_path / "run@both.pcapng"
    course = ((1, 0, 2), (2, 1, 2), (3, 0, 2), (4, 1, 2), (5, 1, 4), (6, 0, 4))
    own = [tmp_path / "run@ec1.pcapng", tmp_path / "run@ec2.pcapng"]
    written = [(both, ["ec1", "ec2"]), (own[0], ["ec1"]), (own[1], ["ec2"])]
    for path, names in written:
        file = PcapngFile(path, names)
        for time_ms, line, status in course:
            if f"ec{line + 1}" in names:
                file.add(time_ms * 1_000_000, line % len(names), frame(status))
        file.stop()
    # One file with two interfaces, or a file for each: lines by time
    for paths in ([both], own, own[::-1]):
        found = tell_log(paths, None, Selection())
        lines = [line.split() for line in found if "AL_CONTROL" in line]
        assert [(float(words[0]), words[1]) for words in lines] == [
            (1.0, "ec1"), (2.0, "ec2"), (5.0, "ec2"), (6.0, "ec1"),
        ]  # fmt: skip


def test_a_damaged_file_is_an_error_of_its_user(tmp_path: Path) -> None:
    path = tmp_path / "run@ec1.pcapng"
    path.write_bytes(b"no file of frames")
    with pytest.raises(UserError, match="no pcapng file"):
        list(tell_log([path], None, Selection()))
    file = PcapngFile(path, ["ec1"])
    file.add(5, 0, bytes(60))
    file.stop()
    path.write_bytes(path.read_bytes()[:-3])
    with pytest.raises(UserError, match="a block is cut off"):
        list(tell_log([path], None, Selection()))
