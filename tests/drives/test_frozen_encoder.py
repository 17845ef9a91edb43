"""An encoder that freezes under a loop closed over it: seen by its rule, and the axis stops."""

from pathlib import Path

import numpy as np
import pytest

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.drives.frozen_encoder import FrozenEncoder
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
WAY = """%way
N10 G90 G01 Z90 F600
N20 M30
"""
AT_REST_MM, AT_REST_NS = 0.010, 50 * MS
"""As `axisrig scenarios` judges it (`rest`)."""


LOSS_MAX = 1_000_000
"""Increments that `encoder_loss` takes at most."""


def frozen_after(speed_mm_s: float, per_mm: float, period_s: float, cycles: int) -> list[bool]:
    encoder, seen = FrozenEncoder(per_mm, period_s), []
    for _ in range(cycles):
        encoder.note(speed_mm_s, 1234)
        seen.append(encoder.is_frozen)
    return seen


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("period_s", [1e-3, 2e-3, 4e-3])
def test_an_encoder_is_frozen_after_50_ms_without_a_count(period_s: float, sign: int) -> None:
    """The first cycle only notes the position; at 4 ms 12.5 cycles are 13."""
    cycles = {1e-3: 50, 2e-3: 25, 4e-3: 13}[period_s]
    seen = frozen_after(sign * 10.0, 1000.0, period_s, cycles + 1)
    assert seen == [False] * cycles + [True]


@pytest.mark.parametrize(
    ("per_mm", "least_mm_s"),
    [(100_000.0, 0.2), (1000.0, 0.2), (409.6, 0.2), (200.0, 0.4), (10.0, 8.0)],
)
def test_a_speed_that_friction_or_an_increment_explains_is_no_sign(
    per_mm: float, least_mm_s: float
) -> None:
    """10 um or 4 increments in 50 ms: 0.2 mm/s, and 8 mm/s where an increment is 0.1 mm."""
    assert not any(frozen_after(0.99 * least_mm_s, per_mm, 1e-3, 1000))
    assert frozen_after(1.01 * least_mm_s, per_mm, 1e-3, 1000)[-1]


def test_one_count_one_slow_cycle_or_a_stop_by_order_begins_anew() -> None:
    for interrupts in ("count", "slow", "order"):
        encoder = FrozenEncoder(1000.0, 1e-3)
        for cycle in range(200):
            is_turn = cycle % 49 == 48
            if is_turn and interrupts == "order":
                encoder.forget()
            slow, counts = is_turn and interrupts == "slow", is_turn and interrupts == "count"
            encoder.note(0.0 if slow else 5.0, cycle if counts else 0)
            assert not encoder.is_frozen, interrupts


RIGS_WITH_A_LOOP = (
    "probe-z-velocity.toml",
    pytest.param("probe-z-profidrive.toml", marks=pytest.mark.long),
    pytest.param("probe-z-encoder-terminal.toml", marks=pytest.mark.long),
    pytest.param("probe-z-lightbus.toml", marks=pytest.mark.long),
    pytest.param("probe-z-conventional.toml", marks=pytest.mark.long),
)


def machine_of(tmp_path: Path, rig: str, *texts: str) -> Machine:
    program = tmp_path / "way.nc"
    program.write_text(WAY, encoding="utf-8")
    assigned = [(parse_assignment(text), as_written) for text in texts]
    return Machine(read_settings(*read_rig(RIGS / rig), assigned), read_program(program, ("Z",)))


def increments_per_mm(tmp_path: Path, rig: str) -> float:
    machine = machine_of(tmp_path, rig)
    try:
        return facts_of(machine).axes["Z"].increments_per_mm
    finally:
        machine.close()


def run(
    tmp_path: Path, rig: str, fault: str, *more: str
) -> tuple[int, np.ndarray, np.ndarray, int]:
    """The first alarm, instants and truth of the plant, shape (n,), and when the alarm came."""
    more = ("plant:z.position_start_mm=102", "plc:after_end_ms=400", *more)
    machine = machine_of(tmp_path, rig, f"fault:{fault}", *more)
    try:
        machine.run()
        observed = Observed(facts_of(machine), machine.recorder.series())
        instants, truth_mm = observed.instants(slice(None)), observed.column("Z", "truth_mm")
        return machine.channel.alarms[0].id, instants, truth_mm, machine.channel.alarm_ns[0]
    finally:
        machine.close()


def assert_at_rest(instants: np.ndarray, truth_mm: np.ndarray, alarm_ns: int) -> None:
    """In the last 50 ms, more than 300 ms after the alarm, the load has not moved by 10 um."""
    late = truth_mm[instants >= instants[-1] - AT_REST_NS]
    assert np.ptp(late) < AT_REST_MM
    assert instants[-1] - AT_REST_NS - alarm_ns > 300 * MS


@pytest.mark.long
@pytest.mark.provokes(900037, 7, axis="Z", time_ms="50")
@pytest.mark.parametrize("begins", ["motion+5ms", "motion+400ms"])
@pytest.mark.parametrize("rig", RIGS_WITH_A_LOOP)
def test_an_axis_whose_encoder_freezes_stops_with_its_set_positions(
    tmp_path: Path, rig: str, begins: str
) -> None:
    alarm, instants, truth_mm, alarm_ns = run(tmp_path, rig, f"encoder_freeze=Z at={begins}")
    assert alarm == 900037
    assert_at_rest(instants, truth_mm, alarm_ns)


@pytest.mark.long
@pytest.mark.parametrize("rig", RIGS_WITH_A_LOOP)
def test_an_axis_whose_encoder_jumps_is_not_led_to_where_it_says(tmp_path: Path, rig: str) -> None:
    """10 mm of counts (2.4 mm with the finest encoder) are lost at 10 mm/s. From the alarm on the
    load goes what the ramp of its list takes, v^2/2a, and v for the dead cycles and the speed
    loop, together below 1 mm.
    """
    per_mm = increments_per_mm(tmp_path, rig)
    fault = f"encoder_loss=Z increments={min(round(10 * per_mm), LOSS_MAX)} at=motion+400ms"
    alarm, instants, truth_mm, alarm_ns = run(tmp_path, rig, fault)
    assert alarm == 900029
    assert_at_rest(instants, truth_mm, alarm_ns)
    assert np.ptp(truth_mm[instants >= alarm_ns]) < 1.0


@pytest.mark.parametrize("rig", RIGS_WITH_A_LOOP)
@pytest.mark.long
def test_after_a_reset_the_axis_goes_on_without_a_leap(tmp_path: Path, rig: str) -> None:
    """The encoder is back before the reset: the next program goes to its end, no faster than it.

    At 10 mm/s a cycle of 1 ms is 0.010 mm; a lag of v/Kv that were led at once is Kv times it.
    """
    alarm, instants, truth_mm, alarm_ns = run(
        tmp_path, rig, "encoder_freeze=Z at=motion+400ms for=300ms",
        "plc:reset=at=motion+900ms", "plc:program_start=at=reset+100ms",
    )  # fmt: skip
    assert alarm == 900037
    after = truth_mm[instants > alarm_ns + 350 * MS]
    assert np.max(np.abs(np.diff(after))) < 0.011
    assert truth_mm[-1] == pytest.approx(90.0, abs=AT_REST_MM)
