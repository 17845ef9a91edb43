"""Words and numbers of a tuning in which no two counts are the same, mode by mode."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.tune.test_findings import found, mode

from axisrig.bench.tools.tune.distance import BOTH_ENCODERS, CONST_DIST, SET_POS, DeadTime
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.loop import Law
from axisrig.bench.tools.tune.report import data_of, text_of, warnings_of

APART = DeadTime(reaction=3, way=5, renewal=2, way_ns=4_250_000)
"""n = 7."""


def sections(text: str) -> dict[str, list[str]]:
    """The lines of each mode, below its name; parts are apart by an empty line."""
    parts = [part.splitlines() for part in text.split("\n\n")]
    return {lines[0].split(" (chosen")[0]: lines[1:] for lines in parts if lines[0][:1] != " "}


def test_each_mode_is_a_part_of_its_own_and_only_a_constant_distance_lags_a_slope() -> None:
    """T/kp: 1 ms/0.25 are 4 um for each mm/s."""
    parts = sections(text_of(found()))
    assert list(parts)[-3:] == [CONST_DIST, BOTH_ENCODERS, SET_POS]
    for name in (CONST_DIST, BOTH_ENCODERS, SET_POS):
        lines = parts[name]
        assert lines[0].startswith("  stable for  kp < ")
        slopes = [line for line in lines if "error on a slope" in line]
        assert len(slopes) == (name == CONST_DIST)
        assert sum("noise of the offset" in line for line in lines) == 1
    assert "error on a slope 4 um for each mm/s of rise" in "\n".join(parts[CONST_DIST])


@pytest.mark.parametrize(("renewal", "is_late"), [(1, False), (2, True), (3, True)])
def test_a_value_that_is_not_new_in_each_cycle_is_named_as_the_oldest(
    renewal: int, is_late: bool
) -> None:
    text = text_of(found(dead_time=replace(APART, renewal=renewal)))
    assert ("seen 5 cycles after that at the latest" in text) is is_late
    assert (f"the value is new every {renewal} cycles; the oldest counts" in text) is is_late
    assert "n = 7 cycles: an offset is sent 3 cycles later and is seen 5 cycles after that" in text
    assert "frames: 4.250 ms from set position to sensor value" in text


def test_a_loop_that_is_unstable_is_warned_of_with_all_its_dead_cycles() -> None:
    modes = (mode(CONST_DIST, 0.1, is_stable=False), mode(BOTH_ENCODERS, 1.0), mode(SET_POS, 2.0))
    (words,) = warnings_of(found(modes=modes, dead_time=APART))
    assert "is unstable with 7 cycles of dead time: only kp below 0.1 is stable" in words
    one = DeadTime(0, 2, 1, None)
    (words,) = warnings_of(found(modes=modes, dead_time=one))
    assert "with 1 cycle of dead time" in words


def test_the_data_of_a_tuning_have_each_count_under_its_own_name() -> None:
    """An answer of 0.2, 0.7 and 0.1 in cycles 3, 4 and 6: begun at 3, 98 % at 6, centre 4."""
    answer = np.zeros(10)
    answer[[3, 4, 6]] = 0.2, 0.7, 0.1
    given: dict[str, Any] = {
        "dead_time": APART,
        "distance": Path(answer, 2e-5, 0.0),
        "actual": Path(answer, 7e-5, 0.0),
    }
    data = data_of(found(Law(0.2, 0.1, 0.002), **given))
    counts = {name: data[f"{name}_cycles"] for name in ("dead", "reaction", "way", "renewal")}
    assert counts == {"dead": 7, "reaction": 3, "way": 5, "renewal": 2}
    assert (data["way_ns"], data["noise_mm"]) == (4_250_000, 2e-5)
    assert data["answer"] == {
        "is_dead_time": False, "settled_cycles": 6, "mean_cycles": pytest.approx(4.0),
        "gain": pytest.approx(1.0),
    }  # fmt: skip
    words = text_of(found(**given))
    assert "98 % after 6 cycles, centre 4.0 cycles (4.0 ms)" in words
