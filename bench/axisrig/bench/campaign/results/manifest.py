"""What a campaign was made with: versions, build, platform, hashes of its files."""

import os
import platform
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import metadata
from pathlib import Path

from axisrig.bench.campaign.results.build_info import is_compiled, sources_sha256
from axisrig.bench.campaign.results.case_files import (
    own_metrics,
    readable_subprograms,
    rig_parts,
    started_programs,
)
from axisrig.bench.files import sha256_of
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expanded import path_from
from axisrig.bench.plan.plan import Plan

SPENT = "spent_s"
"""Entry of a manifest: how long the call took, s; `jobs` beside it: with how many processes."""
TEXT_MAX = 200_000
"""Files of so many bytes at most are kept with the results: `axisrig diff` reads them."""
_BINARY = frozenset({".fmu", ".xlsx", ".ods", ".parquet"})
_PACKAGES = ("rumoca", "fmpy", "canopen", "python-can", "numpy", "scipy", "pandas", "pyarrow")


def build_manifest(
    plans: Sequence[Plan],
    *,
    command: Sequence[str],
    started: str,
    output: str,
    extra: Mapping[str, object] | None = None,
) -> dict[str, object]:
    """Collect what a campaign was made with: versions, build, platform, hashes of its files.

    command: the command line. started: wall time as text, from the command line, since nothing
    below it reads a clock. output: the results folder as the user named it.
    extra: more entries, e.g. the hashes of the FMUs.
    """

    return {
        "axisrig": _version("axisrig"),
        "compiled": is_compiled(),
        "sources_sha256": sources_sha256(),
        "started": started,
        "command": list(command),
        "output": output,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "packages": {name: _version(name) for name in _PACKAGES},
        "plans": [
            {"name": p.name, "path": str(p.path), "sha256": sha256_of(p.path), "runs": len(p.cases)}
            for p in plans
        ],
        "files": file_hashes([case for plan in plans for case in plan.rows]),
        **(extra or {}),
    }


def file_hashes(cases: Sequence[Case]) -> dict[str, str]:
    """SHA-256 of what every case reads: programs, those they call, rig, bases, lists, maps."""
    return {name: sha256_of(path) for name, path in _files(cases)}


def file_texts(cases: Sequence[Case]) -> dict[str, str]:
    """Return the content of these files by the same names: what is text and not long."""
    found = {}
    for name, path in _files(cases):
        if path.suffix not in _BINARY and path.stat().st_size <= TEXT_MAX:
            with suppress(UnicodeDecodeError):
                found[name] = path.read_text(encoding="utf-8-sig")
    return found


def _files(cases: Sequence[Case]) -> list[tuple[str, Path]]:
    """Return the files of cases with their names, as the plans have them."""
    files = {
        (path_from(case.folder, path), path)
        for case in cases
        for path in (case.program, *started_programs(case), *own_metrics(case), case.rig)
    }
    files |= {
        (_from_folder(path, case.folder), path)
        for case in cases
        for path in (*readable_subprograms(case), *rig_parts(case))
    }
    included = {(case.folder, case.file) for case in cases if case.file.stem != case.plan}
    return sorted(files | {(_from_folder(path, folder), path) for folder, path in included})


def _from_folder(path: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(path, folder.resolve())).as_posix()
    except ValueError:  # on another drive of Windows
        return path.as_posix()


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None
