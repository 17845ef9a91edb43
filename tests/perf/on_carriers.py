"""A row on CAN beside the same on EtherCAT: `python -m tests.perf.on_carriers [TURNS]`.

From the root of a checkout, by the Python of the build that is to be measured. One process, in
turns; CPU time of a run without files, the median counts.
"""

import sys
import time
from dataclasses import replace
from pathlib import Path
from statistics import median

from axisrig.bench.campaign.results.build_info import is_compiled
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only

PLANS = Path("testplans")
TURNS = 9
REACH = {True: 1.2, False: 2.0}
"""The most that EtherCAT may take, compiled and interpreted."""


def main(turns: int) -> None:
    """Print both medians and their ratio."""
    on_can = only(read_plan(PLANS / "latch_accuracy.csv").cases, "f600")
    rig = PLANS / "rigs" / "probe-z-ethercat.toml"
    cases = {"CAN": on_can, "EtherCAT": replace(on_can, rig=rig.resolve())}
    taken: dict[str, list[float]] = {name: [] for name in cases}
    for turn in range(turns + 1):
        for name, case in cases.items():
            begin_s = time.process_time()
            result = run_case(case, RunFiles())
            if turn:  # the first one loads what all share
                taken[name].append(time.process_time() - begin_s)
            assert result.facts is not None, result
            assert not result.facts.alarms, name
    can_ms, line_ms = (1e3 * median(times) for times in taken.values())
    compiled = is_compiled()
    build = "compiled" if compiled else "interpreted"
    ratio = f"ratio {line_ms / can_ms:.2f} ({REACH[compiled]:g} at most)"
    print(f"{build}: CAN {can_ms:.0f} ms, EtherCAT {line_ms:.0f} ms, {ratio}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else TURNS)
