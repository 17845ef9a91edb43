"""Readers of other makers and what we export: an MF4 of a run, an ASC log of a bus.

Skipped where a reader is not installed (pip install mdfreader; can-utils has asc2log).
"""

import re
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from axisrig.bench.bus.can.logs import open_log
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler
from axisrig.results.export import export

pytestmark = pytest.mark.long
CANDUMP = re.compile(r"\((\d+\.\d+)\)\s+(\S+)\s+([0-9A-F]+)#([0-9A-F]*)")


def test_mdfreader_sees_times_values_and_units(tmp_path: Path) -> None:
    pytest.importorskip("asammdf", reason="the extra `mdf` is not installed")
    mdfreader = pytest.importorskip("mdfreader", reason="pip install mdfreader")
    columns = {"Z.set_mm": [0.5, 0.25, -1e-9], "Z.edge": [True, False, True], "Z.count": [3, 2, -1]}
    table = pd.DataFrame({"time_ns": [0, 1_000_000, 2_500_000], **columns})
    table.attrs.update(units={"time_ns": "ns", "Z.set_mm": "mm"}, rig="r.toml")
    results: Any = SimpleNamespace(traces=lambda: {"r": None}, signals=lambda _: table)
    (path,) = export(results, (), tmp_path, "mf4")
    read = mdfreader.Mdf(str(path))
    for name, values in columns.items():
        assert np.array_equal(read.get_channel_data(name), np.array(values))
        assert np.array_equal(
            read.get_channel_data(read.get_channel_master(name)), [0.0, 0.001, 0.0025]
        )
        assert read.get_channel_unit(name).strip() == ("mm" if name == "Z.set_mm" else "")


def test_asc2log_sees_the_frames_of_an_asc_log(tmp_path: Path) -> None:
    """Standard and extended identifiers, each length; times to the microsecond that ASC has."""
    asc2log = shutil.which("asc2log")
    if asc2log is None:
        pytest.skip("asc2log is not installed (can-utils)")
    path, seen = tmp_path / "bus.asc", list[tuple[int, int, bytes]]()
    with Segment("can1", 1_000_000, Scheduler()) as segment:
        log = open_log(path, [segment.name])
        segment.observe(log)
        segment.observe(
            lambda time_ns, _, frame, __: seen.append((time_ns, frame.arbitration_id, frame.data))
        )
        port = segment.port("sender")
        segment.port("listener")
        for number in range(20):
            can_id = 0x100 + number if number % 2 else 0x10000 + number
            port.send_raw(can_id, bytes(number % 9))
            segment.scheduler.run_until(segment.now_ns + MS + 333_333)
        log.stop()
    out = tmp_path / "bus.log"
    subprocess.run([asc2log, "-I", str(path), "-O", str(out)], check=True, timeout=60)
    found = [CANDUMP.match(line.strip()) for line in out.read_text().splitlines() if line.strip()]
    read = [(float(m[1]), int(m[3], 16), bytes.fromhex(m[4])) for m in found if m is not None]
    assert [each[1:] for each in read] == [each[1:] for each in seen]
    for (at_s, *_), (at_ns, *_) in zip(read, seen, strict=True):
        assert at_s - read[0][0] == pytest.approx((at_ns - seen[0][0]) / 1e9, abs=2e-6)
