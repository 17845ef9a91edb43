"""tshark reads the bus log of a case, and its CANopen dissector agrees with ours frame by frame.

The case: start-up over SDO, a measurement run, heartbeats, a remote frame, an SDO abort, an
emergency, an error frame. Skipped where there is no tshark (Debian package `tshark`).
"""

import os
import shutil
import subprocess
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

import can
import pytest
from tests.can_parts import can_of

from axisrig.bench.bus.can.dissect import Dissected, dissect
from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS, Phase

TSHARK = shutil.which("tshark")
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
NODE = 3
PROGRAM = "N10 G90 G1 Z132 F3000\nN20 G100 Z126 F600\nN30 G1 Z140 F3000\nN40 M30\n"
RIG = f"""
base = "{(RIGS / "probe-z.toml").as_posix()}"
[cycle]
heartbeat_ms = 50
[drive.servo]
heartbeat_ms = 20
"""
FIELDS = (
    "frame.time_relative", "can.id", "can.flags.err", "can.flags.rtr", "can.len", "canopen.cob_id",
    "canopen.function_code", "canopen.node_id", "canopen.nmt_ctrl.cd", "canopen.nmt_ctrl.node_id",
    "canopen.nmt_guard.state", "canopen.nmt_guard.toggle", "canopen.em.err_code",
    "canopen.em.err_reg", "canopen.sdo.ccs", "canopen.sdo.scs", "canopen.sdo.main_idx",
    "canopen.sdo.sub_idx", "canopen.sdo.abort_code", "canopen.sdo.data.bytes",
    "canopen.sync.counter", "canopen.pdo.data.bytes", "_ws.malformed",
)  # fmt: skip
Row = dict[str, str]
Seen = list[tuple[int, Frame, bool]]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, Seen]:
    """Run the case; give its BLF, its pcap, and what passed over the wire."""
    folder = tmp_path_factory.mktemp("tshark")
    (folder / "part.nc").write_text(PROGRAM)
    (folder / "rig.toml").write_text(RIG)
    rig, files = read_rig(folder / "rig.toml")
    slow = parse_assignment("set:Z.kenngr.measure.edge=POS")
    settings = read_settings(rig, files, [(slow, as_written)])
    logs = [folder / "bus.blf", folder / "bus.pcap"]
    machine = Machine(settings, read_program(folder / "part.nc", ("Z",)), bus_logs=logs)
    (segment,) = can_of(machine).segments.values()
    seen: Seen = []
    segment.observe(lambda time_ns, name, frame, is_error: seen.append((time_ns, frame, is_error)))
    tool = segment.port("tool")
    tool.attach_data(lambda *_: None)

    def at(time_ns: int, action: Callable[[], object]) -> None:
        machine.scheduler.call_at(time_ns, Phase.APPLICATION, action)

    guard = can.Message(
        arbitration_id=0x700 + NODE, is_extended_id=False, is_remote_frame=True, dlc=1
    )
    upload_of_nothing = bytes([0x40, 0x34, 0x12, 0x00, 0, 0, 0, 0])
    long_name = bytes([0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0])
    at(300 * MS + 5_000, lambda: tool.send_raw(0x600 + NODE, upload_of_nothing))
    at(320 * MS + 5_000, lambda: tool.send_raw(0x600 + NODE, long_name))
    for at_ms, command in ((322, 0x60), (324, 0x70), (326, 0x60)):  # 19 letters in segments of 7
        segment_request = bytes([command]) + bytes(7)
        at(at_ms * MS + 5_000, partial(tool.send_raw, 0x600 + NODE, segment_request))
    at(330 * MS + 5_000, lambda: tool.send(guard))
    at(340 * MS + 5_000, lambda: tool.send_raw(0x200 + NODE, b"\x0f"))  # RPDO too short

    def destroy(frame: Frame, _port: object, attempt: int) -> ErrorAtBit | None:
        is_due = 250 * MS <= machine.scheduler.now_ns < 251 * MS and attempt == 0
        return ErrorAtBit(30) if is_due and frame.arbitration_id == 0x180 + NODE else None

    segment.add_fault(destroy)
    try:
        machine.run()
    finally:
        machine.close()
    return logs[0], logs[1], seen


def read_with_tshark(log: Path, folder: Path) -> list[Row]:
    assert TSHARK is not None
    command = [TSHARK, "-r", str(log), "-d", "can.subdissector,canopen", "-T", "fields"]
    command += ["-E", "separator=;", "-E", "occurrence=f"]
    for field in FIELDS:
        command += ["-e", field]
    environment = {**os.environ, "HOME": str(folder), "XDG_CONFIG_HOME": str(folder)}
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=environment, timeout=120
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    return [dict(zip(FIELDS, line.split(";"), strict=True)) for line in lines]


def number(row: Row, field: str) -> int | None:
    return int(row[field], 0) if row[field] else None


def nanoseconds(text: str) -> int:
    seconds, _, fraction = text.partition(".")
    return int(seconds) * 10**9 + int(fraction.ljust(9, "0"))


def agree(row: Row, ours: Dissected, frame: Frame) -> list[str]:
    """Say in what tshark's row and ours differ."""
    fields = ours.fields
    sdo = "canopen.sdo.ccs" if ours.service == "SDO request" else "canopen.sdo.scs"
    base = frame.arbitration_id & 0x780
    pairs: list[tuple[str, object, object]] = [
        ("cob id", number(row, "canopen.cob_id"), frame.arbitration_id),
        ("function", number(row, "canopen.function_code"), base >> 7),
        ("bytes", number(row, "can.len"), frame.dlc),
        ("nmt command", number(row, "canopen.nmt_ctrl.cd"), fields.get("command")),
        ("nmt target", number(row, "canopen.nmt_ctrl.node_id"), fields.get("target")),
        ("state", number(row, "canopen.nmt_guard.state"), fields.get("state")),
        ("emergency", number(row, "canopen.em.err_code"), fields.get("code")),
        ("register", number(row, "canopen.em.err_reg"), fields.get("register")),
        ("sdo", number(row, sdo), fields.get("specifier")),
        ("index", number(row, "canopen.sdo.main_idx"), fields.get("index")),
        ("sub", number(row, "canopen.sdo.sub_idx"), fields.get("sub")),
        ("abort", number(row, "canopen.sdo.abort_code"), fields.get("abort_code")),
        ("malformed", row["_ws.malformed"], ""),
    ]
    if ours.node is not None:
        pairs.append(("node", number(row, "canopen.node_id"), ours.node))
    if "PDO" in ours.service:
        pairs.append(("data", row["canopen.pdo.data.bytes"].replace(":", ""), frame.data.hex()))
    return [f"{what}: {theirs} not {mine}" for what, theirs, mine in pairs if theirs != mine]


@pytest.mark.long
@pytest.mark.skipif(TSHARK is None, reason="tshark is not installed (Debian package tshark)")
@pytest.mark.parametrize("kind", ["blf", "pcap"])
def test_tshark_and_we_agree_on_every_frame(
    case: tuple[Path, Path, Seen], kind: str, tmp_path: Path
) -> None:
    """BLF: tshark 4.0 leaves error frames out. Times of pcap are exact, those of BLF to 1 ns.

    Times count from the first frame: a BLF of simulated time has no date.
    """
    blf, pcap, seen = case
    rows = read_with_tshark(blf if kind == "blf" else pcap, tmp_path)
    expected = [entry for entry in seen if kind == "pcap" or not entry[2]]
    assert len(rows) == len(expected)
    wrong = []
    for index, (row, (time_ns, frame, is_error)) in enumerate(zip(rows, expected, strict=True)):
        late_ns = nanoseconds(row["frame.time_relative"]) - (time_ns - seen[0][0])
        if abs(late_ns) > (kind == "blf"):
            wrong.append(f"{index}: {late_ns} ns late")
        if is_error:
            assert row["can.flags.err"] in ("1", "True")
        elif frame.is_remote_frame:
            assert row["can.flags.rtr"] in ("1", "True")
        else:
            differing = agree(row, dissect(frame), frame)
            wrong += [f"{index} {dissect(frame)}: {text}" for text in differing]
    assert wrong[:20] == []


def test_the_case_holds_what_it_promises(case: tuple[Path, Path, Seen]) -> None:
    """Else the comparison above would prove less than it says."""
    _, _, seen = case
    found = [dissect(frame, is_error=is_error) for _, frame, is_error in seen]
    services = Counter(item.service for item in found)
    assert {
        "NMT", "SYNC", "EMCY", "TPDO1", "TPDO2", "TPDO3", "RPDO1", "SDO request", "SDO answer",
        "heartbeat", "error frame",
    } == set(services)  # fmt: skip
    assert any(item.fields.get("abort_code") == 0x06020000 for item in found)
    assert any(item.fields.get("code") == 0x8210 for item in found)
    assert {0, 5, 127} <= {item.fields.get("state") for item in found}
    assert any(item.fields.get("remote") for item in found)
    assert any(item.fields.get("is_last") for item in found)  # a segmented answer
