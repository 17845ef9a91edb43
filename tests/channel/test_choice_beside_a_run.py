"""#MEAS while an axis beside the path measures: the choice waits until no probe is armed."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS

Make = Callable[..., ChannelBench]
PLANE_MM, START_MM = 127.0, 130.0
"""3 mm at 30 mm/s: the run takes 100 ms and its ramps."""


def block(number: int) -> Block:
    return Block(number, number * 10, f"N{number * 10}")


CHOICES: dict[str, canon.Command] = {
    "default": canon.DefaultProbes(block(3)),
    "settings of the axis": canon.ProbeSettings(block(3), "Z", edge="POS"),
    "settings of another one": canon.ProbeSettings(block(3), "Y", edge="POS"),
}


def run(channel_bench: Make, words: Any, *commands: canon.Command, armed: bool) -> ChannelBench:
    """Z measures by itself, or moves there; 20 ms later a choice, and a message after it."""
    bench = channel_bench(words.axis("Y"), words.axis("Z", start_mm=START_MM), plane_mm=PLANE_MM)
    beside = canon.IndependentMove(
        block(1), "Z", 110.0 if armed else PLANE_MM + 0.5, feed_mm_min=1800.0,
        measuring_type=1 if armed else None,
    )  # fmt: skip
    wait = canon.WaitIndependent(block(5), ("Z",))
    message = words.message(4, "chosen", synchronous=True)
    bench.run([beside, canon.Dwell(block(2), 20 * MS), *commands, message, wait, words.end()])
    assert bench.alarm_ids == []
    return bench


@pytest.mark.long
@pytest.mark.parametrize("choice", CHOICES)
def test_a_choice_waits_for_the_end_of_a_run_beside_the_path(
    channel_bench: Make, words: Any, choice: str
) -> None:
    bench = run(channel_bench, words, CHOICES[choice], armed=True)
    (record,) = bench.channel.records
    ((chosen_ns, _),) = bench.messages
    assert record.end_ns is not None
    assert record.end_ns <= chosen_ns <= record.end_ns + 10 * MS
    assert record.latched_mm["Z"] == pytest.approx(PLANE_MM, abs=1e-4)


@pytest.mark.long
@pytest.mark.parametrize("choice", CHOICES)
def test_a_choice_does_not_wait_where_nothing_measures(
    channel_bench: Make, words: Any, choice: str
) -> None:
    """An axis that only moves beside the path; without a choice nothing waits for a run either."""
    bench = run(channel_bench, words, CHOICES[choice], armed=False)
    ((chosen_ns, _),) = bench.messages
    assert bench.channel.start_ns is not None
    assert chosen_ns - bench.channel.start_ns <= 25 * MS


@pytest.mark.parametrize("choice", CHOICES)
def test_a_choice_right_behind_the_block_waits_although_nothing_is_armed_yet(
    channel_bench: Make, words: Any, choice: str
) -> None:
    """The run would arm its probe as the next block has it."""
    bench = channel_bench(words.axis("Y"), words.axis("Z", start_mm=START_MM), plane_mm=PLANE_MM)
    beside = canon.IndependentMove(block(1), "Z", 110.0, feed_mm_min=1800.0, measuring_type=1)
    message = words.message(4, "chosen", synchronous=True)
    bench.run([beside, CHOICES[choice], message, words.end()])
    (record,) = bench.channel.records
    ((chosen_ns, _),) = bench.messages
    assert record.end_ns is not None
    assert chosen_ns >= record.end_ns
    assert record.latched_mm["Z"] == pytest.approx(PLANE_MM, abs=1e-4)


@pytest.mark.long
def test_without_a_choice_a_program_goes_on_beside_a_run(channel_bench: Make, words: Any) -> None:
    bench = run(channel_bench, words, armed=True)
    ((shown_ns, _),) = bench.messages
    assert bench.channel.start_ns is not None
    assert shown_ns - bench.channel.start_ns <= 25 * MS
