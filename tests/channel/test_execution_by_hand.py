"""What carries out a program, by hand: what it waits for, what watches see, what a reset ends."""

from typing import Any

import pytest

from axisrig.kernel.channel.path.execution import BlockEnd, BlockWatch, Execution
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

END = canon.EndOfProgram(Block(99, 99, "M30"))


def dwell(number: int) -> canon.Dwell:
    return canon.Dwell(Block(number, number, f"N{number}"), 0)


class Bench(BlockWatch):
    """Dwells that begin when they may and last as long as the test says; calls: in their order."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, Any]] = []
        self.is_ready, self.is_busy = True, False
        self.execution = Execution(lambda message: self.calls.append(("text", message.text)))
        self.execution.while_busy(lambda: self.is_busy)
        self.execution.register(
            canon.Dwell, lambda _command: setattr(self, "is_busy", True),
            ready=lambda: self.is_ready,
        )  # fmt: skip
        self.execution.register(canon.EndOfProgram, lambda _command: None, is_block=False)
        self.execution.watches.append(self)

    def waits(self, command: canon.Command) -> None:
        self.calls.append(("waits", command.block.number))

    def begins(self, command: canon.Command) -> None:
        self.calls.append(("begins", command.block.number))

    def ends(self, how: BlockEnd) -> None:
        self.calls.append(("ends", how.value))

    def cycles(self, count: int, *, is_ready: bool = True, is_busy: bool = False) -> list[Any]:
        self.is_ready, self.is_busy = is_ready, is_busy
        before = len(self.calls)
        for _ in range(count):
            self.execution.step()
        return self.calls[before:]


def test_a_command_waits_begins_and_ends_once() -> None:
    bench = Bench()
    text = canon.Message(Block(3, 3, ""), "text", synchronous=True)
    bench.execution.load(iter((dwell(1), dwell(2), text, END)))
    assert bench.cycles(3, is_ready=False) == [("waits", 1)]
    assert bench.execution.block is None
    assert bench.cycles(1) == [("begins", 1)]
    assert bench.cycles(3, is_busy=True) == []
    assert bench.cycles(3, is_ready=False) == [("ends", "done"), ("waits", 2)]
    assert bench.execution.block == dwell(1).block
    assert bench.cycles(1) == [("begins", 2)]
    rest = [("ends", "done"), ("begins", 3), ("text", "text"), ("ends", "done"), ("begins", 99)]
    assert bench.cycles(1) == [*rest, ("ends", "done")]
    assert (bench.execution.block, bench.execution.begun) == (dwell(2).block, END)


@pytest.mark.parametrize("act", ["load", "drop", "close"])
@pytest.mark.parametrize("begun", [True, False])
def test_what_is_under_way_or_waits_ends_with_its_program(act: str, begun: bool) -> None:
    bench = Bench()
    execution = bench.execution
    execution.load(iter((dwell(1), END)))
    assert bench.calls == []  # nothing was there that could end
    bench.cycles(2, is_ready=begun)
    bench.calls.clear()
    if act == "load":
        execution.load(iter((dwell(7), END)))
    elif act == "drop":
        execution.drop()
    else:
        execution.close(BlockEnd.STOPPED)
    assert bench.calls == [("ends", "stopped" if act == "close" else "reset")]
    execution.close(BlockEnd.RESET)
    assert len(bench.calls) == 1
    if act == "load":
        assert bench.cycles(1, is_ready=False) == [("waits", 7)]
    assert (execution.block is None) is (act != "close" or not begun)
