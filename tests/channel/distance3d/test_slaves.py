"""Slaves of axes that 3D distance control moves."""

import math
from typing import Any

import pytest
from tests.channel.distance3d.programs import LONG, TILTED, Make

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

START_MM = {"W": -5.0, "V": 40.0}


def coupled(make_head: Make, words: Any, text: str) -> Any:
    """W follows Z, and V follows Y, each from a place of its own."""
    quick = {"kv": 1e9, "a_mm_s2": 1e5, "speed_max_mm_s": 2e3}
    more = [words.axis(name, start_mm=at, **quick) for name, at in START_MM.items()]
    made = make_head(lambda _ms: 0.5, more=more)
    pairs = tuple(
        canon.AxisPair(slave=slave, master=master, limits_mm=(0.05, 0.1))
        for slave, master in (("W", "Z"), ("V", "Y"))
    )
    return made.run(TILTED + text, canon.AxisLinkOn(Block(1, 10, "N10"), 1, pairs))


@pytest.mark.parametrize("end", [LONG("OFF"), "OFF NO_MOVE"])
@pytest.mark.long
def test_slaves_follow_the_offset_of_their_masters(make_head: Make, words: Any, end: str) -> None:
    """Along the tool, A = -40: Z and W by 0.5 mm, Y and V by 0.5 tan 40 mm."""
    made = coupled(
        make_head,
        words,
        "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.2\n"
        f"#DIST CTRL WAIT {end}\n#TIME 0.05\nG1 X1 F6000\n#TIME 0.01",
    )
    assert made.alarm_ids == [900315]
    rest_mm = {"Z": 180 * math.cos(math.radians(40)), "Y": 180 * math.sin(math.radians(40))}
    moved_mm = {"Z": 0.5, "Y": 0.5 * math.tan(math.radians(40))}
    for slave, master, start_mm in (("W", "Z", 180.0), ("V", "Y", 0.0)):
        away_mm = START_MM[slave] - start_mm
        apart = {round(w - z, 9) for w, z in zip(made.sent[slave], made.sent[master], strict=True)}
        assert apart == {away_mm}
        most_mm = max(made.sent[slave][-100:]) - away_mm - rest_mm[master]
        assert most_mm == pytest.approx(moved_mm[master], abs=1e-4)
        left_mm = moved_mm[master] if "NO_MOVE" in end else 0.0
        at_mm = made.sent[slave][-1] - away_mm - rest_mm[master]
        assert at_mm == pytest.approx(left_mm, abs=1e-4)
