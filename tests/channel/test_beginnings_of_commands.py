"""When each kind of command may begin: at once, with axes at rest, in position, or unarmed."""

from typing import Any

import pytest
from tests.channel.channel_by_hand import Bench

from axisrig.kernel.channel.path.execution import BlockWatch
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

pytestmark = pytest.mark.interpreted

BLOCK = Block(2, 20, "N20")
END = canon.EndOfProgram(Block(9, 90, "N90"))
PAIR = canon.AxisPair("X", "Z")
CHOICES: dict[str, canon.Command] = {
    "default": canon.DefaultProbes(BLOCK),
    "settings": canon.ProbeSettings(BLOCK, "Z", edge="POS"),
    "settings of another axis": canon.ProbeSettings(BLOCK, "X", edge="POS"),
}
IN_POSITION: dict[str, canon.Command] = {
    "exact stop": canon.ExactStop(BLOCK),
    "stop that is not taken": canon.ProgramStop(BLOCK, optional=True),
    "coupling on": canon.AxisLinkOn(BLOCK, 1, (PAIR,)),
}
AT_REST: dict[str, canon.Command] = {
    "coupling off": canon.AxisLinkOff(BLOCK, 1),
    "exchange": canon.AxisExchange(BLOCK, ("Z",), ()),
    "wait": canon.Wait(BLOCK),
}
AT_ONCE: dict[str, canon.Command] = {
    "slope": canon.SlopeChoice(BLOCK, "TRAPEZ"),
    "weights": canon.DynamicWeights(BLOCK, "acceleration", {"X": 0.5}),
    "dwell": canon.Dwell(BLOCK, 1),
    **CHOICES,
    **AT_REST,
}


class Begun(BlockWatch):
    """What has begun."""

    def __init__(self) -> None:
        self.commands: list[canon.Command] = []

    def begins(self, command: canon.Command) -> None:
        self.commands.append(command)


def bench_of(words: Any) -> tuple[Bench, Begun]:
    bench, begun = Bench(words), Begun()
    bench.channel.execution.watches.append(begun)
    for link in bench.links.values():
        vars(link).update(is_probing=False, choose_latch=lambda *_any: None)
    return bench, begun


@pytest.mark.parametrize("command", CHOICES.values(), ids=CHOICES)
@pytest.mark.parametrize("armed", ["X", "Z"])
def test_a_choice_of_probes_waits_while_any_probe_is_armed(
    words: Any, command: canon.Command, armed: str
) -> None:
    """The latch of a drive that waits for its edge must not be another one's."""
    bench, begun = bench_of(words)
    vars(bench.links[armed])["is_probing"] = True
    bench.start(command, END).cycle(30)
    assert begun.commands == []
    vars(bench.links[armed])["is_probing"] = False
    bench.cycle()
    assert begun.commands == [command]


@pytest.mark.parametrize("command", IN_POSITION.values(), ids=IN_POSITION)
@pytest.mark.parametrize("late", ["X", "Z"])
def test_what_needs_exact_stop_waits_for_every_axis(
    words: Any, command: canon.Command, late: str
) -> None:
    bench, begun = bench_of(words)
    bench.links[late].lag_mm = -5.0
    bench.start(command, END).cycle(30)
    assert begun.commands == []
    bench.links[late].lag_mm = 0.0
    bench.cycle(20)
    assert begun.commands[0] is command


@pytest.mark.parametrize("command", AT_ONCE.values(), ids=AT_ONCE)
def test_what_needs_no_exact_stop_begins_beside_a_lag(words: Any, command: canon.Command) -> None:
    bench, begun = bench_of(words)
    bench.links["X"].lag_mm = -5.0
    bench.start(command, END)
    assert begun.commands[0] is command


@pytest.mark.parametrize("command", AT_REST.values(), ids=AT_REST)
def test_what_needs_axes_at_rest_waits_for_a_motion_beside_the_path(
    words: Any, command: canon.Command
) -> None:
    """`Wait` is for the path alone."""
    move = canon.IndependentMove(Block(1, 10, "N10"), "Z", 1.0, feed_mm_min=6000.0)
    bench, begun = bench_of(words)
    bench.start(move, command, END).cycle(3)
    waits = not isinstance(command, canon.Wait)
    assert (begun.commands[1:] == []) is waits
    bench.cycle(400)
    assert begun.commands[:2] == [move, command]
