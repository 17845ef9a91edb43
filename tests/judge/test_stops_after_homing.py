"""A run to a fixed stop of a machine whose zero is not that of the plant: all is found as without.

Homing (G74) lets the drive count from another place. The plant's truth and its stop are shifted by
it, what the machine reports is not.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest
from tests.judge.stop_recordings import (
    DETECT,
    FORCE_N,
    K_N_M,
    LATCHED_MM,
    LOAD,
    RUN,
    STOP_MM,
    recorded,
    seen,
)

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.metrics import STOP_METRICS
from axisrig.bench.judge.fixed_stop.stop_findings import StopFindings
from axisrig.bench.judge.observed.observed import Observed
from axisrig.kernel.time.clock import MS

ZERO_MM = 7.5
DAMPED = {"viscous_friction": 1e5, "coulomb_friction": 50.0, "weight": 20.0}
LISTS: Mapping[str, Mapping[str, Any]] = {
    "a lag": {},
    "a window too": {DETECT + "max_delta_position_window": 1500},
    "a small window": {DETECT + "pos_lag_limit": 0, DETECT + "max_delta_position_window": 500},
    "an arming path": {DETECT + "start_distance": 19_000},
    "a share of the block": {
        DETECT + "start_distance": 19_000, DETECT + "start_distance_per_mille": 300,
    },
}  # fmt: skip


def homed(side: float, zero_mm: float, written: Mapping[str, Any], *homed_ms: int) -> Observed:
    """homed_ms: when; the run begins at 10 ms."""
    of = recorded(
        side,
        plant={**DAMPED, "stop_position": (STOP_MM + side * zero_mm) * 1e-3},
        written=written,
        columns={"truth_mm": side * LOAD + zero_mm},
    )
    axis = replace(
        of.facts.axes["Z"], origin_mm=zero_mm, homed_ns=tuple(ms * MS for ms in homed_ms)
    )
    facts = replace(of.facts, axes={**of.facts.axes, "Z": axis})
    return Observed(facts, of.series)


def numbers(block: StopFindings) -> dict[str, Any]:
    """Every number of a block by its name."""
    found: dict[str, Any] = {"block": block.end_ns, "limits": block.limits["Z"].arming_mm}
    for mark in block.marks:
        instants = (mark.measured_ns, mark.oracle_ns, mark.low_ns, mark.high_ns)
        found |= {f"{mark.key} {n}": instant for n, instant in enumerate(instants)}
    for value in block.values:
        sizes = (value.measured, value.expected, value.low, value.high)
        found |= {f"{value.key} {n}": size for n, size in enumerate(sizes)}
    return found


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("name", LISTS)
def test_a_stop_is_found_the_same_wherever_the_drive_counts_from(name: str, side: float) -> None:
    blocks = [
        stop_findings(homed(side, zero_mm, LISTS[name], *at))[0]
        for zero_mm, at in ((0.0, ()), (ZERO_MM, (5,)), (-ZERO_MM, (3, 8)))
    ]
    plain, *others = (numbers(block) for block in blocks)
    for found in others:
        assert set(found) == set(plain)
        wrong = {
            key: (value, plain[key])
            for key, value in found.items()
            if value != pytest.approx(plain[key], abs=20 if isinstance(value, int) else 1e-9)
        }
        assert not wrong
    assert [(block.notes, block.prediction) for block in blocks[1:]] == 2 * [
        (blocks[0].notes, blocks[0].prediction)
    ]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_what_was_latched_is_expected_in_positions_of_the_machine(side: float) -> None:
    """x_stop - zero + d (F_lim - d F_g -+ F_c)/k -+ 1 um with the direction d of the stop."""
    (block,) = stop_findings(homed(side, ZERO_MM, {}, 5))
    (latched,) = [value for value in block.values if value.key == "latched"]
    assert latched.measured == pytest.approx(side * LATCHED_MM)
    ends = [
        side * (STOP_MM + (FORCE_N - side * 20.0 + friction_n) / K_N_M * 1e3)
        for friction_n in (-50.0, 50.0)
    ]
    assert latched.low == pytest.approx(min(ends) - 1e-3)
    assert latched.high == pytest.approx(max(ends) + 1e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_each_metric_of_a_stop_is_the_same_wherever_the_drive_counts_from(side: float) -> None:
    plain, shifted = homed(side, 0.0, {}), homed(side, ZERO_MM, {}, 5)
    for metric in STOP_METRICS:
        if metric == "detection_criterion":
            continue
        one, other = seen(plain, metric), seen(shifted, metric)
        assert one.value is not None, metric
        assert other.value == pytest.approx(one.value, abs=1e-6), metric
        assert other.uncertainty == pytest.approx(one.uncertainty, abs=1e-6), metric


def test_between_two_homings_nobody_knows_the_zero() -> None:
    """What the first one set is not kept; after both it is known, before both it is 0."""
    for at, is_known in (((5, 9), True), ((5, 320), False), ((310, 320), True)):
        of = homed(1.0, ZERO_MM if at[0] == 5 else 0.0, {}, *at)
        if at[0] == 310:  # the origin is of what came after the run
            axis = replace(of.facts.axes["Z"], origin_mm=ZERO_MM)
            of = Observed(replace(of.facts, axes={"Z": axis}), of.series)
        assert (of.zero_mm("Z", RUN) is not None) is is_known
        found = seen(of, "latch_force_error_um")
        assert (found.value is not None) is is_known, at
        if is_known:
            assert found.value == pytest.approx(0.4, abs=1e-6)
