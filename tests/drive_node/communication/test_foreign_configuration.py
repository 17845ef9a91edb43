"""lely's `dcfgen` reads our EDS and makes a boot-up configuration of it; the drive takes it.

The concise DCF is a count, then index, sub-index, length and data of each write.
"""

import os
import struct
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from typing import Any

import pytest

from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

Make = Callable[..., Any]

MASTER = """
options: {dcf_path: "."}
master: {node_id: 1, sync_period: 2000, heartbeat_producer: 100}
z:
  dcf: "drive.eds"
  node_id: 3
  heartbeat_producer: 50
  heartbeat_consumer: true
  error_behavior: {1: 0x02}
  rpdo:
    1:
      enabled: true
      transmission: 0x01
      mapping: [{index: 0x6040, sub_index: 0}, {index: 0x60FF, sub_index: 0}]
  tpdo:
    1:
      enabled: true
      transmission: 0x01
      mapping:
      - {index: 0x6041, sub_index: 0}
      - {index: 0x606C, sub_index: 0}
      - {index: 0x1001, sub_index: 0}
    2:
      enabled: false
  sdo:
  - {index: 0x1006, sub_index: 0, value: 2000}
  - {index: 0x6060, sub_index: 0, value: 9}
"""


@pytest.fixture(scope="module")
def writes(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[int, int, bytes]]:
    """What `dcfgen` wants to be written to node 3."""
    if find_spec("dcfgen") is None:
        pytest.skip("dcf-tools is not installed (pip install dcf-tools)")
    folder = tmp_path_factory.mktemp("dcfgen")
    (folder / "drive.eds").write_text(eds_text(DriveProfile()), encoding="ascii", newline="\r\n")
    (folder / "master.yml").write_text(MASTER, encoding="utf-8")
    run = "import sys; from dcfgen.cli import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", run, "-r", "master.yml"],
        cwd=folder,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return list(entries((folder / "z.bin").read_bytes()))


def entries(data: bytes) -> Iterator[tuple[int, int, bytes]]:
    (count,) = struct.unpack_from("<I", data)
    offset = 4
    for _ in range(count):
        index, sub, size = struct.unpack_from("<HBI", data, offset)
        yield index, sub, data[offset + 7 : offset + 7 + size]
        offset += 7 + size
    assert offset == len(data)


def test_the_drive_takes_it_and_runs_with_it(
    drive_bench: Make, writes: list[tuple[int, int, bytes]]
) -> None:
    """Mapping, SYNC, heartbeats, error behaviour; then the master falls silent."""
    bench = drive_bench()
    assert len(writes) > 12
    for index, sub, data in writes:
        bench.remote.sdo.download(index, sub, data)  # raises at an abort
    bench.operational(bench.scheduler.now_ns / 1e6 + 1)
    begin_ms = int(bench.scheduler.now_ns / 1e6) + 1
    for cycle, controlword in enumerate((6, 7, 15, 15, 15)):
        bench.master.send_message(0x701, b"\x05")
        bench.master.send_message(0x203, struct.pack("<Hi", controlword, 1000))
        bench.sync_at_ms(begin_ms + 2 * cycle)
    found = [struct.unpack("<HiB", data) for data in bench.frames(0x183)]
    assert [word & 0x6F for word, _, _ in found] == [0x21, 0x23, 0x27, 0x27, 0x27]
    assert [register for *_, register in found] == [0] * 5
    assert bench.frames(0x283) == []
    assert bench.remote.sdo[0x6061].raw == 9
    bench.run_to_ms(begin_ms + 2000)
    assert bench.node.nmt_state is NmtState.STOPPED
    assert b"\x04" in bench.frames(0x703)
