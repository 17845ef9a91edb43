"""The functions of a run by their own time."""

import cProfile
import re
from itertools import count
from pathlib import Path

from axisrig.bench.campaign.results.build_info import build_word, is_compiled, sources_sha256
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.bench.tools.perf.profile import SHOWN, profile_row

PLAN = Path(__file__).parents[2] / "testplans/latch_accuracy.csv"


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
