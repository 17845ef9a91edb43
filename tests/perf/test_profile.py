"""The functions of a run by their own time, and the stages of a next run."""

import cProfile
import re
from itertools import count
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.build_info import build_word, is_compiled, sources_sha256
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.bench.tools.perf.profile import SHOWN, profile_row
from axisrig.bench.tools.perf.stages import REST, SIMULATION, STAGES, measure_stages, show_stages

PLAN = Path(__file__).parents[2] / "testplans/latch_accuracy.csv"


@pytest.mark.long
def test_a_profile_names_functions_with_their_modules() -> None:
    ticks = count(0, 1000)
    clock = Clocks(lambda: next(ticks), lambda: next(ticks))
    text = profile_row(PLAN, "actuated", clock, cProfile.Profile)
    lines = text.splitlines()
    assert lines[0].startswith("latch_accuracy-actuated: 7")
    assert len(lines) == 2 + SHOWN + 1
    own_us = [float(line.split()[0]) for line in lines[2:-1]]
    assert own_us == sorted(own_us, reverse=True)
    assert is_compiled() or re.search(r"  (bench|kernel)\.[\w.]+$", text, re.MULTILINE)
    assert lines[-1] == f"axisrig {build_word()}, sources {sources_sha256()}"


@pytest.mark.long
def test_stages_of_a_next_run_add_up_to_all_of_it() -> None:
    """With a clock that goes on by 1 ms whenever it is read, one run."""
    ticks = count(0, 1_000_000)
    clock = Clocks(lambda: next(ticks), lambda: next(ticks))
    found = measure_stages(PLAN, "actuated", 1, clock)
    assert set(found["stages_ms"]) == {*STAGES, REST} - {SIMULATION}
    own_ms = [spent for stage, spent in found["stages_ms"].items() if stage != REST]
    assert all(spent >= 1.0 for spent in own_ms)  # each was called
    assert sum(found["stages_ms"].values()) == found["beyond_simulation_ms"]
    lines = show_stages(found).splitlines()
    assert lines[2].startswith("| files of the run before removed | ")
    assert lines[-1].startswith("latch_accuracy-actuated, CPU time, median of 1; axisrig ")
