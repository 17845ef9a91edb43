"""What both processes do when one of them, or the line, goes away."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from both_sides import LIMIT_S, PLAN, ROOT, drives_at, rows, socketcand

pytestmark = pytest.mark.long


def test_ctrl_c_brakes_powers_down_and_keeps_the_results(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with drives_at(
        tmp_path / "drives", "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0", "--by-sync"
    ) as drives:
        words = ["run", str(PLAN), "-k", "f60", "-o", str(out), "--yes", *socketcand(drives)]
        kernel = subprocess.Popen(
            [sys.executable, "-m", "axisrig.bench.cli", *words],
            cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        drives.wait_for("-> OPERATION_ENABLED")
        kernel.terminate()
        _, err = kernel.communicate(timeout=LIMIT_S)
        drives.stop()
    assert kernel.returncode == 4, err
    (case,) = rows(out, "cases.csv")
    assert case["verdict"] == "aborted"
    assert case["alarms"] == "900070"
    assert (out / "traces" / "latch_accuracy-f60.parquet").exists()
    text = "".join(drives.lines)
    assert "OPERATION_ENABLED -> READY_TO_SWITCH_ON" in text
    assert "enter pre-operational, node 3" in text


def test_a_cable_pulled_in_motion(tmp_path: Path, slcan_pair: tuple[str, str, Any]) -> None:
    """Both adapters go away: the kernel ends with an alarm, the drives stay and say so."""
    left, right, pair = slcan_pair
    quick = ["--interface", "slcan", "--option", "sleep_after_open=0"]
    out = tmp_path / "out"
    with drives_at(tmp_path / "drives", *quick, "--channel", left, "--by-sync") as drives:
        drives.wait_for("axis Z")
        words = ["run", str(PLAN), "-k", "f60", "-o", str(out), "--yes", *quick]
        kernel = subprocess.Popen(
            [sys.executable, "-m", "axisrig.bench.cli", *words, "--channel", right],
            cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        drives.wait_for("-> OPERATION_ENABLED")
        pair.kill()
        kernel.communicate(timeout=LIMIT_S)
        assert kernel.returncode == 1
        drives.wait_for("can1 is lost")
        drives.stop()
    (case,) = rows(out, "cases.csv")
    assert case["alarms"].split()[0] == "900071"


def test_a_server_that_dies_is_one_line_for_the_operator(tmp_path: Path) -> None:
    """python-can logs and raises a traceback when a socketcand server has gone."""
    with drives_at(
        tmp_path / "drives", "--interface", "axisrig_tcp", "--channel", "127.0.0.1:0", "--by-sync"
    ) as drives:
        words = ["run", str(PLAN), "-k", "f60", "-o", str(tmp_path / "out"), "--yes"]
        kernel = subprocess.Popen(
            [sys.executable, "-m", "axisrig.bench.cli", *words, *socketcand(drives)],
            cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        drives.wait_for("-> OPERATION_ENABLED")
        drives.process.kill()
        said = "".join(kernel.communicate(timeout=LIMIT_S))
    assert kernel.returncode == 1
    assert "Traceback" not in said
    (case,) = rows(tmp_path / "out", "cases.csv")
    # The telegrams may stay out before the operating system says that the other end has gone
    assert case["alarms"].split()[0] in ("900071", "900006")
