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


@pytest.mark.provokes(900037, 7, axis="Z", time_ms="50")
@pytest.mark.parametrize("begins", ["motion+5ms", "motion+400ms"])
@pytest.mark.parametrize(
    "rig",
    [
        "probe-z-velocity.toml",
        pytest.param("probe-z-profidrive.toml", marks=pytest.mark.long),
        pytest.param("probe-z-encoder-terminal.toml", marks=pytest.mark.long),
        pytest.param("probe-z-lightbus.toml", marks=pytest.mark.long),
        pytest.param("probe-z-conventional.toml", marks=pytest.mark.long),
    ],
)
def test_an_axis_whose_encoder_freezes_stops_with_its_set_positions(
    tmp_path: Path, rig: str, begins: str
) -> None:
    """Truth of the plant: in the last 50 ms after the alarm the load has not moved by 10 um."""
    program = tmp_path / "way.nc"
    program.write_text(WAY, encoding="utf-8")
    texts = (
        f"fault:encoder_freeze=Z at={begins}", "plant:z.position_start_mm=102",
        "plc:after_end_ms=400",
    )  # fmt: skip
    assigned = [(parse_assignment(text), as_written) for text in texts]
    machine = Machine(read_settings(*read_rig(RIGS / rig), assigned), read_program(program, ("Z",)))
    try:
        machine.run()
        alarms = [alarm.id for alarm in machine.channel.alarms]
        observed = Observed(facts_of(machine), machine.recorder.series())
        instants = observed.instants(slice(None))
        truth_mm = observed.column("Z", "truth_mm")
    finally:
        machine.close()
    assert alarms[0] == 900037
    late = truth_mm[instants >= instants[-1] - AT_REST_NS]
    assert np.ptp(late) < AT_REST_MM
    assert instants[-1] - machine.channel.alarm_ns[0] > 300 * MS
