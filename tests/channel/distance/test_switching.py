"""On, off and what becomes of the offset: NO_MOVE, WAIT, DRYRUN, program end, errors."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.channel.distance.sensor import SensorSettings
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.distance import DistanceSettings, DistanceState
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
HEIGHT_MM = 0.75


def raised(_time_ns: int) -> float:
    return HEIGHT_MM


def on(say: Any, **words: Any) -> canon.DistanceCommand:
    return say.command("on", set_pos_mm=0.0, **words)


@pytest.mark.parametrize("is_optimized", [True, False])
@pytest.mark.parametrize("buffer_cycles", [0, 3])
@pytest.mark.parametrize("settled_ms", [200, 3])
@pytest.mark.long(but=1)
def test_off_no_move_leaves_the_axis_where_it_is_and_the_next_block_goes_to_its_true_target(
    distance_bench: Make,
    say: Any,
    words: Any,
    is_optimized: bool,
    buffer_cycles: int,
    settled_ms: int,
) -> None:
    made = distance_bench(
        raised, is_optimized=is_optimized, options={"buffer_cycles": buffer_cycles},
        v_max_mm_s=50.0, kp=0.2,
    )  # fmt: skip
    made.run(
        on(say), say.dwell(settled_ms), say.command("off", no_move=True), say.dwell(50),
        words.move(5, 600.0, Z=20.0),
    )  # fmt: skip
    seen = made.seen
    off = seen.state.index(DistanceState.INACTIVE, 5)
    assert seen.offset_mm[off:] == [0.0] * len(seen.offset_mm[off:])
    # nothing moves: what was sent in the cycle of the command is sent until the next block
    assert len(set(seen.sent_mm[off : off + 45])) == 1
    assert seen.sent_mm[off] == seen.interpolated_mm[off] > say.start_mm
    # and the step into it is no more than one of the control
    assert abs(seen.sent_mm[off] - seen.sent_mm[off - 1]) <= 50.0 * 1e-3 + 1e-12
    assert seen.sent_mm[-1] == 20.0
    assert made.alarm_ids == []


@pytest.mark.long
def test_off_runs_the_offset_out_while_the_program_goes_on(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(raised, v_max_mm_s=5.0)
    made.run(
        on(say), say.dwell(300), say.command("off"), words.move(3, 600.0, Z=say.start_mm + 0.5)
    )
    seen = made.seen
    off = seen.state.index(DistanceState.TURNING_OFF)
    done = seen.state.index(DistanceState.INACTIVE, off)
    assert (done - off) * MS >= HEIGHT_MM / 5.0 * 1e9  # no faster than v_max
    assert seen.interpolated_mm[off + 10] > say.start_mm  # the block has begun meanwhile
    assert seen.offset_mm[done] == 0.0
    assert seen.sent_mm[-1] == say.start_mm + 0.5


@pytest.mark.long
def test_wait_holds_the_next_command_until_the_offset_is_gone(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(raised, v_max_mm_s=5.0)
    made.run(
        on(say, wait=True), say.dwell(300), say.command("off", wait=True),
        words.move(3, 600.0, Z=say.start_mm + 0.5),
    )  # fmt: skip
    seen = made.seen
    off = seen.state.index(DistanceState.TURNING_OFF)
    done = seen.state.index(DistanceState.INACTIVE, off)
    assert set(seen.interpolated_mm[off:done]) == {say.start_mm}
    assert seen.interpolated_mm[done + 2] > say.start_mm


@pytest.mark.parametrize("is_optimized", [False, True])
def test_an_offset_is_there_until_the_last_of_it_was_sent(
    distance_bench: Make, is_optimized: bool
) -> None:
    """Without P-AXIS-00509 a cycle later than the control has it; twice, up and down."""
    axis = distance_bench(is_optimized=is_optimized).channel.distance.axes["Z"]
    for offset_mm in (1.0, -0.5):
        seen = []
        for axis.control.offset_mm in (0.0, offset_mm, 0.0, 0.0, 0.0):
            seen.append((axis.put_out(), axis.has_offset, axis.is_on_its_way, axis.is_idle))
        late = [(0.0, True, False, False), (offset_mm, True, True, False)]
        at_once = [(offset_mm, True, False, False), (0.0, False, False, True)]
        none = (0.0, False, False, True)
        assert seen == [none, *(at_once if is_optimized else late), none, none]


@pytest.mark.long
@pytest.mark.parametrize("has_other", [False, True])
def test_the_end_of_a_program_waits_for_an_offset_that_runs_out(
    distance_bench: Make, say: Any, words: Any, has_other: bool
) -> None:
    """Whatever the control of another axis does."""
    rests = AxisDistanceSettings(DistanceSettings(), SensorSettings(), is_optimized=True)
    more = (words.axis("W", distance=rests),) if has_other else ()
    made = distance_bench(raised, more=more, v_max_mm_s=5.0)
    made.run(on(say), say.dwell(300), say.command("off"))
    assert made.seen.offset_mm[-1] == 0.0
    assert made.control.state is DistanceState.INACTIVE
    assert made.alarm_ids == []


@pytest.mark.provokes(70332, 1, axis="Z")
def test_what_is_still_on_at_the_end_stays_on_and_is_told(distance_bench: Make, say: Any) -> None:
    made = distance_bench(raised)
    made.run(on(say), say.dwell(300))
    assert made.alarm_ids == [70332]
    assert made.control.state is DistanceState.ACTIVE
    assert made.control.offset_mm == pytest.approx(HEIGHT_MM, abs=1e-4)


@pytest.mark.long
def test_a_program_ends_without_waiting_for_a_surface_that_moves(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """The axis lags behind its offset all the time: no exact stop could be reached."""
    made = distance_bench(
        lambda time_ns: (time_ns // MS % 400 - 200) * 0.005,
        spec={"kv": 20.0, "settling_ns": 50 * MS}, v_max_mm_s=20.0,
    )  # fmt: skip
    made.run(on(say), say.dwell(300), words.move(3, 600.0, Z=say.start_mm + 0.5))
    assert made.alarm_ids == [70332]
    assert made.seen.time_ns[-1] < 500 * MS


@pytest.mark.long
def test_frozen_the_axis_is_asked_for_its_exact_stop_as_ever(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(raised, spec={"kv": 20.0})
    made.run(
        on(say), say.dwell(300), say.command("freeze"), words.move(3, 600.0, Z=say.start_mm + 0.5)
    )
    seen, lag = made.seen, made.bench.links[-1].lag_mm
    assert abs(lag) <= 0.001
    assert seen.state[-1] is DistanceState.FREEZE
    assert seen.offset_mm[-1] == pytest.approx(HEIGHT_MM, abs=1e-4)


@pytest.mark.parametrize("mode", ["on", "on_const"])
def test_dryrun_computes_everything_and_moves_nothing(
    distance_bench: Make, say: Any, mode: str
) -> None:
    made = distance_bench(raised, kp=0.3)
    made.run(
        say.command(mode, set_pos_mm=0.0, set_dist_mm=say.start_mm, dry_run=True), say.dwell(50),
        say.command("off"),
    )  # fmt: skip
    assert set(made.seen.offset_mm) == {0.0}
    assert set(made.seen.sent_mm) == {say.start_mm}
    wanted = DistanceState.ACTIVE if mode == "on" else DistanceState.ACTIVE_CONST_DIST
    assert wanted in made.seen.states()
    assert made.alarm_ids == []


@pytest.mark.long
def test_a_frozen_offset_is_part_of_an_actual_position_that_is_adopted(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(raised)
    made.run(
        on(say), say.dwell(300), say.command("freeze"),
        canon.AdoptActual(Block(4, 40, "N40"), ("Z",)), say.dwell(20),
        words.move(5, 600.0, Z=say.start_mm + 1.0), say.command("off", wait=True),
    )  # fmt: skip
    seen = made.seen
    frozen = seen.state.index(DistanceState.FREEZE)
    before, after = seen.sent_mm[frozen + 5], seen.sent_mm[frozen + 15]
    assert after == pytest.approx(before, abs=1 / say.per_mm)
    assert seen.sent_mm[-1] == say.start_mm + 1.0
    assert made.alarm_ids == []


# Errors


@pytest.mark.provokes(900029, 7, axis="Z")
def test_an_error_of_the_axis_switches_it_off_and_its_offset_stays(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(raised)
    axis = made.bench.axes["Z"]

    def jump() -> None:
        axis.droop_m += 0.02

    made.at({300: jump})
    made.run(on(say), say.dwell(600))
    assert made.alarm_ids == [900029]
    seen = made.seen
    off = seen.state.index(DistanceState.INACTIVE, 10)
    assert off in (300, 301, 302)
    assert set(seen.offset_mm[off:]) == {seen.offset_mm[off]}
    assert seen.offset_mm[off] > 0.0


@pytest.mark.long
def test_an_error_of_another_axis_does_not_stop_it_before_the_axes_stand(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """X brakes for 0.1 s; the tool follows until it stands, then a reset switches off."""
    made = distance_bench(
        lambda time_ns: time_ns / 1e9, more=(words.axis("X", a_mm_s2=100.0),), kp=0.5
    )
    bench = made.bench

    def jump() -> None:
        bench.axes["X"].droop_m += 0.02

    made.at({300: jump})
    made.run(on(say), words.move(2, 600.0, X=200.0))
    assert made.alarm_ids == [900029]
    seen = made.seen
    assert set(seen.state[1:]) == {DistanceState.ACTIVE}
    assert seen.offset_mm[-1] - seen.offset_mm[300] == pytest.approx(0.1, abs=0.01)
    assert made.control.state is DistanceState.INACTIVE
    assert made.control.offset_mm == seen.offset_mm[-1]


@pytest.mark.long
@pytest.mark.provokes(900029, 7, axis="X")
def test_an_error_that_halts_every_axis_by_its_own_ramp_leaves_the_offset_where_it_is(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """P-CHAN-00218: X jumps, Z halts by a ramp of its own and has its offset in its position."""
    halts = ChannelSettings(each_axis_halts=True)
    made = distance_bench(raised, more=(words.axis("X"),), options={"settings": halts})
    plc, bench = made.channel.plc, made.bench
    turns: list[int] = []

    def turn() -> None:
        turns.append(0)
        if len(turns) == 300:
            bench.axes["X"].droop_m += 0.02
        plc.wants_reset = len(turns) == 500

    plc.join(PlcParticipant(turn, outlives_program=True, is_idle=lambda: len(turns) > 800))
    made.run(on(say), say.dwell(600))
    assert made.alarm_ids == [900029, 900560]
    sent = made.seen.sent_mm[295:]
    assert max(sent) - min(sent) < 1e-9
    assert made.channel.path.position_acs_mm("Z") == pytest.approx(sent[-1], abs=1e-9)
    assert len(made.channel.resets_ns) == 1


# Monitoring with an offset


@pytest.mark.long
def test_the_offset_counts_as_a_set_position_for_lag_and_jump(
    distance_bench: Make, say: Any
) -> None:
    """20 mm of offset at 400 mm/s are neither a lag of 5 mm nor a jump."""
    made = distance_bench(
        lambda time_ns: 20.0 if time_ns > 200 * MS else 0.0,
        v_max_mm_s=400.0, options={"lag_limit_mm": 5.0}, kp=1.0,

    )  # fmt: skip
    made.run(on(say), say.dwell(500), say.command("off", wait=True))
    assert max(made.seen.offset_mm) == pytest.approx(20.0, abs=1e-4)
    assert made.alarm_ids == []


@pytest.mark.provokes(900036, 7, axis="Z")
def test_a_lag_behind_the_offset_is_a_lag(distance_bench: Make, say: Any) -> None:
    """The axis is held at a stop 1 mm above its place while the offset wants 20 mm."""
    made = distance_bench(
        lambda time_ns: 20.0 if time_ns > 200 * MS else 0.0,
        spec={"stop_mm": 11.0}, v_max_mm_s=400.0, options={"lag_limit_mm": 5.0}, kp=1.0,

    )  # fmt: skip
    made.run(on(say), say.dwell(500))
    assert made.alarm_ids == [900036]


@pytest.mark.long
@pytest.mark.parametrize("buffer_cycles", [0, 3])
def test_a_gantry_slave_takes_the_offset_over_with_its_master(
    distance_bench: Make, say: Any, words: Any, buffer_cycles: int
) -> None:
    made = distance_bench(
        raised, more=(words.axis("W", start_mm=-5.0, kv=1e9),),
        options={"buffer_cycles": buffer_cycles},
    )  # fmt: skip
    pair = canon.AxisPair(slave="W", master="Z", limits_mm=(0.05, 0.1))
    made.run(
        canon.AxisLinkOn(Block(1, 10, "N10"), 1, (pair,)), on(say), say.dwell(300),
        say.command("off", no_move=True), say.dwell(10), words.move(5, 600.0, Z=20.0),
    )  # fmt: skip
    assert made.alarm_ids == []
    sent = [sample.sent_mm for sample in made.bench.samples]
    assert {round(z - w, 9) for w, z in sent[30:]} == {say.start_mm + 5.0}
    assert sent[-1] == (5.0, 20.0)


@pytest.mark.parametrize(
    ("couples_first", "parts", "buffer_cycles"),
    [(True, "off", 0), (True, "end", 3), (False, "off", 3), (False, "never", 0)],
)
def test_a_slave_stays_where_its_coupling_begins_and_ends_while_an_offset_is_there(
    distance_bench: Make,
    say: Any,
    words: Any,
    couples_first: bool,
    parts: str,
    buffer_cycles: int,
) -> None:
    """It moves by what the offset of its master changes by while it is coupled: from 0 to 0.75 mm
    with the surface, and back to 0 when the control runs out.
    """
    made = distance_bench(
        raised, more=(words.axis("W", start_mm=-5.0, kv=1e9),), v_max_mm_s=100.0,
        options={"buffer_cycles": buffer_cycles, "lag_limit_mm": 5.0},
    )  # fmt: skip
    block = Block(1, 10, "N10")
    pair = canon.AxisPair(slave="W", master="Z", limits_mm=(0.5, 1.0))
    couple = canon.AxisLinkOn(block, 1, (pair,))
    rise = [on(say), say.dwell(80), say.command("freeze"), say.dwell(5)]
    begin = [couple, *rise] if couples_first else [*rise, couple, say.dwell(5)]
    part = [canon.AxisLinkOff(block, 1), say.dwell(5)] if parts == "off" else []
    off = [] if parts == "end" else [say.command("off", wait=True)]
    made.run(*begin, *part, *off)
    w, z = zip(*[sample.sent_mm for sample in made.bench.samples], strict=True)
    assert made.alarm_ids == [70332] * (parts == "end")
    most = max(abs(b - a) for a, b in itertools.pairwise(z[30:]))
    assert max(abs(b - a) for a, b in itertools.pairwise(w[30:])) <= most + 1e-9 < 0.11
    risen_mm = HEIGHT_MM * couples_first - HEIGHT_MM * (parts == "never")
    assert w[-1] == pytest.approx(-5.0 + risen_mm, abs=1e-4)


@pytest.mark.long
def test_a_gantry_slave_follows_the_offset_of_its_master(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(raised, more=(words.axis("W", start_mm=-5.0, kv=1e9),))
    pair = canon.AxisPair(slave="W", master="Z", limits_mm=(0.5, 1.0))
    made.run(
        canon.AxisLinkOn(Block(1, 10, "N10"), 1, (pair,)), on(say), say.dwell(300),
        say.command("off", wait=True),
    )  # fmt: skip
    assert made.alarm_ids == []
    sent = [sample.sent_mm for sample in made.bench.samples]
    assert max(w for w, _ in sent) == pytest.approx(-5.0 + HEIGHT_MM, abs=1e-4)
    assert sent[-1] == (-5.0, say.start_mm)
