"""Look-ahead, messages and order: when what the program says happens."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import pytest

from axisrig.kernel.channel.path.lookahead import DEPTH, Lookahead
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program

Make = Callable[..., Any]
MS = 1_000_000


def _at(bench: Any, time_ns: int) -> Any:
    """The cycle of an instant."""
    return next(sample for sample in bench.samples if sample.time_ns == time_ns)


@pytest.mark.long
def test_a_plain_message_comes_when_it_is_decoded(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.run(
        [
            words.move(1, 600.0, Z=5.0),
            words.message(2, "decoded", synchronous=False),
            words.move(3, 600.0, Z=10.0),
            words.end(),
        ]
    )
    ((time_ns, text),) = bench.messages
    assert text == "decoded"
    assert time_ns == bench.channel.start_ns  # the first cycle that refills the queue
    assert _at(bench, time_ns).set_mm[0] < 0.01


@pytest.mark.long
def test_a_synchronous_message_comes_when_the_machine_got_there(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.run(
        [
            words.move(1, 600.0, Z=5.0),
            words.wait(2),
            words.message(2, "there", synchronous=True),
            words.move(3, 600.0, Z=10.0),
            words.message(4, "end", synchronous=True),
            words.end(),
        ]
    )
    (there_ns, there), (end_ns, end) = bench.messages
    assert (there, end) == ("there", "end")
    before = next(s for s in reversed(bench.samples) if s.time_ns < there_ns)
    assert before.set_mm == (5.0,)
    assert _at(bench, end_ns).set_mm == (10.0,)


@pytest.mark.long
def test_a_later_move_is_waited_for_as_the_first_one(channel_bench: Make, words: Any) -> None:
    """Ten cycles inside the window, counted anew: once in position is not always in position."""
    bench = channel_bench(words.axis("Z", kv=400.0, window_mm=0.01)).run(
        [
            words.move(1, 600.0, Z=5.0),
            words.probe(2, 600.0, Z=4.0),
            words.move(3, 600.0, Z=8.0),
            words.end(),
        ]
    )
    stands = [n for n, z_mm in enumerate(bench.set_mm("Z")) if z_mm == 8.0]
    assert len(stands) > 10


@pytest.mark.long
@pytest.mark.parametrize("buffer_cycles", [0, 5])
def test_a_wait_lasts_until_the_buffer_is_empty(
    channel_bench: Make, words: Any, buffer_cycles: int
) -> None:
    """What was sent to the drive, not what was interpolated, has reached the target."""
    bench = channel_bench(words.axis("Z"), buffer_cycles=buffer_cycles)
    bench.run(
        [
            words.move(1, 600.0, Z=5.0),
            words.wait(2),
            words.message(2, "there", synchronous=True),
            words.end(),
        ]
    )
    ((there_ns, _),) = bench.messages
    before = next(s for s in reversed(bench.samples) if s.time_ns < there_ns)
    assert before.sent_mm == (5.0,)


def test_messages_keep_the_order_of_the_program(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    commands: list[canon.Command] = [
        words.message(n, str(n), synchronous=True) for n in range(1, 41)
    ]
    bench.run([*commands, words.end()])
    assert [text for _, text in bench.messages] == [str(n) for n in range(1, 41)]
    assert len({time_ns for time_ns, _ in bench.messages}) == 1  # nothing moves in between


def test_the_queue_is_as_deep_as_it_says_and_closes_at_a_wait(words: Any) -> None:
    taken = 0

    def commands() -> Iterator[canon.Command]:
        nonlocal taken
        for number in range(1, 100):
            taken += 1
            yield words.wait(number) if number == 20 else words.move(number, 1.0, Z=float(number))

    put_out: list[canon.Message] = []
    lookahead = Lookahead(commands(), put_out.append)
    lookahead.refill()
    assert taken == DEPTH
    for _ in range(DEPTH - 1):
        lookahead.pop()
    lookahead.refill()
    assert taken == 20  # up to the wait
    while not isinstance(lookahead.head, canon.Wait):
        lookahead.pop()
    lookahead.refill()
    assert taken == 20
    lookahead.pop()
    lookahead.refill()
    assert taken == 20 + DEPTH


@pytest.mark.long
def test_moves_follow_each_other_without_a_pause(channel_bench: Make, words: Any) -> None:
    """Exact stop between blocks: the set position stands for no cycle longer than needed."""
    bench = channel_bench(words.axis("Z"))
    bench.run([words.move(1, 600.0, Z=5.0), words.move(2, 600.0, Z=10.0), words.end()])
    values = bench.set_mm("Z")
    assert values.count(5.0) == 1


def test_a_move_to_where_the_axes_are_is_no_motion(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.run([words.move(1, 600.0, Z=0.0), words.end()])
    assert bench.alarm_ids == []
    assert set(bench.set_mm("Z")) == {0.0}


@pytest.mark.long
def test_nothing_is_asked_of_the_drives_before_all_of_them_are_enabled(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Y", start_mm=3.0), words.axis("Z", start_mm=7.0))
    bench.run([words.move(1, 600.0, Y=4.0, Z=8.0), words.end()])
    before = [s for s in bench.samples if s.time_ns < bench.channel.start_ns]
    assert before
    for sample in before:
        assert sample.sent_mm == pytest.approx((3.0, 7.0), abs=1e-5)


def test_cycles_come_every_period_behind_the_sync(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.run([words.move(1, 600.0, Z=1.0), words.end()])
    times = [sample.time_ns for sample in bench.samples]
    assert {b - a for a, b in pairwise(times)} == {MS}
    assert {time_ns % MS for time_ns in times} == {620_000}
    requested = {time_ns % MS for time_ns in bench.sync_ns()}
    assert len(requested) == 1  # one frame length behind the whole millisecond


# Program texts


def _run_text(bench: Any, *blocks: str) -> Any:
    program = parse_program("\n".join(["%test", *blocks, "M30", ""]), axes=tuple(bench.axes))
    interpreter = Interpreter(program, tuple(bench.axes), bench.channel, external={})
    return bench.run(interpreter.commands())


@pytest.mark.long
def test_a_program_text_measures_and_goes_on_from_where_it_stopped(
    channel_bench: Make, words: Any
) -> None:
    """Relative motion behind a run counts from the stop, not from the target of the run."""
    bench = channel_bench(words.axis("Y"), words.axis("Z", start_mm=130.0), plane_mm=110.0)
    _run_text(
        bench,
        "N10 G100 G90 Z60 F1200",
        'N20 #MSG SYN["Z=%f", V.A.MEAS.ACS.VALUE.Z]',
        "N30 G01 G91 Y10 Z1 F1200",
    )
    assert bench.alarm_ids == []
    ((_, text),) = bench.messages
    assert float(text.removeprefix("Z=")) == pytest.approx(110.0, abs=1e-5)
    stopped_mm = min(bench.set_mm("Z"))
    assert bench.final_mm("Z") == pytest.approx(stopped_mm + 1.0, abs=1e-9)
    assert bench.final_mm("Y") == pytest.approx(10.0, abs=1e-5)


def test_relative_motion_in_the_first_block_counts_from_where_the_axis_stands(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0))
    _run_text(bench, "N10 G01 G91 Z-5 F6000")
    assert bench.final_mm("Z") == pytest.approx(125.0, abs=1e-4)


def test_the_first_block_may_lead_to_zero(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=10.0))
    _run_text(bench, "N10 G01 G90 Z0 F6000")
    assert bench.final_mm("Z") == pytest.approx(0.0, abs=1e-4)
