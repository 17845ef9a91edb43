"""3D distance control of a channel: a program of the manual, waiting, what it needs."""

import math
from typing import Any

import pytest
from tests.channel.distance3d.programs import INCREMENT_MM, LONG, TILTED, Make, dwell

from axisrig.kernel.distance import DistanceState
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program


@pytest.mark.long
def test_a_program_of_the_manual_runs(make_head: Make) -> None:
    """Example 2 of FCT-M3 12.2 with a surface at 1.5 mm: 0.5 mm along the tool, then out."""
    made = make_head(lambda _ms: 1.5)
    made.run(
        TILTED
        + "#DIST CTRL ON [SURFACE SET_POS=1 MODE=ECS DIRECTION=Z]\n"
        + dwell(300)
        + "#DIST CTRL WAIT OFF\nG0 Z0"
    )
    assert made.alarm_ids == [900315]
    assert max(made.offset_mm) == pytest.approx(0.5, abs=INCREMENT_MM)
    at = made.offset_mm.index(max(made.offset_mm))
    away = made.sent["Y"][at] - made.interpolated["Y"][at]
    assert away == pytest.approx(0.5 * math.tan(math.radians(40)), abs=2 * INCREMENT_MM)
    assert made.state[-1] is DistanceState.INACTIVE
    assert {n: p[-1] for n, p in made.sent.items()} == {
        n: p[-1] for n, p in made.interpolated.items()
    }


@pytest.mark.long
@pytest.mark.parametrize(
    "after",
    [
        "#DIST CTRL ON [SET_POS=1 MODE=MCS]\n",
        "#CS ON[0,0,0,10,0,0]\n#DIST CTRL ON [SET_POS=1]\n",
        LONG("#DIST CTRL ON [SET_POS=80 MODE=ACS DIRECTION=Z]\n"),
    ],
)
@pytest.mark.parametrize("is_optimized", [True, LONG(False)])
def test_wait_off_lasts_until_no_offset_is_on_its_way(
    make_head: Make, after: str, is_optimized: bool
) -> None:
    """The next command may take another mode or another normal at once."""
    made = make_head(lambda _ms: 1.5, is_optimized=is_optimized).run(
        TILTED
        + "#DIST CTRL ON [SET_POS=1 MODE=ECS]\n"
        + dwell(100)
        + "#DIST CTRL WAIT OFF\n"
        + after
    )
    assert made.alarm_ids == [900315]


@pytest.mark.long
def test_another_set_distance_while_on_is_a_warning_for_each_change(make_head: Make) -> None:
    made = make_head().run(
        TILTED
        + "#DIST CTRL ON [CONST_DIST SET_DIST=80 MODE=MCS]\n"
        + "#DIST CTRL [SET_DIST=79]\n#DIST CTRL [SET_DIST=79]\n#DIST CTRL [SET_DIST=80]\n"
        + "#DIST CTRL [SET_DIST=78]\n"
    )
    assert made.alarm_ids == [900315, 900464, 900464]


@pytest.mark.provokes(20209, 2)
def test_20209_without_its_function(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(*map(words.axis, "XYZ"), bitrate=5_000_000)
    program = parse_program("%t\n#DIST CTRL ON\nM30\n", file="t.nc", axes=("X", "Y", "Z"))
    interpreter = Interpreter(program, ("X", "Y", "Z"), bench.channel, external={})
    bench.run(interpreter.commands())
    assert bench.alarm_ids == [20209]


@pytest.mark.provokes(21837, 2)
def test_21837_without_the_option(make_head: Make) -> None:
    made = make_head(is_licensed=False).run("#DIST CTRL [KP=1]")
    assert made.alarm_ids == [21837]
