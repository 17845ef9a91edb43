"""The heading of the report: what became of the campaign, what was tested, and with what."""

import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from axisrig.bench.campaign.progress import duration
from axisrig.bench.campaign.results.manifest import SPENT
from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.campaign.results.tally import Tally, outcome_words
from axisrig.bench.plan.info import info_of
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.run import verdict_words

_TESTED = 8


def heading(results: StoredResults, seconds: Mapping[str, Sequence[float]]) -> dict[str, Any]:
    """Everything that the template prints of it. seconds: of runs, simulated and on a real bus."""
    manifest, planned = results.manifest, results.planned
    verdicts = Counter(run.verdict for run in planned)
    tally = Tally.of(results.runs)
    return {
        "plans": list(dict.fromkeys(run.case["plan"] for run in results.runs)),
        "verdict": verdict_words(results.verdict),
        "outcome": outcome_words(verdicts, results.runs_planned),
        "rows_of": tally.words if tally.is_mixed else "",
        "of": tally.word,
        "counts": [(verdict_words(verdict), verdicts[verdict]) for verdict in Verdict],
        "missing": results.missing,
        "done": len(planned),
        "planned": results.runs_planned,
        "tested": [*_info(results.runs), *_tested([r for r in results.runs if not r.is_probe])],
        "facts": _facts(results, seconds),
        "files": _files(manifest),
        "packages": manifest.get("packages", {}),
    }


def _info(runs: Sequence[StoredRun]) -> list[str]:
    """What `--info` and the rigs say of the device: each value, with its runs where they differ."""
    found = [info_of(run.case) for run in runs if not run.is_probe]
    lines = []
    for key in dict.fromkeys(key for one in found for key in one):
        values = Counter(one.get(key, "") for one in found)
        counts = [(value, n) for value, n in values.most_common() if value]
        words = [value if len(values) == 1 else f"{value} ({_runs(n)})" for value, n in counts]
        lines.append(f"{key.replace('_', ' ')}: {', '.join(words)}")
    return lines


def _tested(runs: Sequence[StoredRun]) -> list[str]:
    """What was tested on what: programs and rigs, the most frequent first."""

    def name(path: str) -> str:
        return path.replace("\\", "/").rpartition("/")[2]

    pairs = Counter(
        (name(run.case.get("program", "")), name(run.case.get("rig", ""))) for run in runs
    )
    known = [(pair, count) for pair, count in pairs.most_common() if any(pair)]
    words = [
        f"{' on '.join(part for part in pair if part)}: {_runs(count)}"
        for pair, count in known[:_TESTED]
    ]
    more = known[_TESTED:]
    if more:
        count = sum(count for _, count in more)
        words.append(f"{len(more)} more programs and rigs: {_runs(count)}")
    return words


def _facts(results: StoredResults, seconds: Mapping[str, Sequence[float]]) -> list[tuple[str, str]]:
    """What is known about the campaign."""
    manifest, runs = results.manifest, results.runs
    facts = {
        "started": manifest.get("started"),
        "took": _took(manifest, sum(float(r.case["wall_s"]) for r in runs if not r.is_probe)),
        "command": shlex.join(manifest.get("command", [])),
        "axisrig": manifest.get("axisrig"),
        "Python": manifest.get("python"),
        "platform": manifest.get("platform"),
        "CiA 402 drive in place of": "; ".join(_substituted(runs)),
        "simulated": _time_of(seconds["sim"]),
        "on a real bus": _time_of(seconds["real"]),
        "of earlier calls": "; ".join(_earlier(manifest)),
        "warnings": "\n".join(manifest.get("warnings", [])),
    }
    return [(name, str(value)) for name, value in facts.items() if value]


def _took(manifest: Mapping[str, Any], wall_s: float) -> str:
    """How long the call took, and all runs one after the other."""
    spent, jobs = manifest.get(SPENT), manifest.get("jobs", 1)
    words = []
    if spent is not None:
        of = f" with {jobs} processes" if jobs > 1 else ""
        words.append(f"{_brief(spent)}{of}")
    if wall_s:
        words.append(f"{_brief(wall_s)} of computing in all runs")
    return "; ".join(words)


def _brief(seconds: float) -> str:
    return f"{seconds:.1f} s" if seconds < 10.0 else duration(seconds)


def _substituted(runs: Sequence[StoredRun]) -> list[str]:
    """What drives stood for that the lists do not name, and in how many runs."""
    found = [run.case.get("drive_substituted", "") for run in runs]
    counts = Counter(text for text in found if text)
    return [f"{text} ({_runs(count)})" for text, count in counts.items()]


def _earlier(manifest: Mapping[str, Any]) -> Iterator[str]:
    """Calls before the last one whose results are still in the folder."""
    for call in manifest.get("earlier", []):
        command = shlex.join(call.get("command", []))
        yield f"{_runs(len(call.get('runs', ())))} of {call.get('started', '')} {command}".rstrip()


def _runs(count: int) -> str:
    return f"{count} run{'' if count == 1 else 's'}"


def _time_of(seconds: Sequence[float]) -> str:
    return f"{sum(seconds):.3f} s in {_runs(len(seconds))}" if any(seconds) else ""


def _files(manifest: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Files of the campaign with their SHA-256."""
    plans = {plan["path"]: plan["sha256"] for plan in manifest.get("plans", [])}
    return list({**plans, **manifest.get("files", {}), **manifest.get("fmus", {})}.items())
