"""How fast is the bus: frames through one segment into canopen callbacks, and PDOs through codecs.

Beside ours are python-can's `virtual` interface with canopen's notifier thread, and canopen's own
codec, timed in turns with ours: their ratio outlives the machine it was measured on.
"""

import json
import random
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from typing import Any

import canopen

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.mapping import Layout
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

# A measurement is shorter than the slice of time that a busy machine gives, and the least counts.
FRAMES = 200  # in one measurement
ROUNDS = 40
BATCH = 5  # frames per ms, about as many as one drive and its master send
NODE, COB_ID = 1, 0x181

Clock = Callable[[], int]


def measure_bus(repeats: int, clock_ns: Clock) -> dict[str, Any]:
    """Time segment, `virtual` and codecs in turns; the least of 40 `repeats` measurements counts.

    Returns `segment_frames_s`, `virtual_frames_s`, `segment_ratio`, `codec_frames_s` (packed and
    unpacked again), `pack_us`, `unpack_us`, `canopen_pack_us`, `canopen_unpack_us`, `codec_ratio`.
    """
    with _segment() as through_segment, _virtual() as through_virtual:
        runs: dict[str, Callable[[], None]] = {
            "segment": through_segment,
            "virtual": through_virtual,
            **_codecs(telegrams(0x60BA)["TPDO1"]),
        }
        least_ns = dict.fromkeys(runs, 1 << 62)
        for _ in range(repeats * ROUNDS):
            for name, run in runs.items():
                begin = clock_ns()
                run()
                least_ns[name] = min(least_ns[name], clock_ns() - begin)
    least_us = {name: spent_ns / FRAMES / 1e3 for name, spent_ns in least_ns.items()}
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
            f" {result['repeats'] * ROUNDS} times {FRAMES})",
            f"  segment, exact times   {result['segment_frames_s']:>10,.0f} /s",
            f"  python-can virtual     {result['virtual_frames_s']:>10,.0f} /s"
            f"   ratio {result['segment_ratio']:.1f}",
            f"PDO of statusword, position and probe status (best of"
            f" {result['repeats'] * ROUNDS} times {FRAMES})",
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


@contextmanager
def _segment() -> Iterator[Callable[[], None]]:
    """Send frames from one network through a segment into a callback of another."""
    scheduler, payloads = new_scheduler(), _payloads()
    got = [0]

    def take(_can_id: int, _data: bytearray, _timestamp: float) -> None:
        got[0] += 1

    with Segment("perf", 1_000_000, scheduler) as segment:
        sender = SimNetwork(segment.port("sender")).connect()
        receiver = SimNetwork(segment.port("receiver")).connect()
        receiver.subscribe(COB_ID, take)

        def run() -> None:
            got[0] = 0
            for place in range(0, FRAMES, BATCH):
                for data in payloads[place : place + BATCH]:
                    sender.send_message(COB_ID, data)
                scheduler.run_until(scheduler.now_ns + MS)
            assert got[0] == FRAMES  # 5 frames of at most 135 bits fit into 1 ms

        yield run


@contextmanager
def _virtual() -> Iterator[Callable[[], None]]:
    """Do the same over python-can's `virtual` bus; a thread of canopen receives."""
    done: SimpleQueue[None] = SimpleQueue()
    payloads = _payloads()
    got = [0]

    def take(_can_id: int, _data: bytearray, _timestamp: float) -> None:
        got[0] += 1
        if got[0] == FRAMES:
            done.put(None)

    sender, receiver = canopen.Network(), canopen.Network()
    for network in (sender, receiver):
        network.connect(interface="virtual", channel="axisrig perf")
    receiver.subscribe(COB_ID, take)

    def run() -> None:
        got[0] = 0
        for data in payloads:
            sender.send_message(COB_ID, data)
        done.get(timeout=60)

    try:
        yield run
    finally:
        sender.disconnect()
        receiver.disconnect()


def _codecs(telegram: Telegram) -> dict[str, Callable[[], None]]:
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

    def pack_all() -> None:
        for _ in range(FRAMES):
            message(image)

    def unpack_all() -> None:
        for _ in range(FRAMES):
            unpack(data)

    def canopen_pack_all() -> None:
        for _ in range(FRAMES):
            for variable in variables:
                variable.raw = 1

    def canopen_unpack_all() -> None:
        for _ in range(FRAMES):
            for variable in variables:
                assert variable.raw == 1

    return {
        "pack": pack_all,
        "unpack": unpack_all,
        "canopen_pack": canopen_pack_all,
        "canopen_unpack": canopen_unpack_all,
    }
