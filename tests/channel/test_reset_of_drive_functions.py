"""#DRIVE under a reset: the next program waits for no answer to the old one, which still comes."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench
from tests.channel.test_channel_reset import Side, begun, reset, start

from axisrig.bench.bus.can.faults import Drop
from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.drives.functions import DriveFunction
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS

Make = Callable[..., ChannelBench]
SDO_ANSWER = 0x581
TIMEOUT_MS = 20
"""After which a request without an answer is sent again."""
TORQUE = DriveFunction(
    "TORQUE_LIMIT", "ACYCLIC", 0x6072, 0, 0x6072, 0, "UNS16", None, 10.0, -1e199, 1e199, None
)


def made(channel_bench: Make, words: Any) -> ChannelBench:
    """The first answer after the start is lost: the drive takes longer than 20 ms."""
    start_up = StartUpSettings(writes=[(0x6072, 0, 250)])
    bench = channel_bench(words.axis("Z"), start_up=start_up, functions={TORQUE.key: TORQUE})
    lost: list[int] = []

    def hook(frame: Any, _port: Any, _attempt: int) -> Any:
        if frame.arbitration_id == SDO_ANSWER and bench.channel.start_ns and not lost:
            lost.append(bench.scheduler.now_ns)
            return Drop()
        return None

    bench.segment.add_fault(hook)
    return bench


def commands(words: Any, kind: str) -> list[canon.Command]:
    block = words.end(1).block
    write = canon.DriveWrite(block, "Z", "TORQUE_LIMIT", 50, kind == "write")
    if kind == "read":
        return [canon.DriveRead(block, "Z", "TORQUE_LIMIT")]
    return [write] if kind == "write" else [write, canon.DriveWait(words.end(2).block, "Z")]


@pytest.mark.parametrize("kind", ["write", "wait", "read"])
def test_the_next_program_does_not_wait_for_an_answer_of_the_one_before(
    channel_bench: Make, words: Any, kind: str
) -> None:
    """Reset in turn 3, next program in turn 8: it moves in the cycle after, before the answer."""
    bench = made(channel_bench, words)
    after = start(bench, words.move(3, 3000.0, Z=1.0), words.end())
    Side(bench, words, {3: reset(bench), 8: after})
    bench.run([*commands(words, kind), words.end()])
    z, first = bench.set_mm("Z"), begun(bench)
    assert z[first + 7] == 0.0 < z[first + 9]
    answers = [at for at, can_id, _ in bench.frames if can_id == SDO_ANSWER]
    assert answers[-1] > bench.samples[first].time_ns + TIMEOUT_MS * MS
    assert bench.alarm_ids == []
    assert bench.final_mm("Z") == 1.0
    if kind == "read":
        assert bench.channel.drive_value("Z", "TORQUE_LIMIT") == 25.0
    else:
        assert bench.nodes["Z"].image.max_torque == 500


@pytest.mark.parametrize("kind", ["write", "wait", "read"])
def test_without_a_reset_a_program_waits_for_the_answer(
    channel_bench: Make, words: Any, kind: str
) -> None:
    bench = made(channel_bench, words)
    bench.run([*commands(words, kind), words.move(3, 3000.0, Z=1.0), words.end()])
    moved_ns = next(sample.time_ns for sample in bench.samples if sample.set_mm[0] > 0.0)
    assert bench.channel.start_ns is not None
    assert moved_ns > bench.channel.start_ns + TIMEOUT_MS * MS
