"""Every measure that has a number to reach, in turns: `python -m tests.perf.suite`.

Either interpreter, from the root of a checkout: `.venv/bin/python` or `.venv-fast/bin/python`.
`--bus`, `--fmu` and `--parse` time frames, steps and NC text by themselves instead.
"""

import argparse
import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from tests.perf.measures import read_suite, run_suite, selected
from tests.perf.suite_text import gains, markdown, read_suite_result, show_gains, show_suite

from axisrig.bench.cli.perf_command import cpu_ns
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.kernel.errors import UserError

REPEATS, TURNS = 5, 9


def _words(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.perf.suite", description=__doc__)
    parser.add_argument("-k", dest="only", help="only measures with this in their name or kind")
    parser.add_argument("--plans", type=Path, default=Path("testplans"), help="folder of the plans")
    parser.add_argument("--repeats", type=int, help=f"turns; {TURNS}, of one thing {REPEATS}")
    parser.add_argument("--json", action="store_true", help="one JSON object")
    parser.add_argument("--markdown", action="store_true", help="the table of docs/performance.md")
    parser.add_argument("--against", type=Path, help="what --json printed before: ratios to it")
    for name in ("bus", "fmu", "parse"):
        parser.add_argument(f"--{name}", action="store_true", help="time this by itself")
    return parser.parse_args(arguments)


def _alone(words: argparse.Namespace) -> str | None:
    """Time one thing by itself; None where the suite is asked for."""
    runs, clock = words.repeats or REPEATS, time.perf_counter_ns
    if words.bus:
        from tests.perf.bus_perf import measure_bus, show_bus  # noqa: PLC0415

        return show_bus(measure_bus(runs, clock), words.json)
    if words.fmu:
        from tests.perf.fmu_perf import measure_fmu, show_fmu  # noqa: PLC0415

        return show_fmu(measure_fmu(runs, clock), words.json)
    if words.parse:
        from tests.perf.parse_perf import time_parse  # noqa: PLC0415

        return time_parse(runs, clock, words.json)
    return None


def report(arguments: Sequence[str] | None = None) -> str:
    """Measure, and return what is printed; what is under way shows on standard error.

    Raises UserError for what cannot be measured.
    """
    words = _words(arguments)
    alone = _alone(words)
    if alone is not None:
        return alone
    before = None if words.against is None else read_suite_result(words.against)
    clocks = Clocks(time.perf_counter_ns, cpu_ns)

    def show(done: int, total: int, name: str) -> None:
        print(f"{done}/{total} {name}", file=sys.stderr)

    measures = selected(read_suite(), words.only)
    result = run_suite(measures, words.plans, words.repeats or TURNS, clocks, show)
    if words.json:
        more = {} if before is None else {"gains": gains(result, before)}
        return json.dumps(result | more)
    text = markdown(result) if words.markdown else show_suite(result)
    return text if before is None else f"{text}\n\n{show_gains(result, before)}"


if __name__ == "__main__":
    try:
        print(report())
    except UserError as error:
        sys.exit(f"error: {error}")
