"""Where the CPU time of a cycle is: the functions of a run by their own time.

A compiled module shows as one call from outside: the profile of an interpreted one says more.
"""

import cProfile
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import CodeType

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.record.series import TIME
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.bench.tools.perf.perf import Row, build, build_line

SHOWN = 40


def profile_row(
    path: Path, name: str | None, clocks: Clocks, make_profile: Callable[[], cProfile.Profile]
) -> str:
    """Return a table of the functions of a run of a warm bench: own time and calls for each cycle.

    make_profile: gives a profile with its clock; a clock of Python's would cost more than a call.
    """
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        row = Row(path, name, Path(folder) / "out", clocks)
        row.run()
        files = RunFiles([Path(folder) / "run.blf"], Path(folder) / "run.parquet")
        profile = make_profile()
        result = profile.runcall(run_case, row.case, files)
        cycles = 1 if result.series is None else max(1, len(result.series.column(TIME)))
    stats = sorted(profile.getstats(), key=lambda entry: entry.inlinetime, reverse=True)
    whole_us = sum(entry.inlinetime for entry in stats) * 1e6 / cycles
    lines = [
        f"{row.case.run}: {cycles} cycles, {whole_us:.1f} us each under the profile, which itself"
        " costs: read the shares",
        "  own us   share   calls  function",
    ]
    for entry in stats[:SHOWN]:
        own_us = entry.inlinetime * 1e6 / cycles
        share = 100 * own_us / whole_us if whole_us else 0.0
        calls = entry.callcount / cycles
        lines.append(f"{own_us:8.2f}{share:6.1f} %{calls:8.2f}  {_name(entry.code)}")
    return "\n".join([*lines, build_line(build())])


def _name(code: CodeType | str) -> str:
    """Name a function with its module, a builtin as it says itself."""
    if isinstance(code, str):
        return code.strip("<>")
    parts = Path(code.co_filename).with_suffix("").parts
    if "axisrig" in parts:
        parts = parts[len(parts) - 1 - parts[::-1].index("axisrig") + 1 :]
    else:
        parts = parts[-2:]
    return f"{'.'.join(parts)}.{code.co_qualname}"
