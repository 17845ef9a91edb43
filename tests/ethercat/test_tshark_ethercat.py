"""tshark reads the frames as we wrote them: none malformed, each datagram with its values.

It shows no fields of emergencies and mailbox errors; `test_slave_mailbox.py` has their bytes.
"""

import hashlib
import shutil
import struct
import subprocess
from pathlib import Path

import pytest
from tests.ethercat.line import OP, SAFEOP, Line, physical
from typer.testing import CliRunner

from axisrig.bench.bus.ethercat.frame import datagrams, working_counter
from axisrig.bench.bus.ethercat.frame_hash import FrameHash
from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.bench.bus.journal import Journal
from axisrig.bench.cli.main import app
from axisrig.kernel.time.clock import MS, US

TSHARK = shutil.which("tshark")
FIELDS = (
    "frame.time_epoch", "ecatf.length", "ecat.cmd", "ecat.idx", "ecat.adp", "ecat.ado", "ecat.lad",
    "ecat.cnt", "_ws.malformed",
)  # fmt: skip
MAIL = ("ecat_mailbox.type", "ecat_mailbox.coe.type", "ecat_mailbox.coe.sdoidx",
        "ecat_mailbox.coe.sdosub", "ecat_mailbox.coe.abortcode")  # fmt: skip


def tshark(path: Path, fields: tuple[str, ...], condition: str = "") -> list[dict[str, str]]:
    assert TSHARK is not None
    command = [TSHARK, "-r", str(path), "-T", "fields", "-E", "occurrence=a", "-E", "aggregator=;"]
    for field in fields:
        command += ["-e", field]
    if condition:
        command += ["-Y", condition]
    got = subprocess.run(command, capture_output=True, text=True, check=True)
    return [dict(zip(fields, row.split("\t"), strict=True)) for row in got.stdout.splitlines()]


def traffic(line: Line, cycles: int) -> None:
    """Start-up with mailbox and registers, then cycles as a control has them."""
    line.preop()
    for index in (0x1000, 0x1018, 0x6041, 0x2000):
        line.coe(struct.pack("<BHB4x", 0x40, index, 0))
    line.sdo_write(0x6065, 0, 1000, 4)
    line.coe(struct.pack("<BBHH", 3, 0, 0, 0x607D), service=8)
    line.map_image()
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.write(0x0010, 0x1001, 2)
    for n in range(cycles):
        sent = struct.pack("<HiH", 0x06, n, 0) + bytes(16)
        line.exchange((12, 0, sent), physical(14, 0x1001, 0x0910, 8), physical(7, 0, 0x0130, 2))
        if n == 1:
            line.write(0x0120, OP, 2)
        line.wait(MS - 100 * US)


def recorded(path: Path, cycles: int) -> tuple[list[tuple[int, bytes]], str]:
    """Frames of a line, in a file too, and their hash."""
    line = Line()
    journal = line.segment._journal = Journal()
    found = FrameHash(journal)
    with PcapngFile(path, ["ecat"]) as file:
        journal.add(file.take)
        traffic(line, cycles)
        digest = found.hexdigest()
    assert found.frames == len(line.back)
    return line.back, digest


@pytest.mark.skipif(TSHARK is None, reason="tshark is not installed (Debian package tshark)")
@pytest.mark.parametrize("cycles", [200, pytest.param(100_000, marks=pytest.mark.long)])
def test_tshark_reads_what_was_recorded(cycles: int, tmp_path: Path) -> None:
    path = tmp_path / "bus.pcapng"
    frames, _ = recorded(path, cycles)
    rows = tshark(path, FIELDS)
    assert len(rows) == len(frames) >= cycles
    for row, (time_ns, frame) in zip(rows, frames, strict=True):
        assert row["_ws.malformed"] == ""
        seconds, _, rest = row["frame.time_epoch"].partition(".")
        assert int(seconds) * 10**9 + int(rest) == time_ns
        found = list(datagrams(frame))
        assert int(row["ecatf.length"], 16) == sum(12 + d.length for d in found)
        logical = [d for d in found if d.command in (10, 11, 12)]
        others = [d for d in found if d.command not in (10, 11, 12)]
        assert numbers(row["ecat.cmd"]) == [d.command for d in found]
        assert numbers(row["ecat.cnt"], 10) == [working_counter(frame, d) for d in found]
        assert numbers(row["ecat.lad"]) == [d.address for d in logical]
        assert numbers(row["ecat.adp"]) == [d.address & 0xFFFF for d in others]
        assert numbers(row["ecat.ado"]) == [d.address >> 16 for d in others]


def numbers(text: str, base: int = 16) -> list[int]:
    return [int(part, base) for part in text.split(";") if part]


@pytest.mark.long
@pytest.mark.skipif(TSHARK is None, reason="tshark is not installed (Debian package tshark)")
def test_tshark_reads_the_mailbox(tmp_path: Path) -> None:
    path = tmp_path / "bus.pcapng"
    recorded(path, 5)
    rows = tshark(path, MAIL, "ecat_mailbox.coe")
    said = [(row["ecat_mailbox.coe.sdoidx"], row["ecat_mailbox.coe.sdosub"]) for row in rows]
    for index in ("0x1000", "0x1018", "0x6041", "0x2000", "0x6065"):
        # A request and its answer; of an abort tshark shows the code without an index
        assert sum(word.lower() == index for word, _ in said) == 1 + (index != "0x2000"), index
    aborts = [row["ecat_mailbox.coe.abortcode"] for row in rows]
    assert [int(code, 16) for code in aborts if code] == [0x06020000]


def test_the_hash_is_that_of_its_definition_and_the_same_each_time(tmp_path: Path) -> None:
    frames, digest = recorded(tmp_path / "a.pcapng", 20)
    expected = hashlib.sha256()
    for time_ns, frame in frames:
        expected.update(struct.pack("<qB4sH", time_ns, 4, b"ecat", len(frame)) + frame)
    assert digest == expected.hexdigest()
    assert recorded(tmp_path / "b.pcapng", 20)[1] == digest
    assert (tmp_path / "a.pcapng").read_bytes() == (tmp_path / "b.pcapng").read_bytes()


@pytest.mark.long
@pytest.mark.skipif(TSHARK is None, reason="tshark is not installed (Debian package tshark)")
def test_a_run_leaves_a_file_of_each_line_that_tshark_reads(tmp_path: Path) -> None:
    program = tmp_path / "way.nc"
    program.write_text("G0 Z120\nM30\n")
    rig = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-ethercat.toml"
    log = tmp_path / "bus.pcap"
    got = CliRunner().invoke(app, ["nc", str(program), "--rig", str(rig), "--bus-log", str(log)])
    assert got.exit_code == 0, got.output
    rows = tshark(tmp_path / "bus@ec1.pcapng", FIELDS)
    assert len(rows) > 300
    assert {row["_ws.malformed"] for row in rows} == {""}
    # FPWR, FRMW, LRW and BRD of one slave in each cycle
    cyclic = [row for row in rows if numbers(row["ecat.cmd"]) == [5, 14, 12, 7]]
    assert len(cyclic) > 200
    assert {row["ecat.cnt"] for row in cyclic} == {"1;1;3;1"}
