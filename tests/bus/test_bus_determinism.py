"""The same inputs give the same bytes in another process with another hash seed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

RUN = """
import hashlib, random, sys, threading
from pathlib import Path
import can
import canopen
from canopen.objectdictionary import ODVariable, ObjectDictionary, INTEGER32, VISIBLE_STRING
from axisrig.bench.bus.hits import Hits
from axisrig.bench.bus.can.canopen_sim import SimNetwork, SimRemoteNode
from axisrig.bench.bus.can.faults import FrameFault, ErrorAtBit
from axisrig.bench.bus.can.logs import open_log
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

def dictionary():
    od = ObjectDictionary()
    for index, kind, default in ((0x607A, INTEGER32, 1), (0x1008, VISIBLE_STRING, "x" * 40)):
        variable = ODVariable(hex(index), index)
        variable.data_type, variable.default, variable.access_type = kind, default, "rw"
        od.add_object(variable)
    return od

scheduler, digest, numbers = new_scheduler(), FrameHash(), random.Random(7)
logs = [open_log(Path(name), ["x", "y"]) for name in sys.argv[1:]]
for name in ("x", "y"):
    segment = Segment(name, 1_000_000, scheduler)
    segment.observe(digest)
    for log in logs:
        segment.observe(log)
    segment.add_fault(FrameFault(0x181, hits=Hits(numbers=random.Random(1), share=0.2)))
    def destroy(frame, port, attempt):
        return ErrorAtBit(numbers.randint(1, 60)) if numbers.random() < 0.01 else None
    segment.add_fault(destroy)
    master = SimNetwork(segment.port("master")).connect()
    for node_id in (1, 2):
        drive = SimNetwork(segment.port(f"drive {node_id}", "mailbox")).connect()
        drive[node_id] = canopen.LocalNode(node_id, dictionary())
        master[node_id] = SimRemoteNode(node_id, dictionary())
        def answer(can_id, data, timestamp, drive=drive, node_id=node_id):
            for base in (0x280, 0x180):
                drive.send_message(base + node_id, numbers.randbytes(8))
        drive.subscribe(0x80, answer)
    master.sync.start(0.001)
    for node_id in (1, 2):
        assert master[node_id].sdo[0x1008].raw == "x" * 40
        master[node_id].sdo[0x607A].raw = node_id
scheduler.run_until(300 * MS)
for log in logs:
    log.stop()
assert threading.active_count() == 1
print(digest.frames, digest.hexdigest())
for path in sorted(Path(sys.argv[1]).parent.iterdir()):
    if path.suffix == ".asc":  # its head tells the date
        with can.ASCReader(path) as reader:
            content = repr([(m.timestamp, m.channel, m.arbitration_id, m.data) for m in reader])
            content = content.encode()
    else:
        content = path.read_bytes()
    assert len(content) > 10_000
    print(path.name, hashlib.sha256(content).hexdigest())
"""


@pytest.mark.long  # frames of whole runs in another process: tests/machine/test_determinism.py
def test_hash_and_logs_are_the_same_bytes_in_another_process(tmp_path: Path) -> None:
    runs = []
    for seed in ("1", "2"):
        folder = tmp_path / seed
        folder.mkdir()
        logs = [str(folder / f"bus{suffix}") for suffix in (".blf", ".log", ".asc", ".pcap")]
        command = [sys.executable, "-c", RUN, *logs]
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        runs.append(subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment))
    outputs = [run.communicate()[0] for run in runs]
    assert [run.returncode for run in runs] == [0, 0]
    assert outputs[0] == outputs[1]
    assert int(outputs[0].split()[0]) > 2 * 300 * 5
    names = [line.split()[0] for line in outputs[0].splitlines()[1:]]
    assert names == ["bus.asc", "bus.blf", "bus.log", "bus@x.pcap", "bus@y.pcap"]
