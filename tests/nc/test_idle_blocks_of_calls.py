"""How many blocks have come again since the machine had something to do, over calls and loops."""

from types import SimpleNamespace
from typing import Any

from axisrig.kernel.nc.decoder.base.frames import Flow


def routine(blocks: int, **labels: int) -> Any:
    return SimpleNamespace(
        blocks=list(range(blocks)), structure=SimpleNamespace(targets=labels), file=None
    )


def advance(flow: Flow, count: int) -> int:
    for _ in range(count):
        flow.advance()
    return flow.idle_blocks


def test_blocks_of_a_straight_program_come_once() -> None:
    flow = Flow(routine(1000))
    assert advance(flow, 1000) == 0
    assert flow.advance() is None


def test_what_a_loop_calls_comes_again_until_the_machine_has_something_to_do() -> None:
    """After that the rest of the call comes for the first time again."""
    flow, called = Flow(routine(3, N10=0)), routine(10)
    advance(flow, 2)
    flow.jump("N10")
    assert advance(flow, 2) == 2  # the block of the call is the second one
    flow.call(called)
    assert advance(flow, 4) == 6
    flow.give_work()
    assert advance(flow, 6) == 0
    flow.advance()  # back in the main program
    assert (flow.idle_blocks, len(flow.frames)) == (0, 1)
    flow.jump("N10")
    assert advance(flow, 1) == 0
    flow.call(called)
    assert advance(flow, 10) == 0


def test_a_call_out_of_blocks_that_come_once_comes_once() -> None:
    flow, called = Flow(routine(3)), routine(4)
    for _ in range(2):
        flow.advance()
        flow.call(called)
        assert advance(flow, 4) == 0
    assert advance(flow, 1) == 0
