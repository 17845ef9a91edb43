"""What a run depends on as one hash, which runs `--resume` and `--failed` keep, and in which order
the others run.

The hash of a run is in its row of `cases.csv` (`depends_sha256`), so that it comes and goes with
the results of the run.
"""

import hashlib
import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from axisrig.bench.campaign.results.build_info import sources_sha256
from axisrig.bench.campaign.results.case_files import content_hash, files_of_case
from axisrig.bench.campaign.results.layout import refuse_links
from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    DEPENDS,
    PROBE,
    RUNS,
    StoredRun,
    is_results_folder,
    read_manifest,
    read_results,
    read_rows,
)
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expanded import path_from
from axisrig.bench.plan.searching import HEAD
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

LIVE = ("--live", "--live-terminal")
"""Options that change nothing that is written."""
_OF_ONE_CALL = ("--fresh", "--resume", "--failed", "-o", "--out", "-y", "--yes", *LIVE)
"""Options that a call does not take over: the folder is the one it names, consent is its own."""
CHANGED = "files that the run depends on have changed since the campaign began"


def depends_sha256(case: Case) -> str:
    """Return the hash over everything that the results of a run follow from.

    Its row as expanded, with the inputs of the command line; the bytes of its programs, of its rig
    with bases, lists, maps and FMUs, of its Python file with metrics; the sources of axisrig, which
    hold the models of its own FMUs. Where files are does not count. Of a row of statistics: its
    checks. Empty when rig or program cannot be read: then nothing is known to be the same.
    """
    try:
        return _depends(case)
    except UserError:
        return ""


def _depends(case: Case) -> str:
    texts = [sources_sha256(), *_row(case)]
    if not case.runs:
        texts += [content_hash(path) for path in files_of_case(case)]
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()


def _row(case: Case) -> list[str]:
    """The row of a case, one text for each cell."""
    probed = () if case.search is None else case.search.checks
    asked = (*case.checks, *case.sampled, *probed)
    checks = [f"{check.metric} {check.condition.text}" for check in asked]
    files = [path_from(case.folder, path) for path in (case.program, case.rig)]
    return [
        *(case.plan, case.case, case.run, *files, str(case.seed)),
        *(case.title, " ".join(case.tags), case.requirement),
        *(f"{column}={value}" for column, value in {**case.notes, **case.inputs}.items()),
        *checks,
        *case.expected,
        *case.runs,
        *([] if case.search is None else [f"{HEAD}{case.search.column}={case.search.text}"]),
        # A file counts by its content
        *([] if case.module is None or case.module.path else [f"module={case.module.name}"]),
    ]


@dataclass(frozen=True)
class Kept:
    """What a call keeps of a folder, and what it runs.

    cases: to run. verdicts: of the runs that stay. changed: how many of those to run have results
    that they no longer fit, None where nothing is asked to stay. altered: what is said of those of
    which a file is not the one that they have written.
    """

    cases: Sequence[Case]
    verdicts: Sequence[Verdict] = ()
    changed: int | None = None
    altered: Sequence[str] = ()

    @property
    def counts(self) -> Mapping[str, int]:
        """Entries of the manifest; none for a call that takes nothing over."""
        if self.changed is None:
            return {}
        return {"kept": len(self.verdicts), "run": len(self.cases), "changed": self.changed}


class GoingOn(Enum):
    """Which runs a call takes over from the folder.

    NO: none, all are run. MISSING: `--resume`, those whose results still fit.
    FAILED: `--failed`, those that passed.
    """

    NO = ""
    MISSING = "--resume"
    FAILED = "--failed"

    @property
    def option(self) -> str:
        """The option of the command line that asks for it."""
        return self.value

    @classmethod
    def of(cls, *, is_resumed: bool, is_failed: bool, is_fresh: bool) -> "GoingOn":
        """Take the options of the command line. Raises UserError for those that exclude others."""
        if is_resumed and is_failed:
            raise UserError("--resume and --failed exclude each other")
        if is_fresh and (is_resumed or is_failed):
            raise UserError("--fresh removes the results that --resume and --failed keep")
        if is_failed:
            return cls.FAILED
        return cls.MISSING if is_resumed else cls.NO


def choose(
    cases: Sequence[Case], hashes: Mapping[str, str], folder: Path, going_on: GoingOn
) -> Kept:
    """Choose the runs of a call that goes on with a folder.

    hashes: `depends_sha256` of each run. Without `--failed` it runs those that are missing,
    aborted, or depend on something else than when they ran; in any case those of which a file is
    not the one that they have written.
    """
    if going_on is GoingOn.NO:
        return Kept(cases)
    stored = read_results(folder).runs if is_results_folder(folder) else []
    rows = {run.run: run for run in stored}
    probes = Counter(row.case.get(PROBE, "") for row in rows.values())
    chosen, verdicts, altered, changed = [], [], list[str](), 0
    for case in cases:
        row = rows.get(case.run)
        now = hashes[case.run]
        is_same = row is not None and bool(now) and row.case.get(DEPENDS, "") == now
        is_failed = going_on is GoingOn.FAILED
        is_whole = row is not None and (
            row.file is not None if case.search is None else _has(row, probes[case.run])
        )
        words = _altered(row, rows) if row is not None else []
        altered += words
        stays = row is not None and _stays(row, is_same and is_whole, is_failed=is_failed)
        if row is not None and stays and not words:
            verdicts.append(row.verdict)
        else:
            chosen.append(case)
            changed += row is not None and (bool(words) or not is_same)
    return Kept(chosen, verdicts, changed, altered)


def _altered(row: StoredRun, rows: Mapping[str, StoredRun]) -> list[str]:
    """Say which files of a run, and of its probes, are not those that it has written."""
    probes = [one for one in rows.values() if one.case.get(PROBE) == row.run]
    return [f"{one.run}: {one.altered_words}" for one in (row, *probes) if one.altered]


def longest_first(cases: Sequence[Case], folder: Path) -> list[Case]:
    """Return cases in the order in which several processes do them with the least waiting.

    A long run that begins last keeps one process busy while the others have nothing to do. How
    long runs take, the results say that the folder has of earlier calls (`wall_s`); those of which
    nothing is known come first, in their order. Results do not depend on it.
    """
    known: dict[str, float] = {}
    with suppress(UserError, OSError):  # damaged ones are refused, or removed, by who writes there
        if is_results_folder(folder):
            rows = read_rows(folder / "cases.csv", CASE_COLUMNS, is_whole=False)[1]
            known = {row["run"]: float(row["wall_s"]) for row in rows}
    return sorted(cases, key=lambda case: -known.get(case.run, math.inf))


def _stays(row: StoredRun, fits: bool, *, is_failed: bool) -> bool:
    if is_failed:
        return row.verdict <= Verdict.MARGINAL
    return fits and row.verdict is not Verdict.ABORTED


def _has(row: StoredRun, probes: int) -> bool:
    """Whether the folder has all probes of a row that searches, and no others."""
    return row.case.get(RUNS) == str(probes)


def stored_arguments(
    folder: Path | None, given: Collection[str], valued: Collection[str]
) -> list[str]:
    """Return the arguments of `axisrig run` that a folder comes from, to go on with it.

    given: options of this call; those of the folder give way. valued: options with a value.
    Raises UserError for a folder that no `axisrig run` has written.
    """
    if folder is None:
        raise UserError(
            "no plan is named",
            hint="axisrig run --resume -o DIR takes the plan that DIR comes from",
        )
    refuse_links(folder)
    command = read_manifest(folder).get("command", []) if folder.is_dir() else []
    if command[1:2] != ["run"]:
        raise UserError(
            "the folder does not come from `axisrig run`",
            file=folder,
            value=" ".join(command) or None,
            hint="name the plans to go on with",
        )
    for plan in read_manifest(folder).get("plans", []):
        own_plan(folder, plan["path"])
    return _without(command[2:], {*_OF_ONE_CALL, *given}, valued)


def own_plan(folder: Path, path: str) -> Path:
    """Return a plan that a results folder names. Raises UserError for one that lies in it.

    A plan names programs and metric modules, which are carried out: it is not a part of results.
    """
    if Path(path).resolve().is_relative_to(folder.resolve()):
        raise UserError(
            "the results folder names a plan inside itself: results are data, they bring no plan",
            file=folder,
            value=path,
            hint="axisrig run PLAN -o ANOTHER_DIR, once you have read the plan",
        )
    return Path(path)


def _without(words: Sequence[str], dropped: Collection[str], valued: Collection[str]) -> list[str]:
    """Return the words of a command without some options. valued: those that a value follows."""
    kept: list[str] = []
    rest = iter(words)
    for word in rest:
        is_long = word.startswith("--")
        name = word.partition("=")[0] if is_long else word[:2] if word[:1] == "-" else ""
        whole = [word]
        if name in valued and word == name:
            whole += [value for value in (next(rest, None),) if value is not None]
        if name not in dropped:
            kept += whole
    return kept
