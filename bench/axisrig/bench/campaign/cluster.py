"""`axisrig run --engine dask --scheduler tcp://...`: runs on the workers of a dask cluster.

What a run reads travels by the hash of its content: a worker keeps each tree of files in its cache
and needs no shared file system. A run of a worker that is lost goes to another one. Results come
back as data and are written by the process of the command line alone, as those of its own runs.

A run with a foreign FMU, or with a limit of time, gets a process of its own beside the worker: what
crashes or hangs costs its row, not the worker.
"""

import dataclasses
import hashlib
import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import Any

from axisrig.bench.campaign.results.build_info import sources_sha256
from axisrig.bench.campaign.results.case_files import files_of_case
from axisrig.bench.campaign.results.layout import logs_beside
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles, no_values
from axisrig.bench.campaign.runner import Limits, Stopwatch, run_cases
from axisrig.bench.campaign.worker import end_with
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expanded import path_from
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError

_TRACE = ".parquet"
_LOST = ("lost", "cancelled")
_GO_ON = "`axisrig run --resume` runs the rest"
_APART = "from axisrig.bench.campaign.cluster import run_apart_from; run_apart_from({!r}, {})"


@dataclass(frozen=True)
class _Parcel:
    """A case for a worker. names: name in the cache -> (hash, path here) of each file.

    rig: as the plan names it. suffixes: of the bus logs that are wanted. probes: names of the
    places for probes. limits: apart is empty, or has the rig of the case.
    """

    case: Case
    names: Mapping[str, tuple[str, str]]
    rig: str
    suffixes: tuple[str, ...]
    probes: tuple[str, ...]
    limits: Limits
    stopwatch: Stopwatch
    sources_sha256: str


@dataclass(frozen=True)
class _Returned:
    """What a worker gives back. files: content by name. error: why it could not run the case."""

    result: CaseResult | None
    files: Mapping[str, bytes]
    error: str = ""


def run_on_cluster(
    cases: Sequence[Case],
    files_of: Callable[[str], RunFiles],
    scheduler: str,
    limits: Limits,
    stopwatch: Stopwatch,
) -> Iterator[CaseResult]:
    """Yield the results as they come, in any order.

    scheduler: address, such as tcp://127.0.0.1:8786. Raises UserError without dask.distributed, and
    where no scheduler answers; ConnectionError when it is lost in the middle. A case whose workers
    die again and again is in error.
    """
    try:
        from distributed import Client, as_completed  # noqa: PLC0415 - an extra, and slow
    except ImportError as error:
        raise UserError(
            "dask.distributed is not installed", hint="pip install 'axisrig[dask]' brings it"
        ) from error
    try:
        client = Client(scheduler, timeout=10, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UserError("no scheduler answers", value=scheduler) from error
    futures: dict[Any, Case] = {}
    try:
        blobs: dict[str, Any] = {}
        for case in cases:
            parcel, contents = _packed(case, files_of(case.run), limits, stopwatch)
            for key in contents.keys() - blobs.keys():
                # Not scattered: what a lost worker had would be lost
                blobs[key] = client.submit(bytes, contents[key], key=f"axisrig-{key}")
            needed = {key: blobs[key] for key in contents}
            future = client.submit(_work, pickle.dumps(parcel), needed, pure=False)
            futures[future] = case
        ended = as_completed(list(futures), loop=client.loop)
        while futures:
            with _naming_lost(scheduler):
                future = next(ended)
                content = _content(future, scheduler)
            yield _unpacked(futures.pop(future), content, files_of)
    finally:
        # A scheduler that is lost answers neither; why it ended is known already
        for end in (lambda: client.cancel(list(futures)), client.close):
            with suppress(Exception):
                end()


@contextmanager
def _naming_lost(scheduler: str) -> Iterator[None]:
    """Say of everything that a lost scheduler raises that it is lost."""
    try:
        yield
    except BaseException as error:
        # Several libraries have a class of their own for what is cancelled
        if isinstance(error, OSError) or type(error).__name__.endswith("CancelledError"):
            raise _lost(scheduler) from error
        raise


def _lost(scheduler: str) -> ConnectionError:
    return ConnectionError(f"the scheduler {scheduler} is lost; {_GO_ON}")


def _content(future: Any, scheduler: str) -> bytes | str:
    """Return what a worker gave back, or why none could run it."""
    if future.status in _LOST:
        raise _lost(scheduler)
    if future.status != "finished":
        return " ".join(f"no worker could run it: {future.exception()}".split())
    content: bytes = future.result()
    return content


def _packed(
    case: Case, files: RunFiles, limits: Limits, stopwatch: Stopwatch
) -> tuple[_Parcel, dict[str, bytes]]:
    """Pack a case with the content of its files. Raises UserError for files of several drives."""
    paths = {os.path.abspath(path): path for path in files_of_case(case)}  # noqa: PTH100 - no links
    try:
        base = os.path.commonpath([*map(os.path.dirname, paths), os.path.abspath(case.folder)])  # noqa: PTH100
    except ValueError as error:  # Windows
        raise UserError(
            "the files of a run are on several drives: a cluster needs them on one",
            file=case.file,
            value=", ".join(paths),
        ) from error
    names, contents = {}, {}
    for absolute, path in paths.items():
        content = Path(absolute).read_bytes()
        key = hashlib.sha256(content).hexdigest()
        contents[key] = content
        names[os.path.relpath(absolute, base)] = (key, str(path))
    suffixes = tuple(path.suffix for path in files.bus_logs)
    probes = tuple(place.trace.stem for place in files.probes if place.trace is not None)
    moved = _moved(case, base)
    limits = dataclasses.replace(limits, apart=[moved.rig] if case.rig in limits.apart else [])
    rig = path_from(case.folder, case.rig)
    parcel = _Parcel(moved, names, rig, suffixes, probes, limits, stopwatch, sources_sha256())
    return parcel, contents


def _moved(case: Case, base: str, into: str = "") -> Case:
    """Name the files of a case from a folder, or put them into one."""

    def moved(path: Path) -> Path:
        if into:
            return Path(into) / path
        return Path(os.path.relpath(os.path.abspath(path), base))  # noqa: PTH100

    module = case.module
    if module is not None and module.path is not None:
        module = dataclasses.replace(module, path=moved(module.path))
    named = {  # a cell names its file from its table, which does not travel
        item.column: str(moved(Path(case.inputs[item.column] if into else item.value)))
        for item in case.assignments()
        if item.names_file
    }
    return dataclasses.replace(
        case,
        inputs={**case.inputs, **named},
        program=moved(case.program),
        rig=moved(case.rig),
        folder=moved(case.folder),
        file=moved(case.file),
        module=module,
    )


def _work(packed: bytes, contents: Mapping[str, bytes]) -> bytes:
    """Run a parcel in a worker."""
    parcel: _Parcel = pickle.loads(packed)
    if parcel.sources_sha256 != sources_sha256():
        return pickle.dumps(_Returned(None, {}, "the worker has another axisrig"))
    tree = _tree(parcel, contents)
    case = _moved(parcel.case, "", str(tree))
    with TemporaryDirectory(prefix="axisrig-") as name:
        folder = Path(name)
        runs = (case.run, *parcel.probes)
        places = [
            RunFiles([folder / f"{run}{suffix}" for suffix in parcel.suffixes],
                     folder / f"{run}{_TRACE}", rig=parcel.rig)
            for run in runs
        ]  # fmt: skip
        order = _Order(
            case,
            dataclasses.replace(places[0], probes=places[1:]),
            dataclasses.replace(parcel.limits, apart=[case.rig] if parcel.limits.apart else []),
            parcel.stopwatch,
        )
        result = _run_beside(order) if order.limits.is_apart(case) else _run(order)
        files = {path.name: path.read_bytes() for path in folder.iterdir()}
    here = {str(tree / name): path for name, (_, path) in parcel.names.items()}
    return pickle.dumps(_Returned(_renamed(result, here), files))


@dataclass(frozen=True)
class _Order:
    """A run as `runner.run_cases` takes it."""

    case: Case
    files: RunFiles
    limits: Limits
    stopwatch: Stopwatch


def _run(order: _Order) -> CaseResult:
    """Run; the signals stay in their files."""
    (result,) = run_cases(
        [order.case], lambda _: order.files, limits=order.limits, stopwatch=order.stopwatch
    )
    for one in (result, *result.probes):
        one.series = None
    return result


def _run_beside(order: _Order) -> CaseResult:
    """Run in an interpreter of its own, which watches the process of the run.

    A worker has threads, which a fork would not take along, and may have no child processes.
    """
    with TemporaryDirectory(prefix="axisrig-") as name:
        path = Path(name) / "order"
        path.write_bytes(pickle.dumps(order))
        done = subprocess.run(
            [sys.executable, "-c", _APART.format(str(path), os.getpid())],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            check=False,
        )
        if done.returncode != 0:
            reason = f"the process of the run ended: exit code {done.returncode}"
            result = no_values(order.case, Verdict.ERROR, reason)
            result.log = done.stderr.decode(errors="replace").splitlines()
            return result
        returned: CaseResult = pickle.loads(path.read_bytes())
        return returned


def run_apart_from(path: str, worker: int) -> None:
    """Run what a worker has written to a file, and write the result there instead.

    worker: id of its process, with which this one ends.
    """
    end_with(worker)
    file = Path(path)
    file.write_bytes(pickle.dumps(_run(pickle.loads(file.read_bytes()))))


def _tree(parcel: _Parcel, contents: Mapping[str, bytes]) -> Path:
    """Return the folder with the files of a parcel, made where the cache lacks it."""
    listed = "\n".join(f"{name} {key}" for name, (key, _) in sorted(parcel.names.items()))
    import platformdirs  # noqa: PLC0415 - in a worker only

    cache = Path(platformdirs.user_cache_dir("axisrig")) / "cluster"
    tree = cache / hashlib.sha256(listed.encode()).hexdigest()
    if not tree.is_dir():
        cache.mkdir(parents=True, exist_ok=True)
        made = Path(mkdtemp(prefix=".new-", dir=cache))
        for name, (key, _) in parcel.names.items():
            path = made / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(contents[key])
        try:
            made.replace(tree)
        except OSError:  # another worker of this machine was first
            shutil.rmtree(made, ignore_errors=True)
    return tree


def _renamed(value: Any, here: Mapping[str, str]) -> Any:
    """Name files as the process that asked for the run does, wherever a text names one."""
    if isinstance(value, str):
        for there, path in here.items():
            value = value.replace(there, path)
        return value
    if isinstance(value, Case):
        return value  # the one who asked has its own
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        changes = {
            field.name: _renamed(getattr(value, field.name), here)
            for field in dataclasses.fields(value)
            if field.init
        }
        return dataclasses.replace(value, **changes)
    if type(value) in (tuple, list):
        return type(value)(_renamed(item, here) for item in value)
    if type(value) is dict:
        return {key: _renamed(item, here) for key, item in value.items()}
    return value


def _unpacked(case: Case, content: bytes | str, files_of: Callable[[str], RunFiles]) -> CaseResult:
    """Put what a worker gave back where the files of its run belong; a text: why there is none."""
    if isinstance(content, str):
        return no_values(case, Verdict.ERROR, content)
    returned: _Returned = pickle.loads(content)
    result = returned.result
    if result is None:
        return no_values(case, Verdict.ERROR, returned.error)
    files = files_of(case.run)
    for one, place in zip((result, *result.probes), (files, *files.probes), strict=False):
        run = one.case.run
        several = logs_beside(run, returned.files) if place.bus_logs else []
        for path in (
            *place.bus_logs,
            *(place.bus_logs[0].with_name(name) for name in several),
            *([] if place.trace is None else [place.trace]),
        ):
            name = path.name if path.name in several else f"{run}{path.suffix}"
            written = returned.files.get(name)
            if written is not None:
                path.write_bytes(written)
                if path == place.trace:
                    one.series = Series(path)
        if one is not result:  # the probes of the case as it is here
            one.case = dataclasses.replace(
                one.case,
                inputs={c: case.inputs.get(c, text) for c, text in one.case.inputs.items()},
                program=case.program,
                rig=case.rig,
                folder=case.folder,
                file=case.file,
                module=case.module,
            )
    result.case = case
    return result
