"""Moments that happened between two turns of the PLC side: a time after one counts from itself."""

from types import SimpleNamespace

import pytest
from tests.machine.test_plc_side_by_hand import BLOCK, Rules, variable

from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


def happen(on: Rules, moment: str, at_ms: float) -> None:
    """Let a moment happen in the channel, which the next turn notices."""
    at_ns, channel = round(at_ms * MS), on.channel
    if moment == "run":
        channel.records.append(SimpleNamespace(begin_ns=at_ns, end_ns=None))
    elif moment == "run_end":
        channel.records[-1].end_ns = at_ns
    elif moment == "program_end":
        channel.program_ends_ns.append(at_ns)
    elif moment == "reset":
        channel.resets_ns.append(at_ns)
    else:
        on.clock.run_until(at_ns)
        if moment == "M33":
            on.plc.send(canon.TechnologyFunction(BLOCK, "M", 33))
        else:
            on.plc.write(canon.ExternalWrite(BLOCK, "GO", 1.0))


@pytest.mark.parametrize(
    ("offset", "acts_ms"),
    # After 2.4 ms: in the first turn at or after that
    [("", 3.0), ("+0.5ms", 3.0), ("+0.6ms", 3.0), ("+0.7ms", 4.0), ("+1.6ms", 4.0),
     ("+5ms", 8.0), ("+5.6ms", 8.0), ("+5.7ms", 9.0)],
)  # fmt: skip
@pytest.mark.parametrize("moment", ["run", "run_end", "program_end", "reset", "M33", "V.E.GO"])
def test_a_time_after_a_moment_counts_from_its_instant(
    moment: str, offset: str, acts_ms: float
) -> None:
    """A run that ends at 2.4 ms had begun before the first turn."""
    on = variable(f"{moment}{offset}")
    if moment == "run_end":
        happen(on, "run", 0.0)
    on.turns(2)
    on.plc.take_turn()
    happen(on, moment, 2.4)
    on.clock.run_until(3 * MS)
    on.turns(8)
    assert on.times() == [acts_ms]


def test_of_moments_of_one_turn_each_has_its_own_instant() -> None:
    """Three runs that began between two turns, and rules that act 2 ms after each."""
    on = variable("run+2ms")
    on.turns()
    for at_ms in (0.2, 0.9, 1.0):
        happen(on, "run", at_ms)
    on.turns(5)
    assert on.times() == [3.0, 3.0, 3.0]
    again = variable("run+2.05ms nth=3")
    again.turns()
    for at_ms in (0.2, 0.9, 1.0):
        happen(again, "run", at_ms)
    again.turns(5)
    assert again.times() == [4.0]


@pytest.mark.parametrize(("moment", "acts"), [("run_end", [7.0]), ("run", [6.0])])
def test_of_two_runs_each_ends_by_itself_with_a_time_after_it(
    moment: str, acts: list[float]
) -> None:
    """Begun at 1.5 and 1.8 ms, the second one ends first at 2.3, the first one at 2.9 ms."""
    on = variable(f"{moment}+4ms nth=2")
    on.turns(2)
    happen(on, "run", 1.5)
    happen(on, "run", 1.8)
    first, second = on.channel.records
    on.turns()
    second.end_ns, first.end_ns = round(2.3 * MS), round(2.9 * MS)
    on.turns(9)
    assert on.times() == acts
