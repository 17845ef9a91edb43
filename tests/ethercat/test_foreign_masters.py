"""`axisrig drive --interface ecat` under two masters of somebody else, over veth in a namespace.

SOEM and KickCAT are the wheels `pysoem` and `kickcat` of PyPI: tools of these tests, no
dependencies. AXISRIG_ETHERCAT_PYTHON names an interpreter that has them, else it is this one. Raw
frames stay on a pair of virtual interfaces inside a network namespace that the test makes.
"""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from tests.ethercat.foreign import ROOT, has_namespace, in_namespace, with_drives

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.description import describe
from axisrig.bench.drive.ethercat.objects import described
from axisrig.bench.drive.ethercat.sii import sii_content

RIG = ROOT / "testplans" / "rigs" / "probe-z.toml"
MASTERS = Path(__file__).parent / "masters"
PYTHON = os.environ.get("AXISRIG_ETHERCAT_PYTHON", sys.executable)
PERIOD_US, CYCLES, STEP = 2000, 10_000, -10_000
SKIPPED = (0x1010, 0x1011, 0x6040, 0x6060)
pytestmark = pytest.mark.long


def needs(package: str) -> None:
    if not has_namespace():
        pytest.skip("no network namespaces here (unshare -n, ip, veth)")
    found = subprocess.run([PYTHON, "-c", f"import {package}"], capture_output=True, check=False)
    if found.returncode:
        pytest.skip(f"{package} is missing: pip install {package}, or AXISRIG_ETHERCAT_PYTHON")


@pytest.fixture
def dictionary(tmp_path: Path) -> Path:
    """Each value of the drive: index, sub-index, whether it is to be written."""
    rows = [
        (known.index, sub, row.access == "rw" and known.index not in SKIPPED)
        for known in described(DriveProfile()).values()
        for sub, row in known.rows.items()
    ]
    path = tmp_path / "objects.json"
    path.write_text(json.dumps(rows))
    return path


def run_master(
    script: str, dictionary: Path, tmp_path: Path, rig: Path = RIG
) -> tuple[dict[str, Any], str]:
    """What a master says, and what the drives say."""
    arguments = [str(PERIOD_US), str(CYCLES), str(STEP), "dc", str(dictionary)]
    master = [PYTHON, str(MASTERS / script), "v0", *arguments]
    found, printed = with_drives(rig, tmp_path / "out", master, 150)
    return json.loads(found.stdout.splitlines()[-1]), printed


@pytest.mark.parametrize(("script", "package"), [("soem.py", "pysoem"), ("kick.py", "kickcat")])
def test_a_foreign_master_leads_the_drive(
    script: str, package: str, dictionary: Path, tmp_path: Path
) -> None:
    needs(package)
    said, printed = run_master(script, dictionary, tmp_path)
    print({name: value for name, value in said.items() if name != "eeprom"})
    print(printed)
    expected = json.loads(dictionary.read_text())
    assert (said["slaves"], said["refused"]) == (1, [])
    assert said["read"] == len(expected)
    assert said["written"] == sum(may for *_, may in expected)
    assert (said["image"], said["op"], said["enabled"]) == (24, 8, True)
    if package == "pysoem":
        assert said["identity"] == ["axisrig DS402 drive", 0, 402, 0x10000]
        content = sii_content(describe(DriveProfile(), serial=1))
        assert bytes.fromhex(said["eeprom"]) == content
        assert (said["has_clock"], said["safeop"], said["al"]) == (True, 4, 0)
    # Armed, touched, read; armed anew and touched once more
    with (tmp_path / "out" / "latches.csv").open() as file:
        latches = list(csv.DictReader(file))
    assert [touch[:2] for touch in said["touches"]] == [[0x0001, 0x0003]] * 2
    assert [touch[2] for touch in said["touches"]] == [int(row["units"]) for row in latches]
    assert [touch[3] for touch in said["touches"]] == [0, 0]
    for row in latches:
        # The input delays by 4 us; at most twice the set speed in a cycle that came late
        speed_mm_us = abs(STEP) / float(DriveProfile().units_per_mm) / PERIOD_US
        way_mm = float(row["contact_mm"]) - float(row["latched_mm"])
        assert 0 <= way_mm <= 2 * 4 * speed_mm_us + 2e-5
        assert float(row["contact_mm"]) == pytest.approx(100.0, abs=1e-6)
    assert said["cycles"] >= CYCLES
    if said["wrong"]:
        load = os.getloadavg()[0]
        pytest.skip(f"{said['wrong']} wrong working counters with a load of {load:.1f}")


def test_soem_leads_a_drive_and_a_stamping_terminal_on_one_line(
    dictionary: Path, tmp_path: Path
) -> None:
    """The stamp that it reads of the terminal is that of the edge, in the clock of the line."""
    needs("pysoem")
    rig = ROOT / "testplans" / "rigs" / "plc-timestamp-line.toml"
    said, printed = run_master("soem_terminal.py", dictionary, tmp_path, rig)
    print(said, printed, sep="\n")
    assert said["products"] == [402, 401]
    assert said["states"] == [8, 8]
    assert said["enabled"]
    with (tmp_path / "out" / "events.csv").open() as file:
        events = list(csv.DictReader(file))
    stamps = [row for row in events if (row["axis"], row["kind"]) == ("terminal", "stamp")]
    ups = [row["text"] for row in stamps if "input 1 up" in row["text"]]
    assert len(ups) == 2
    for stamp, text in zip(said["stamps"], ups, strict=True):
        assert f"stamp {stamp} ns" in text
        assert "z at 100.0000" in text or "z at 99.9999" in text
    assert [touch[:2] for touch in said["touches"]] == [[0x0001, 0x0003]] * 2
    if said["wrong"]:
        load = os.getloadavg()[0]
        pytest.skip(f"{said['wrong']} wrong working counters with a load of {load:.1f}")


def test_one_line_says_what_is_wrong_with_an_interface() -> None:
    if not has_namespace():
        pytest.skip("no network namespaces here (unshare -n, ip, veth)")
    drive = [sys.executable, "-m", "axisrig.bench.cli", "drive", str(RIG), "--interface", "ecat"]
    unprivileged = ["setpriv", "--bounding-set", "-all", "--inh-caps", "-all"]
    for words, allowed in (
        (["--channel", "v9"], "there is no such interface; found 'v9'; allowed: lo, v1, v0"),
        (["--channel", "lo"], "the interface has an IP address; found 'lo'"),
        (["--channel", "d0"], "the interface is no virtual one; found 'd0 ("),
        (["--channel", "v1"], "a raw socket needs the right CAP_NET_RAW; found 'v1'"),
    ):
        before = unprivileged if words[1] == "v1" else []
        if words[1] == "d0":
            before = ["sh", "-c", 'ip link add d0 type ifb; exec "$0" "$@"']
        got = subprocess.run(
            in_namespace(*before, *drive, *words, "--for", "0"),
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if words[1] == "d0" and "there is no such interface" in got.stderr:
            continue  # this kernel makes no other interfaces
        assert got.returncode == 2, got.stdout + got.stderr
        progress, error = got.stderr.splitlines()
        assert progress == f"making the drives of {RIG}"
        assert error.startswith(f"error: {allowed}")
