"""In which row of a recording a set position has the offset of distance control.

The invariants of the scenarios take the path out of both. A path of the lists gains at most a T^2
from row to row; with the offset of another row its changes would be left over.
"""

import numpy as np
import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.tools.scenarios.campaign import examine
from axisrig.bench.tools.scenarios.scenario import make_scenario
from axisrig.kernel.time.clock import S

INCREMENT_MM = 10 / 2**20  # lead 10 mm


@pytest.mark.long
@pytest.mark.parametrize(
    ("machine", "number", "column", "rows_before", "a_mm_s2"),
    [
        ("distance", 0, "offset_mm", 1, 800.0),
        ("ethercat-distance", 0, "offset_mm", 1, 800.0),
        ("profidrive-distance", 0, "offset_mm", 1, 800.0),
        ("distance-3d", 0, "superposed_mm", 0, 0.0),  # Z is not programmed
        ("distance-3d", 2, "superposed_mm", 0, 0.0),
    ],
)
def test_what_is_left_without_the_offset_is_a_path_of_the_lists(
    machine: str, number: int, column: str, rows_before: int, a_mm_s2: float
) -> None:
    largest_mm: dict[int, float] = {}

    def look(run: Machine) -> None:
        series = run.recorder.series()
        set_mm, offset_mm = (series.column(f"Z.{name}") for name in ("set_mm", column))
        led = slice(np.searchsorted(series.column("time_ns"), S // 10), None)
        for rows in (0, 1):
            offset_then = np.concatenate((offset_mm[:rows], offset_mm[: len(offset_mm) - rows]))
            path_mm = (set_mm - offset_then)[led]
            largest_mm[rows] = float(np.max(np.abs(np.diff(path_mm, 2))))

    examine(make_scenario(1, number, machine), look)
    allowed_mm = a_mm_s2 * 1e-6 + INCREMENT_MM  # cycles of 1 ms
    assert largest_mm[rows_before] <= allowed_mm < largest_mm[1 - rows_before]
