"""Plans and programs against drives in a process of their own, over TCP and a serial line."""

import json
import subprocess
import sys
import urllib.request
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from both_sides import (
    INCREMENTS_PER_MM,
    LIMIT_S,
    RIG,
    ROOT,
    Drives,
    axisrig,
    drives_at,
    patient_plan,
    rows,
    socketcand,
)
from tests.live_states import REAL_TIME


def _check_latch_plan(drives: Drives, out: Path, *interface: str) -> None:
    """Run the row f600 against the drives and compare both sides."""
    plan = patient_plan(out.parent)
    done = axisrig("run", str(plan), "-k", "f600", "-o", str(out), "--yes", *interface)
    drives.stop()
    assert done.returncode == 3, done.stdout + done.stderr
    verdicts = {row["metric"]: row["verdict"] for row in rows(out, "results.csv")}
    assert verdicts["msg:N30"] == "pass"
    assert verdicts["alarms"] == "pass"
    assert verdicts["latch_error_um"] == "inconclusive"
    assert verdicts["overtravel_mm"] == "inconclusive"
    (case,) = rows(out, "cases.csv")
    assert case["bus:can1.interface"] == interface[1]
    (latch,) = drives.latches()
    # The surface is at 100 mm. The input delays by 4 us, that is 0.0400 um at 10 mm/s; the plan
    # allows an increment more or less, and both processes together are as exact as one.
    assert abs(float(latch["contact_mm"]) - 100.0) < 1e-6
    error_um = (float(latch["latched_mm"]) - float(latch["contact_mm"])) * 1e3
    assert abs(error_um + 0.0400) <= 0.0095
    assert float(latch["latched_mm"]) == int(latch["units"]) / INCREMENTS_PER_MM
    assert (out / "bus" / "latch_accuracy-f600.blf").stat().st_size > 1000
    assert (drives.folder / "bus.blf").stat().st_size > 1000


@pytest.mark.long
def test_plan_against_drives_over_tcp(tmp_path: Path) -> None:
    with drives_at(
        tmp_path / "drives", "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0", "--by-sync"
    ) as drives:
        _check_latch_plan(drives, tmp_path / "out", *socketcand(drives))
    text = "".join(drives.lines)
    for what in ("NMT     start, node 3", "-> OPERATION_ENABLED", "latch   probe 1, 0x60BA"):
        assert what in text


@pytest.mark.long
def test_plan_against_drives_over_a_serial_line(
    tmp_path: Path, slcan_pair: tuple[str, str, Any]
) -> None:
    left, right, _ = slcan_pair
    quick = ["--interface", "slcan", "--option", "sleep_after_open=0"]
    with drives_at(tmp_path / "drives", *quick, "--channel", left, "--by-sync") as drives:
        drives.wait_for("axis Z")
        # A serial line carries the cycle of 1 ms, in its own time
        _check_latch_plan(drives, tmp_path / "out", *quick, "--channel", right)


@pytest.mark.long
def test_nc_program_against_drives_outside(tmp_path: Path) -> None:
    program, rig = tmp_path / "part.nc", patient_plan(tmp_path).parent / "rigs" / RIG.name
    program.write_text(
        '%p\nN10 G01 Z103 F6000\nN20 G100 Z90 F600\nN30 #MSG["Z=%f", V.A.MESS.Z]\nN40 M30\n'
    )
    with drives_at(
        tmp_path / "drives", "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0", "--by-sync"
    ) as drives:
        done = axisrig("nc", str(program), "--rig", str(rig), "--yes", *socketcand(drives))
        drives.stop()
    assert done.returncode == 0, done.stderr
    (latch,) = drives.latches()
    printed = float(done.stdout.strip().removeprefix("Z="))
    assert abs(printed - float(latch["latched_mm"])) < 1e-5
    assert "these axes will move" in done.stderr
    assert "real time: " in done.stderr


TWO_AXES = f'''
title = "X simulated, Z on a bus of its own"

[realtime]
wait_ms = 1000

[channel]
list = "{(ROOT / "testplans/rigs/lists/channel.lst").as_posix()}"

[segment.can1]
bitrate = 1_000_000

[segment.can2]
bitrate = 1_000_000

[drive.servo]
lead_mm = 10.0
rpdo_timeout_ms = 10000

[axis.X]
list = "{(ROOT / "testplans/rigs/lists/axis-x.lst").as_posix()}"
segment = "can1"
node = 1
drive = "servo"
plant = "x"

[axis.Z]
list = "{(ROOT / "testplans/rigs/lists/axis-z.lst").as_posix()}"
segment = "can2"
node = 3
drive = "servo"
plant = "z"

[plant.x]
fmu = "AxisRig.Drives.ServoAxis"

[plant.z]
fmu = "AxisRig.Drives.ServoAxis"
start = {{ position_start_mm = 5 }}
'''


@pytest.mark.long
def test_one_axis_simulated_and_one_outside_move_together(tmp_path: Path) -> None:
    rig, program, plan = tmp_path / "rig.toml", tmp_path / "part.nc", tmp_path / "plan.csv"
    rig.write_text(TWO_AXES, encoding="utf-8")
    program.write_text("%p\nN10 G01 X3 Z2 F3000\nN20 G01 X1 Z4\nN30 M30\n", encoding="utf-8")
    plan.write_text(
        "case,program,rig,check:velocity_mm_s_max:X,check:velocity_mm_s_max:Z,check:alarms\n"
        "a,part.nc,rig.toml,<= 60,<= 60,none\n",
        encoding="utf-8",
    )
    with drives_at(
        tmp_path / "drives", "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0",
        "--segment", "can2", "--axis", "Z", "--by-sync", rig=rig,
    ) as drives:  # fmt: skip
        interface = [*socketcand(drives), "--segment", "can2"]
        done = axisrig("run", str(plan), "-o", str(tmp_path / "out"), "--yes", *interface)
        drives.stop()
    assert done.returncode == 3, done.stdout + done.stderr
    assert "axis X" not in done.stderr
    verdicts = {row["metric"]: row["verdict"] for row in rows(tmp_path / "out", "results.csv")}
    assert verdicts == {
        "velocity_mm_s_max:X": "pass", "velocity_mm_s_max:Z": "inconclusive", "alarms": "pass"
    }  # fmt: skip
    ours = pq.read_table(tmp_path / "out" / "traces" / "plan-a.parquet")
    theirs = pq.read_table(tmp_path / "drives" / "trace.parquet")
    assert "Z.truth_mm" not in ours.column_names
    assert abs(ours.column("X.truth_mm").to_pylist()[-1] - 1.0) < 0.01
    assert abs(theirs.column("Z.truth_mm").to_pylist()[-1] - 4.0) < 0.01
    assert abs(ours.column("Z.actual_mm").to_pylist()[-1] - 4.0) < 0.01


@pytest.mark.long
def test_a_run_on_real_drives_is_shown_while_it_lasts(tmp_path: Path) -> None:
    plan, out = patient_plan(tmp_path), tmp_path / "out"
    words = ["--interface", "axisrig_tcp", "--channel", "127.0.0.1:0", "--by-sync"]
    with drives_at(tmp_path / "drives", *words) as drives:
        command = [sys.executable, "-m", "axisrig.bench.cli", "run", str(plan), "-k", "f600"]
        command += ["-o", str(out), "--yes", "--live", *socketcand(drives)]
        run = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
        assert run.stderr is not None
        address = next(line.split()[1] for line in run.stderr if line.startswith("live: "))
        with urllib.request.urlopen(f"{address}states", timeout=60) as answer:
            found = [line.partition(b": ")[2] for line in answer if line.startswith(b"data: ")]
        run.communicate(timeout=LIMIT_S)
        drives.stop()
    assert run.returncode == 3
    states = [look["state"] for look in map(json.loads, found) if look["state"]]
    assert len(states) > 5
    last = states[-1]
    assert last["real_time"].keys() == REAL_TIME.keys()
    assert 0 < last["real_time"]["looked_at"] <= 500
    assert [one["is_outside"] for one in (*last["axes"], *last["bus"])] == [True, True]
    assert last["probes"] == []
    assert last["bus"][0]["frames"] > 0
    assert {one["axes"][0]["drive"] for one in states} >= {"operation enabled"}
