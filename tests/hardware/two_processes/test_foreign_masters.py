"""Masters of somebody else lead the drives of a process of its own."""

import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

import can
import pytest
from both_sides import LIMIT_S, RIG, ROOT, axisrig, drives_at, serving

pytestmark = pytest.mark.long

STRANGER = '''
    """A master as somebody writes it who has canopen and a manual."""
    import struct, sys, time
    import can, canopen

    eds, host, port = sys.argv[1:]
    network = canopen.Network(
        can.Bus(interface="socketcand", host=host, port=int(port), channel="can0", tcp_tune=True)
    )
    network.connect()
    node = network.add_node(3, eds)
    node.sdo.RESPONSE_TIMEOUT = 10.0
    node.nmt.state = "PRE-OPERATIONAL"
    assert node.sdo[0x1000].raw & 0xFFFF == 402
    try:
        node.sdo[0x6060].raw = 100
    except canopen.SdoAbortedError as abort:
        print("abort", hex(abort.code))
    node.sdo[0x6060].raw = 8
    node.sdo[0x60B8].raw = 0
    node.tpdo.read(); node.rpdo.read()
    node.tpdo[1].clear()
    node.tpdo[1].add_variable(0x6041); node.tpdo[1].add_variable(0x6064)
    node.tpdo[1].trans_type = 1; node.tpdo[1].enabled = True; node.tpdo[1].save()
    node.rpdo[1].clear()
    node.rpdo[1].add_variable(0x6040); node.rpdo[1].add_variable(0x607A)
    node.rpdo[1].trans_type = 1; node.rpdo[1].enabled = True; node.rpdo[1].save()
    node.nmt.state = "OPERATIONAL"
    got = []
    network.subscribe(0x183, lambda _id, data, _t: got.append(struct.unpack("<Hi", data[:6])))

    def cycle(controlword, target):
        seen = len(got)
        network.send_message(0x203, struct.pack("<Hi", controlword, target))
        network.sync.transmit()
        end = time.monotonic() + 10.0
        while len(got) == seen and time.monotonic() < end:
            time.sleep(0.0005)
        return got[-1]

    status, here = cycle(0x80, 0)
    for word, want in ((0x06, 0x21), (0x07, 0x23), (0x0F, 0x27)):
        for _ in range(50):
            status, here = cycle(word, here)
            if status & 0x6F == want:
                break
        print("state", hex(status & 0x6F))
    start = here
    for k in range(1, 301):
        status, here = cycle(0x0F, start - round(k * 100))
    for _ in range(300):
        status, here = cycle(0x0F, start - 30000)
    print("moved", here - start)
    cycle(0x00, here)
    network.disconnect()
'''


def test_a_stranger_with_canopen_leads_a_drive(tmp_path: Path) -> None:
    eds, script = tmp_path / "drive.eds", tmp_path / "stranger.py"
    script.write_text(textwrap.dedent(STRANGER))
    made = axisrig("drive", str(RIG), "--eds", str(eds))
    assert made.returncode == 0, made.stderr
    with drives_at(
        tmp_path / "drives", "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0", "--by-sync"
    ) as drives:
        host, port = serving(drives)
        done = subprocess.run(
            [sys.executable, str(script), str(eds), host, port],
            capture_output=True, text=True, timeout=LIMIT_S, check=False,
        )  # fmt: skip
        drives.stop()
    assert done.returncode == 0, done.stderr
    states = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("state")]
    assert states == ["0x21", "0x23", "0x27"]
    assert "abort 0x6090030" in done.stdout
    moved = int(done.stdout.split("moved ")[1].split()[0])
    assert abs(moved + 30_000) < 100  # increments, 1 um
    text = "".join(drives.lines)
    assert "SDO     abort of 0x6060:00 with 0x06090030, value is not allowed" in text
    assert "OPERATION_ENABLED -> SWITCH_ON_DISABLED" in text


def test_the_master_that_the_page_prints(tmp_path: Path) -> None:
    """It runs as it stands there, but for the port, which is a free one here."""
    page = (ROOT / "docs" / "hardware.md").read_text(encoding="utf-8")
    script = page.partition("```python\n")[2].partition("```")[0]
    made = axisrig("drive", str(RIG), "--eds", str(tmp_path / "drive.eds"))
    assert made.returncode == 0, made.stderr
    with drives_at(
        tmp_path / "drives", "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0"
    ) as drives:
        _, port = serving(drives)
        assert script.count("29536") == 1
        (tmp_path / "master.py").write_text(script.replace("29536", port), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "master.py"],
            cwd=tmp_path, capture_output=True, text=True, timeout=LIMIT_S, check=False,
        )  # fmt: skip
        drives.stop()
    assert done.returncode == 0, done.stderr
    (latch,) = drives.latches()
    assert done.stdout == f"contact at {float(latch['latched_mm']):.4f} mm\n"
    # 4 us of delay in the input, at the 100 mm/s of 6081 at most
    assert abs(float(latch["latched_mm"]) - float(latch["contact_mm"])) < 0.0005
    assert abs(float(latch["contact_mm"]) - 100.0) < 1e-6
    assert "OPERATION_ENABLED -> READY_TO_SWITCH_ON" in "".join(drives.lines)


def test_the_master_that_the_readme_prints(tmp_path: Path) -> None:
    """Its first lines, with the project of `axisrig new`: name of the drive, place of the axis."""
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    script = page.partition("```python\n")[2].partition("```")[0]
    assert axisrig("new", str(tmp_path / "bench")).returncode == 0
    rig = tmp_path / "bench" / "testplans" / "rigs" / "bench.toml"
    assert f"axisrig drive {rig.relative_to(tmp_path / 'bench').as_posix()} --interface" in page
    made = axisrig("drive", str(rig), "--eds", str(tmp_path / "drive.eds"))
    assert made.returncode == 0, made.stderr
    at = "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0"
    with drives_at(tmp_path / "drives", *at, rig=rig) as drives:
        _, port = serving(drives)
        assert script.count("29536") == 1
        (tmp_path / "master.py").write_text(script.replace("29536", port), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "master.py"],
            cwd=tmp_path, capture_output=True, text=True, timeout=LIMIT_S, check=False,
        )  # fmt: skip
        drives.stop()
    assert done.returncode == 0, done.stderr
    assert done.stdout == "axisrig DS402 drive is at 130.0 mm\n"


def _sdo(device: str, *requests: str) -> list[str]:
    """Ask node 3 over a serial line; return its answers as hexadecimal text."""
    answers = []
    options = {"bitrate": 1_000_000, "sleep_after_open": 0, "timeout": 0}
    with can.Bus(interface="slcan", channel=device, **options) as bus:
        for request in requests:
            data = bytes.fromhex(request)
            bus.send(can.Message(arbitration_id=0x603, is_extended_id=False, data=data))
            answer = bus.recv(LIMIT_S)
            while answer is not None and answer.arbitration_id != 0x583:
                answer = bus.recv(LIMIT_S)
            assert answer is not None
            answers.append(bytes(answer.data).hex())
    return answers


def test_drives_keep_what_a_master_stores_and_stay_when_he_goes(
    tmp_path: Path, slcan_pair: tuple[str, str, Any]
) -> None:
    """1017 = 500 ms, stored by 1010; the drives are started again and still have it."""
    left, right, _ = slcan_pair
    quick = ["--interface", "slcan", "--option", "sleep_after_open=0", "--channel", left]
    read, write, save = "4017100000000000", "2b171000f4010000", "2310100173617665"
    store = tmp_path / "drives.json"
    with drives_at(tmp_path / "first", *quick, "--store", str(store)) as drives:
        drives.wait_for("axis Z")
        assert _sdo(right, read) == ["4b17100000000000"]
        assert _sdo(right, write, save) == ["6017100000000000", "6010100100000000"]
        drives.wait_for("parameters written")
        drives.stop()
    with drives_at(tmp_path / "second", *quick, "--store", str(store)) as drives:
        drives.wait_for("axis Z")
        assert _sdo(right, read) == ["4b171000f4010000"]
        drives.stop()
