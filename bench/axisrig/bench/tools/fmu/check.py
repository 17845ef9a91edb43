"""`axisrig fmu check FILE`: may this FMU be trusted, and what could it be in a rig?

Everything that touches the FMU runs in processes apart (bench/axisrig/bench/campaign/processes.py).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from axisrig.bench.campaign.collector import without_collector
from axisrig.bench.campaign.processes import CALL_LIMIT_S, Died, run_apart
from axisrig.bench.tools.fmu import stages
from axisrig.bench.tools.fmu.examine import Examined, examine
from axisrig.bench.tools.fmu.findings import Finding, Level, as_rows, fail, has_failed, ok
from axisrig.bench.tools.fmu.stages import Outcome, run_stage
from axisrig.bench.tools.fmu.stepped_instance import readable_outputs
from axisrig.kernel.cosim.fmi.fmu import load_description
from axisrig.kernel.cosim.fmi.variable_index import by_name

CALLS_MAX = 10  # so many calls of the longest allowed time may one trial take


@dataclass(frozen=True)
class Checked:
    """Everything found about an FMU."""

    path: Path
    sha256: str
    findings: list[Finding]

    @property
    def is_good(self) -> bool:
        """Whether nothing has failed."""
        return not has_failed(self.findings)

    @property
    def verdict(self) -> str:
        """The word of the worst finding."""
        words = {finding.level for finding in self.findings}
        return next(level.value for level in reversed(Level) if level.value in words)

    def as_data(self) -> dict[str, object]:
        """Return it as plain data for JSON."""
        return {
            "file": str(self.path),
            "sha256": self.sha256,
            "verdict": self.verdict,
            "findings": as_rows(self.findings),
        }


def check_fmu(
    path: Path, call_limit_s: float = CALL_LIMIT_S, *, is_strict: bool = False
) -> Checked:
    """Check an FMU. call_limit_s: wall time that one call into it may take.

    is_strict: whatever a validator of the standard dislikes is a FAIL. Raises UserError when there
    is no file to check.
    """
    examined = _examined(path, call_limit_s, is_strict)
    findings = list(examined.findings)
    if examined.can_run:
        with without_collector():
            _sort_out(path)
            findings += _tried(path, call_limit_s)
    return Checked(path, examined.sha256, findings)


def _sort_out(path: Path) -> None:
    """Read and sort a description once for the processes of all trials: they begin as copies."""
    description, _ = load_description(path)
    by_name(description)
    readable_outputs(description)


def _examined(path: Path, call_limit_s: float, is_strict: bool) -> Examined:
    (result,) = run_apart(examine, [[path, is_strict]], call_limit_s=call_limit_s)
    if isinstance(result, Died):
        return Examined([fail("description", f"reading it: {result.reason}")], "", False)
    return result


def _tried(path: Path, call_limit_s: float) -> list[Finding]:
    findings: list[Finding] = []
    digest = ""
    for names in (*([name] for name in stages.FIRST), list(stages.REST)):
        outcomes = _run(path, names, call_limit_s)
        for outcome in outcomes:
            findings += outcome.findings
            digest = digest or outcome.digest
        if has_failed(findings):
            return findings
    return findings + _across(path, digest, call_limit_s)


def _run(path: Path, names: Sequence[str], call_limit_s: float) -> list[Outcome]:
    tasks = [[name, path] for name in names]
    timeout_s = CALLS_MAX * call_limit_s
    results = run_apart(run_stage, tasks, call_limit_s=call_limit_s, timeout_s=timeout_s)
    return [
        Outcome([fail(name, result.reason, "keep it out")]) if isinstance(result, Died) else result
        for name, result in zip(names, results, strict=True)
    ]


def _across(path: Path, digest: str, call_limit_s: float) -> list[Finding]:
    """Compare a run in a process that shares nothing with the other, not even addresses."""
    area, task = "repeatability", ["determinism", path]
    (result,) = run_apart(run_stage, [task], call_limit_s=call_limit_s, is_unrelated=True)
    if isinstance(result, Died):
        return [fail(area, result.reason)]
    if result.digest != digest:
        remedy = "it uses memory that it never wrote, an address, a clock or a random number"
        return [fail(area, "a run in another process differs", remedy)]
    return [ok(area, "a run in another process is equal bit for bit")]
