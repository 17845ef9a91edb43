"""What freezes 3D distance control, and what does not."""

from typing import Any

import pytest
from tests.channel.distance3d.programs import LONG, TILTED, Make, dwell, rising


def hold_path(plc: Any, is_on: bool) -> None:
    plc.feedhold = is_on


def stop_path(plc: Any, is_on: bool) -> None:
    plc.override_permille = 0 if is_on else 1000


def hold(axis: str) -> Any:
    def act(plc: Any, is_on: bool) -> None:
        plc.axis[axis].feedhold = is_on

    return act


def stop(axis: str) -> Any:
    def act(plc: Any, is_on: bool) -> None:
        plc.axis[axis].override_permille = 0 if is_on else 1000

    return act


def while_held(made: Any, act: Any, begin: int, end: int) -> None:
    plc = made.channel.plc
    made.at({begin: lambda: act(plc, True), end: lambda: act(plc, False)})


@pytest.mark.parametrize("mode", [LONG("MCS"), "ECS"])
@pytest.mark.parametrize("act", [hold_path, LONG(stop_path), LONG(hold("A")), stop("C")])
@pytest.mark.long
def test_path_feedhold_override_0_and_axes_that_it_does_not_move_change_nothing(
    make_head: Make, mode: str, act: Any
) -> None:
    made = make_head(rising)
    while_held(made, act, 600, 950)
    made.run(TILTED + f"#DIST CTRL ON [SET_POS=0 MODE={mode}]\n" + dwell(1200))
    assert made.offset_mm[900] == pytest.approx(0.8, abs=0.02)
    assert len(set(made.offset_mm[650:900])) > 200


@pytest.mark.parametrize(
    ("mode", "act"),
    [
        LONG("MCS", hold("Z")),
        ("MCS", stop("Z")),
        ("ECS", hold("Y")),
        LONG("ECS", stop("Z")),
    ],
)
@pytest.mark.long
def test_an_axis_that_it_moves_freezes_all_of_it_to_the_bit(
    make_head: Make, mode: str, act: Any
) -> None:
    made = make_head(rising)
    while_held(made, act, 700, 900)
    made.run(TILTED + f"#DIST CTRL ON [SET_POS=0 MODE={mode}]\n" + dwell(1300))
    assert set(made.offset_mm[700:900]) == {made.offset_mm[699]}
    assert 0.3 < made.offset_mm[699] < 0.5
    for name in ("Y", "Z"):
        assert len(set(made.sent[name][700:900])) == 1
    assert made.offset_mm[-1] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.long
def test_mcs_is_not_frozen_by_an_axis_that_only_ecs_moves(make_head: Make) -> None:
    made = make_head(rising)
    while_held(made, hold("Y"), 700, 900)
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=MCS]\n" + dwell(1300))
    assert len(set(made.offset_mm[700:900])) > 150


@pytest.mark.long
def test_an_override_of_an_axis_scales_v_max(make_head: Make) -> None:
    made = make_head(lambda _ms: 1.0, v_max_mm_s=2.0)
    made.channel.plc.axis["Y"].override_permille = 500
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n" + dwell(300))
    steps = [b - a for a, b in zip(made.offset_mm, made.offset_mm[1:], strict=False)]
    assert max(steps) == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.long
def test_g4_and_a_wait_for_the_plc_do_not_stop_it(make_head: Make) -> None:
    made = make_head(rising)
    made.channel.plc.acknowledged_later = frozenset({"M50"})
    made.at({1200: made.channel.plc.acknowledge})
    made.run(TILTED + "#DIST CTRL ON [SET_POS=0]\nM50\nG4 0.01")
    assert made.offset_mm[1150] == pytest.approx(1.0, abs=1e-4)
