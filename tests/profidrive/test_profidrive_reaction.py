"""Delay from an edge to the reaction of the control, and the value, at random instants.

The drive has latched t_d after the edge t; the first sample not before that is at m T - T_I, its
telegram is swapped at m T + T_DX, and the NC cycle at m T + C sees it: C + T_I after the sample,
and 0 to T more. The function is activated and read by the handshake of G1_STW and G1_ZSW.
"""

import random

import pytest
from tests.profidrive.ends import Ends

from axisrig.bench.bus.cyclic.segment import Instants
from axisrig.kernel.time.clock import MS, US

DELAY_NS = 4 * US
SPEED_MM_S = 10.0
START_MM = 5.0


def position_m(time_s: float) -> float:
    """At rest for 20 ms, then up and down."""
    moving_s = max(0.0, time_s - 0.02)
    return (START_MM + 2.0 - abs(SPEED_MM_S * ((moving_s + 0.2) % 0.8) - 4.0)) * 1e-3


@pytest.mark.parametrize(
    ("times", "count"),
    [
        ((MS, 0, 0, 0, 600), 40),
        pytest.param((MS, 0, 0, 0, 600), 400, marks=pytest.mark.long),
        pytest.param((4 * MS, 700, 150, 250, 2400), 400, marks=pytest.mark.long),
    ],
)
@pytest.mark.parametrize("edge", ["POS", "NEG"])
@pytest.mark.parametrize("telegram", [3, 5])
def test_each_edge_is_seen_in_the_cycle_of_the_formula(
    telegram: int, edge: str, times: tuple[int, int, int, int, int], count: int
) -> None:
    period_ns, input_us, bus_us, output_us, cycle_us = times
    at, cycle_ns = Instants(period_ns, input_us * US, bus_us * US, output_us * US), cycle_us * US
    numbers, edges = random.Random(37), list[int]()
    for _ in range(count):
        last_ns = edges[-1] if edges else 24 * period_ns
        rises_ns = last_ns + 16 * period_ns + numbers.randrange(4 * period_ns)
        edges += [rises_ns, rises_ns + 2 * period_ns]
    ends = Ends(telegram, position_m, edges, at, cycle_ns, edge)
    found: list[tuple[int, float]] = []
    stored_ns = 0
    while len(found) < count and ends.number < count * 48:
        link = ends.cycle()
        if link.has_latched and not stored_ns:
            stored_ns = (ends.number - 1) * period_ns + cycle_ns
        if link.is_clear:
            link.arm()
        elif link.latched_mm is not None and link.is_probing:
            found.append((stored_ns, link.latched_mm))
            stored_ns = 0
            link.disarm()
        link.send(link.actual_mm)
    phases = set()
    for (seen_ns, value_mm), each_ns in zip(found, edges[edge == "NEG" :: 2], strict=True):
        sample = -(-(each_ns + DELAY_NS + at.input_ns) // period_ns)
        assert seen_ns == sample * period_ns + cycle_ns
        true_mm = position_m((each_ns + DELAY_NS) * 1e-9) * 1e3
        assert abs(value_mm - true_mm) <= 0.5 / float(ends.table.per_mm) + 1e-9
        phases.add((each_ns % period_ns) * 10 // period_ns)
    assert count < 400 or phases == {*range(10)}
