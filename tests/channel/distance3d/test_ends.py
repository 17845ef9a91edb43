"""How 3D distance control ends: OFF, reset, end of the program."""

import math
from typing import Any

import pytest
from tests.channel.distance3d.programs import LONG, TILTED, Make

from axisrig.kernel.distance import DistanceState
from axisrig.kernel.plc.interface import PlcParticipant


@pytest.mark.parametrize("buffer_cycles", [LONG(0), 7])
@pytest.mark.long
def test_off_no_move_leaves_the_axes_and_the_next_block_reaches_its_true_target(
    make_head: Make, tool: Any, buffer_cycles: int
) -> None:
    """FCT-M3 12.4.4: Y 60 with the offset, NO_MOVE, then Y 70 without it."""
    made = make_head(lambda _ms: 1.5, options={"buffer_cycles": buffer_cycles})
    made.run(
        TILTED + "G1 F6000 Y0 Z0\n#DIST CTRL WAIT [ON SET_POS=1 MODE=ECS]\nY5\n"
        "#TIME 0.2\n#DIST CTRL WAIT [OFF NO_MOVE]\n#TIME 0.1\nY7 Z0"
    )
    off = len(made.state) - 1 - made.state[::-1].index(DistanceState.ACTIVE) + 1
    for name in ("X", "Y", "Z"):
        sent = made.sent[name]
        assert max(abs(p - sent[off - 1]) for p in sent[off : off + 90]) < 1e-9
    tcp = tool.tcp_of([made.sent[n][off + 50] for n in tool.names])
    assert tcp == pytest.approx((0.0, 5.0 + 0.5 * math.tan(math.radians(40)), 0.5), abs=1e-3)
    assert tool.tcp_of([made.sent[n][-1] for n in tool.names]) == pytest.approx(
        (0.0, 7.0, 0.0), abs=1e-9
    )


@pytest.mark.long
def test_off_runs_out_on_the_fly_and_wait_holds_the_next_block(make_head: Make) -> None:
    for word, is_moving in (("WAIT OFF", False), ("OFF", True)):
        made = make_head(lambda _ms: 1.0, v_max_mm_s=4.0)
        made.run(TILTED + f"#DIST CTRL ON [SET_POS=0]\n#TIME 0.4\n#DIST CTRL {word}\nG1 F600 X3")
        first = made.state.index(DistanceState.TURNING_OFF)
        last = len(made.state) - 1 - made.state[::-1].index(DistanceState.TURNING_OFF)
        assert last - first > 200
        assert (made.interpolated["X"][last] > 0) is is_moving
        assert made.interpolated["X"][-1] == pytest.approx(3.0)
        assert made.offset_mm[-1] == 0.0


@pytest.mark.provokes(900560, 1, owner="the channel")
@pytest.mark.long
def test_a_reset_keeps_the_offset_and_follows_no_more(make_head: Make) -> None:
    made = make_head(lambda ms: 1.0 if ms < 600 else 3.0)
    plc = made.channel.plc
    turns: list[int] = []

    def turn() -> None:
        turns.append(0)
        plc.wants_reset = len(turns) == 500

    plc.join(PlcParticipant(turn, outlives_program=True, is_idle=lambda: len(turns) > 900))
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 5")
    assert made.alarm_ids == [900315, 900560]
    assert made.state[-1] is DistanceState.INACTIVE
    assert made.offset_mm[498] == pytest.approx(1.0, abs=1e-4)
    assert set(made.offset_mm[550:]) == {0.0}
    sent = made.sent["Y"][500:]
    assert max(sent) - min(sent) < 1e-9
    away = sent[-1] - 180 * math.sin(math.radians(40))
    assert away == pytest.approx(math.tan(math.radians(40)), abs=1e-4)


@pytest.mark.long
def test_the_end_of_the_program_keeps_it_too_and_warns_of_nothing(make_head: Make) -> None:
    made = make_head(lambda _ms: 1.0)
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n#TIME 0.2")
    assert made.alarm_ids == [900315]
    assert made.state[-1] is DistanceState.INACTIVE
    assert made.sent["Y"][-1] - made.interpolated["Y"][-1] == pytest.approx(
        math.tan(math.radians(40)), abs=1e-4
    )
