"""How fast is the bus: frames through one segment into canopen callbacks, and PDOs through codecs.

Beside ours stand python-can's `virtual` interface with canopen's notifier thread, and canopen's own
codec, timed in turns with ours: their ratio outlives the machine it was measured on.
"""

import json
import random
from collections.abc import Callable
from itertools import count
from queue import SimpleQueue
from typing import Any

import canopen

from bench.bus.canopen_sim import SimNetwork
from bench.bus.segment import Segment
from bench.drive.communication.pdo import Layout
from bench.drive.eds import object_dictionary
from bench.drive.image import ProcessImage
from bench.drive.profile import DriveProfile
from kernel.clock import MS
from kernel.cosim.scheduler import Scheduler
from kernel.drives.mapping import Telegram, telegrams

FRAMES = 5_000  # in one measurement
BATCH = 5  # frames per ms, about as many as one drive and its master send
CODECS = 5_000
NODE, COB_ID = 1, 0x181

Clock = Callable[[], int]
_numbers = count()


def measure_bus(repeats: int, clock_ns: Clock) -> dict[str, Any]:
    """Time segment, `virtual` and codecs in turns; the least of `repeats` measurements counts.

    Returns `segment_frames_s`, `virtual_frames_s`, `segment_ratio`, `codec_frames_s` (packed and
    unpacked again), `pack_us`, `unpack_us`, `canopen_pack_us`, `canopen_unpack_us`, `codec_ratio`.
    """
    runs: dict[str, Callable[[Clock], float]] = {
        "segment": _segment_us,
        "virtual": _virtual_us,
        **_codecs(telegrams(0x60BA)["TPDO1"]),
    }
    least_us = dict.fromkeys(runs, float("inf"))
    for _ in range(repeats):
        for name, run in runs.items():
            least_us[name] = min(least_us[name], run(clock_ns))
    ours_us = least_us["pack"] + least_us["unpack"]
    canopen_us = least_us["canopen_pack"] + least_us["canopen_unpack"]
    return {
        "segment_frames_s": 1e6 / least_us["segment"],
        "virtual_frames_s": 1e6 / least_us["virtual"],
        "segment_ratio": least_us["virtual"] / least_us["segment"],
        "codec_frames_s": 1e6 / ours_us,
        "codec_ratio": canopen_us / ours_us,
        **{f"{name}_us": value for name, value in least_us.items()},
        "repeats": repeats,
    }


def show_bus(result: dict[str, Any], as_json: bool) -> str:
    """Return the result as one JSON object or as a table."""
    if as_json:
        return json.dumps(result)
    return "\n".join(
        [
            f"frames into canopen callbacks, 8 random bytes, one sender, one receiver (best of"
            f" {result['repeats']} times {FRAMES})",
            f"  segment, exact times   {result['segment_frames_s']:>10,.0f} /s",
            f"  python-can virtual     {result['virtual_frames_s']:>10,.0f} /s"
            f"   ratio {result['segment_ratio']:.1f}",
            f"PDO of statusword, position and probe status (best of {result['repeats']} times"
            f" {CODECS})",
            f"  packed and unpacked    {result['codec_frames_s']:>10,.0f} /s",
            f"  pack                   {result['pack_us']:>10.2f} us"
            f"   canopen {result['canopen_pack_us']:.2f}",
            f"  unpack                 {result['unpack_us']:>10.2f} us"
            f"   canopen {result['canopen_unpack_us']:.2f}",
            f"  canopen / ours         {result['codec_ratio']:>10.1f}",
        ]
    )


def _payloads() -> list[bytes]:
    numbers = random.Random(1)
    return [numbers.randbytes(8) for _ in range(FRAMES)]


def _segment_us(clock_ns: Clock) -> float:
    """Time per frame: requested by one network, delivered to a callback of another, in us."""
    scheduler = Scheduler()
    got = [0]

    def take(_can_id: int, _data: bytearray, _timestamp: float) -> None:
        got[0] += 1

    with Segment(f"perf {next(_numbers)}", 1_000_000, scheduler) as segment:
        sender = SimNetwork(segment.port("sender")).connect()
        receiver = SimNetwork(segment.port("receiver")).connect()
        receiver.subscribe(COB_ID, take)
        payloads = _payloads()
        begin = clock_ns()
        for place in range(0, FRAMES, BATCH):
            for data in payloads[place : place + BATCH]:
                sender.send_message(COB_ID, data)
            scheduler.run_until(scheduler.now_ns + MS)
        spent_ns = clock_ns() - begin
    assert got[0] == FRAMES  # 5 frames of at most 135 bits fit into 1 ms
    return spent_ns / FRAMES / 1e3


def _virtual_us(clock_ns: Clock) -> float:
    """The same over python-can's `virtual` bus; a thread of canopen receives."""
    channel = f"perf {next(_numbers)}"
    done: SimpleQueue[None] = SimpleQueue()
    got = [0]

    def take(_can_id: int, _data: bytearray, _timestamp: float) -> None:
        got[0] += 1
        if got[0] == FRAMES:
            done.put(None)

    sender, receiver = canopen.Network(), canopen.Network()
    for network in (sender, receiver):
        network.connect(interface="virtual", channel=channel)
    receiver.subscribe(COB_ID, take)
    try:
        payloads = _payloads()
        begin = clock_ns()
        for data in payloads:
            sender.send_message(COB_ID, data)
        done.get(timeout=60)
        return (clock_ns() - begin) / FRAMES / 1e3
    finally:
        sender.disconnect()
        receiver.disconnect()


def _codecs(telegram: Telegram) -> dict[str, Callable[[Clock], float]]:
    """Our codec as drive and kernel use it, and canopen's own with its variables looked up once."""
    image = ProcessImage()
    fields = ("statusword", "position_actual", "probe_status")  # what TPDO1 carries
    message = Layout(fields, telegram.codec).reader()
    unpack = telegram.codec.unpack
    data = message(image)
    node = canopen.RemoteNode(NODE, object_dictionary(NODE, DriveProfile()))
    pdo = node.tpdo[1]
    pdo.clear()
    variables = [pdo.add_variable(o.index, o.sub) for o in telegram.objects]

    def timed(call: Callable[[], object]) -> Callable[[Clock], float]:
        def run(clock_ns: Clock) -> float:
            begin = clock_ns()
            for _ in range(CODECS):
                call()
            return (clock_ns() - begin) / CODECS / 1e3

        return run

    def canopen_pack() -> bytes:
        for variable in variables:
            variable.raw = 1
        return bytes(pdo.data)

    return {
        "pack": timed(lambda: message(image)),
        "unpack": timed(lambda: unpack(data)),
        "canopen_pack": timed(canopen_pack),
        "canopen_unpack": timed(lambda: [variable.raw for variable in variables]),
    }
