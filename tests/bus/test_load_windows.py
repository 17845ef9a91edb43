"""The worst window is never an artefact of where the windows begin."""

import pytest

from axisrig.bench.bus.can.load import LoadMeter
from axisrig.kernel.time.clock import MS


def test_a_run_shorter_than_the_window_is_judged_by_its_own_length() -> None:
    """45 ms of a bus that is never idle are 100 %, not 45."""
    meter = LoadMeter(1_000_000)
    meter.occupy(0, 45 * MS, 45_000)
    load = meter.figures(45 * MS)
    assert (load.busy_share, load.worst_100ms_share) == (1.0, 1.0)


def test_the_worst_window_lies_anywhere() -> None:
    """80 ms of load around 100 ms are 80 % of the window from 60 to 160 ms."""
    meter = LoadMeter(1_000_000)
    meter.occupy(60 * MS, 140 * MS, 80_000)
    load = meter.figures(300 * MS)
    assert load.worst_100ms_share == pytest.approx(0.8)
    assert load.worst_100ms_bits == 80_000


def test_an_even_load_is_the_same_in_every_window() -> None:
    meter = LoadMeter(1_000_000)
    for ms in range(150):
        meter.occupy(ms * MS, ms * MS + 300_000, 300)
    load = meter.figures(150 * MS)
    assert load.worst_100ms_share == pytest.approx(load.busy_share) == pytest.approx(0.3)
