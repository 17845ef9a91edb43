"""A campaign on several machines: each runs a share (`--shard 2/3`), `axisrig merge` joins them."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from axisrig.bench.bus.can.logs import SEGMENT_MARK
from axisrig.bench.campaign.results.layout import FOLDERS, MANIFEST
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.stored import DEPENDS, StoredResults, StoredRun, read_results
from axisrig.bench.campaign.results.sums import BUS_LOG_SUM
from axisrig.bench.campaign.results.writer import ResultsWriter
from axisrig.bench.campaign.resuming import LIVE, depends_sha256, own_plan
from axisrig.bench.campaign.statistics import CaseStatistics
from axisrig.bench.campaign.tested import with_tested
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.info import parse_info
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.select import chosen
from axisrig.bench.rig.settings import AS_CANOPEN, FORCED
from axisrig.kernel.errors import UserError

_FORM = re.compile(r"([1-9]\d{0,5})/([1-9]\d{0,5})")
_DECIDING = ("-k", "--set", "--info", "--bus-log", "--bitrate",
             "--interface", "--channel", "--option", "--segment")  # fmt: skip
"""Options of `axisrig run` with a value that decides on results, or on what they are of."""
_BESIDE = {
    **dict.fromkeys(("--shard", "-o", "--out", "-j", "--jobs", "--engine", "--scheduler"), True),
    **dict.fromkeys(("--timeout", "--call-timeout"), True),
    **dict.fromkeys(("--fresh", "--resume", "--failed", "--full", "--isolate", *LIVE), False),
    **dict.fromkeys(("--strict", "-x", "--exitfirst", "-q", "--quiet", "-v", "--verbose"), False),
    **dict.fromkeys(("-y", "--yes"), False),
}
"""Its options that change no result -> whether a value follows."""
_LETTERS = re.compile(r"-[qvxy]{2,}")  # several of these in one word
_FLAGS = {"--force": FORCED, "--as-canopen": AS_CANOPEN}


@dataclass(frozen=True)
class Shard:
    """One share of a campaign. number: from 1 to count."""

    number: int
    count: int

    @classmethod
    def of(cls, text: str) -> "Shard":
        """Read `2/3`. Raises UserError for anything else."""
        match = _FORM.fullmatch(text)
        if match is None or int(match[1]) > int(match[2]):
            raise UserError("--shard: no share of a campaign", value=text, allowed="1/3, 2/3, 3/3")
        return cls(int(match[1]), int(match[2]))

    def share(self, cases: Sequence[Case]) -> tuple[Case, ...]:
        """Return its cases: every `count`-th, so that neighbours, which take as long, are apart."""
        return tuple(cases[self.number - 1 :: self.count])


@dataclass(frozen=True)
class Merged:
    """What `axisrig merge` made.

    statistics: rows of statistics over several runs. missing: runs that no folder has. doubled:
    those of several. bare: runs whose folder has frames in its table, and no trace or file of the
    run beside it.
    """

    folder: Path
    runs: int
    statistics: int
    missing: Sequence[str]
    doubled: Sequence[str]
    bare: Sequence[str]
    report: Path | None


def merge(
    folders: Sequence[Path],
    into: Path,
    *,
    started: str,
    is_fresh: bool = False,
    build_report: Callable[[Path], Path] | None = None,
) -> Merged:
    """Join results folders of one campaign into a new one, as if it had run on one machine.

    The plans must be where they were, with what their runs depend on; statistics over several runs
    are judged here. Raises UserError where the folders are not of one campaign: other plans,
    another axisrig, other options, files that have changed, a run with two different results.
    """
    if into.resolve() in [folder.resolve() for folder in folders]:
        raise UserError("the folder to make is one of those to join", file=into)
    parts = [read_results(folder) for folder in folders]
    _refuse_strangers(parts)
    plans = _plans(parts[0])
    cases = {case.run: case for plan in plans for case in _selected(plan, parts[0])}
    rows = [row.run for plan in plans for row in plan.statistics if cases.keys() >= {*row.runs}]
    found, doubled = _runs(parts)
    hashes = {row.run: depends_sha256(row) for plan in plans for row in plan.rows}
    for run, (part, stored) in found.items():
        if stored.altered:
            raise UserError(stored.altered_words, file=part.folder, value=run)
        if run in cases and stored.case.get(DEPENDS) != hashes[run]:
            raise UserError(
                "what the run depends on is not what it was run with",
                file=part.folder,
                value=run,
                hint="run the share again with --resume, or merge where the files are as they were",
            )
    manifest = _manifest(parts, plans, started, into)
    taken = [case for run, case in cases.items() if run in found]
    due = CaseStatistics(plans, taken, into, hashes, is_fresh=is_fresh).due
    runs = dict.fromkeys([*cases, *rows, *(row.run for row in due)])
    with ResultsWriter(into, plans, manifest, runs=runs, is_fresh=is_fresh) as writer:
        for case in taken:
            _take(writer, *found[case.run])
        statistics = CaseStatistics(plans, (), into, hashes, is_fresh=False)
        for row in map(statistics.judged, due):
            row.depends_sha256 = hashes[row.case.run]
            writer.add(row)
    report = build_report(into) if build_report else None
    missing = [run for run in cases if run not in found]
    bare = [case.run for case in taken if _is_bare(found[case.run][1])]
    return Merged(into, len(taken), len(due), missing, doubled, bare, report)


def _is_bare(run: StoredRun) -> bool:
    """Whether a run that has sent frames lacks what it has recorded: its folder is a part."""
    return bool(run.case["frame_log_sha256"]) and None in (run.trace, run.file)


def _manifest(
    parts: Sequence[StoredResults], plans: Sequence[Plan], started: str, into: Path
) -> dict[str, Any]:
    command = [*_kept_words(parts[0].manifest["command"], has_plans=True), "-o", str(into)]
    made = build_manifest(plans, command=command, started=started, output=str(into))
    return made | {"merged": [str(part.folder) for part in parts]}


def _refuse_strangers(parts: Sequence[StoredResults]) -> None:
    """Raise UserError where folders are not of one campaign."""
    first = parts[0]
    for part in parts:
        if part.manifest.get("command", [])[1:2] != ["run"]:
            raise UserError("the folder does not come from `axisrig run`", file=part.folder)
        for name in ("sources_sha256", "plans"):
            if not part.manifest.get(name):
                raise UserError(f"the manifest has no {name}", file=part.folder / MANIFEST)
        for what, now, then in (
            ("plans", _names(part.manifest), _names(first.manifest)),
            ("axisrig", part.manifest["sources_sha256"], first.manifest["sources_sha256"]),
            ("options", _kept_words(part.manifest["command"]), _kept_words(
                first.manifest["command"])),
        ):  # fmt: skip
            if now != then:
                raise UserError(
                    f"the folders are not of one campaign: other {what} than {first.folder}",
                    file=part.folder,
                    value=" ".join(now) if isinstance(now, list) else now[:12],
                    allowed=" ".join(then) if isinstance(then, list) else then[:12],
                )


def _names(manifest: Mapping[str, Any]) -> list[str]:
    return [f"{plan['name']} ({plan['sha256'][:12]})" for plan in manifest.get("plans", [])]


def _kept_words(command: Sequence[str], *, has_plans: bool = False) -> list[str]:
    """The words of a command without those that change no result; without plans unless asked."""
    words: list[str] = []
    rest = iter(command)
    for word in rest:
        name = word.partition("=")[0]
        if name in _BESIDE:
            if _BESIDE[name] and "=" not in word:
                next(rest, None)
        elif word[:2] in ("-o", "-j") or _LETTERS.fullmatch(word):
            continue  # with its value in the same word
        elif word in _DECIDING:
            words += [word, *([value] if (value := next(rest, None)) is not None else [])]
        elif word.startswith("-k"):
            words += ["-k", word[2:]]
        elif has_plans or word.startswith("-"):
            words.append(word)
    return words


def _plans(part: StoredResults) -> list[Plan]:
    """Read the plans of a folder with the inputs of its command, and with what is tested."""
    words = part.manifest["command"]
    texts = [*_values(words, "--set"), *(_FLAGS[word] for word in words if word in _FLAGS)]
    said = parse_info(_values(words, "--info"))
    changes = [parse_assignment(text) for text in texts]
    paths = [own_plan(part.folder, plan["path"]) for plan in part.manifest["plans"]]
    plans = [read_plan(path) for path in paths]
    return [with_tested(plan.with_inputs(changes, _select(part)), said) for plan in plans]


def _values(words: Sequence[str], option: str) -> list[str]:
    """The values of an option that may come several times, in their order."""
    found = [value for word, value in pairwise(words) if word == option]
    return found + [word.partition("=")[2] for word in words if word.startswith(f"{option}=")]


def _selected(plan: Plan, part: StoredResults) -> Sequence[Case]:
    """Return the cases that `-k` of the command of a folder has chosen; all without."""
    select = _select(part)
    return plan.cases if select is None else chosen(plan.cases, select)


def _runs(
    parts: Sequence[StoredResults],
) -> tuple[dict[str, tuple[StoredResults, StoredRun]], list[str]]:
    """Return the planned runs with their folders, and those that several folders have.

    Raises UserError where these differ.
    """
    found: dict[str, tuple[StoredResults, StoredRun]] = {}
    doubled = []
    for part in parts:
        for run in part.planned:
            if run.run in found and not _is_same(run, found[run.run][1]):
                raise UserError(
                    f"the run has another result than in {found[run.run][0].folder}",
                    file=part.folder,
                    value=run.run,
                )
            if run.run in found:
                doubled.append(run.run)
            found.setdefault(run.run, (part, run))
    return found, doubled


def _is_same(run: StoredRun, other: StoredRun) -> bool:
    once = dict.fromkeys(("wall_s", BUS_LOG_SUM), "")  # an asc log has a date
    first, second = ({**one.case, **once} for one in (run, other))
    return first == second and list(run.rows) == list(other.rows)


def _take(writer: ResultsWriter, part: StoredResults, run: StoredRun) -> None:
    """Put a run, with its probes, into the folder of a writer."""
    probes = [one for one in part.runs if one.is_probe and one.case["probe"] == run.run]
    for one in (*probes, run):
        files = {
            (kind, path.name.removeprefix(one.run)): path
            for kind in FOLDERS
            for path in _files(part.folder / kind, one.run)
        }
        writer.take(one.case, one.rows, files, [probe.run for probe in probes])


def _files(folder: Path, run: str) -> Iterator[Path]:
    for path in folder.iterdir() if folder.is_dir() else ():
        if path.name.startswith((f"{run}.", f"{run}{SEGMENT_MARK}")) and path.is_file():
            yield path


def _select(part: StoredResults) -> str | None:
    words = _kept_words(part.manifest["command"])
    return next((value for word, value in pairwise(words) if word == "-k"), None)
