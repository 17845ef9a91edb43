"""`axisrig check`: plans, rigs and parameter lists, checked and described without a run."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from axisrig.bench.campaign.cell_warnings import (
    CellWarnings,
    bare_warning,
    refuse_warnings,
    rig_warnings,
)
from axisrig.bench.campaign.preparing import built_first, prepare, read_case, settings_of
from axisrig.bench.campaign.processes import do_apart
from axisrig.bench.campaign.talk import FEW
from axisrig.bench.machine.kept_fmus import close_plant
from axisrig.bench.machine.plants import build_plant, check_plants, describe_plants, start_plant
from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.plan.plan import Plan, counted, read_plan, selected
from axisrig.bench.plan.table import CHECK, SUFFIXES
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.contents import contents_text
from axisrig.bench.rig.describe import describe_axes
from axisrig.bench.rig.distance.check import (
    age_warnings,
    describe_distance,
    distance_warnings,
    drive_lags_s,
)
from axisrig.bench.rig.families import rig_families
from axisrig.bench.rig.fmu_output import printed_log
from axisrig.bench.rig.plc.words import VARIABLE
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.errors import UserError

LIST_SUFFIXES = (".lst", ".lis")
PROGRAM_SUFFIXES = (".nc", ".cnc", ".mpf")


def plan_of(path: Path) -> Plan | None:
    """Read a plan; None for another file. Raises UserError for a bad plan."""
    is_plan = path.suffix.lower() in SUFFIXES and not path.is_dir()
    return read_plan(path, settings_of) if is_plan else None


def rigs_of(path: Path, plan: Plan | None) -> list[Path]:
    """Return the rigs that `check_file` loads for a file."""
    if plan is not None:
        return sorted({case.rig for case in plan.cases})
    return [path] if path.suffix.lower() == ".toml" else []


def check_files(
    files: Sequence[Path],
    assignments: Sequence[str],
    limits: tuple[bool, float | None],
    show: Callable[[str], None],
    *,
    select: str | None = None,
    is_strict: bool = False,
    is_verbose: bool = False,
) -> None:
    """Do `check_file` for each file, also after one that is rejected.

    limits: as `do_apart` takes them. select: of `-k`, for plans. show: takes what is described.
    is_strict: a warning rejects a file too. is_verbose: name each run. Raises UserError with all
    that is wrong with any file.
    """
    mistakes, lacking, fits = Mistakes(), list[Plan](), False
    for file in files:
        with mistakes.kept():
            plan = plan_of(file)
            if plan is not None and select is not None:
                plan = selected(plan, select, may_be_none=True)
                if not plan.cases:
                    lacking.append(plan)
                    continue
                fits = True
            what = (
                partial(check_file, is_strict=is_strict, is_verbose=is_verbose, plan=plan),
                file,
                assignments,
            )
            show(do_apart(*what, rigs=rigs_of(file, plan), file=file, limits=limits))
    for plan in lacking[:1] if not fits else ():
        with mistakes.kept():
            selected(plan, select)
    mistakes.refuse(files[0])


def check_file(
    path: Path,
    assignments: Sequence[str] = (),
    *,
    is_strict: bool = False,
    is_verbose: bool = False,
    plan: Plan | None = None,
) -> str:
    """Check a plan, a rig or a parameter list and describe it.

    Raises UserError when it is rejected.

    assignments: texts of `--set`. is_strict: a warning rejects it too. is_verbose: name each run of
    a plan, not each case. plan: what is in the file, where it is a plan that was read before.
    """
    changes = [parse_assignment(text) for text in assignments]
    if path.suffix.lower() == ".toml":
        return _check_rig_file(path, changes, is_strict=is_strict)
    if path.suffix.lower() in LIST_SUFFIXES:
        return f"{path}\n{contents_text(path)}"
    if path.suffix.lower() in PROGRAM_SUFFIXES:
        hint = f"for an NC program: `axisrig nc --check {path}`"
        raise UserError("no plan, rig or list", file=path, hint=hint)
    if path.is_dir() or path.suffix.lower() not in SUFFIXES:
        message = "a folder, no file to check" if path.is_dir() else "not a file to check"
        allowed = ", ".join([*SUFFIXES, ".toml", *LIST_SUFFIXES])
        value = None if path.is_dir() else path.suffix
        raise UserError(message, file=path, value=value, allowed=allowed)
    plan = (plan or read_plan(path, settings_of)).with_inputs(changes)
    mistakes, warnings, first = Mistakes(), CellWarnings(), {*built_first(plan.cases)}
    for place, case in enumerate(plan.cases):
        with mistakes.kept(), _by_row(case):
            warnings.look(case, (prepare if place in first else read_case)(case))
    mistakes.refuse(path)
    lines = [f"  {text}" for text in _described(plan.cases, is_verbose=is_verbose)]
    runs = {case.run for case in plan.cases}
    statistics = [row for row in plan.statistics if runs >= {*row.runs}]  # with -k not all of them
    for row in statistics:
        asked = ", ".join(check.metric for check in row.checks)
        lines.append(f"  {row.run}  statistics over {len(row.runs)} runs: {asked}")
    if is_strict:
        refuse_warnings(warnings.lines())
    lines += [f"warning: {warning}" for warning in warnings.lines()]
    lines += [f"note: {note}" for note in (*plan.notes, *_without_checks(plan.cases))]
    if others := len(plan.cases) - len(first):
        built = f"{len(first)} rows was built, of the other {others} as they run"
        lines.append(f"note: the machine of {built}")
    return "\n".join([f"{path}: {counted(len(plan.cases), len(statistics))}", *lines])


@contextmanager
def _by_row(case: Case) -> Iterator[None]:
    """Name the row beside a variable that its program reads and no column gives."""
    try:
        yield
    except UserError as error:
        if error.file == str(case.program) and str(error.value).startswith(VARIABLE):
            row = f"{case.file.name}:{case.line} runs it (case {case.case!r})"
            error.hint = "; ".join(text for text in (error.hint, row) if text)
        raise


def _without_checks(cases: Sequence[Case]) -> list[str]:
    """Name the rows that ask for nothing: they pass unless an alarm comes up."""
    rows = {
        (case.file, case.line): case.case
        for case in cases
        if not case.sampled
        and case.search is None
        and not any(column.startswith(CHECK) for column in case.places)
    }
    return [
        f"{file}:{line}: case {name!r} has no check: it passes unless an alarm comes up"
        for (file, line), name in rows.items()
    ]


def check_inputs(plan: Plan) -> None:
    """Refuse inputs that the rig of their row refuses, without building its plants.

    Looked at are the first run of each row and each value of a list. Raises UserError with all of
    them, by their places.
    """
    seen: set[object] = set()
    mistakes = Mistakes()
    for case in plan.cases:
        row = (case.file, case.line, case.rig)
        keys = {row, *((*row, *pair) for pair in case.swept.items())}
        if not keys <= seen:
            seen |= keys
            with mistakes.kept():
                settings_of(case)
    mistakes.refuse(plan.path)


def _described(cases: Sequence[Case], *, is_verbose: bool) -> list[str]:
    """Name each case with how many runs it stands for; each run of few, or where asked for."""
    if is_verbose or len(cases) <= FEW:
        return [_titled(case) for case in cases]
    by_case: dict[str, list[Case]] = {}
    for case in cases:
        by_case.setdefault(case.case, []).append(case)
    return [_of_case(name, runs) for name, runs in by_case.items()]


def _of_case(name: str, runs: Sequence[Case]) -> str:
    if len(runs) == 1:
        return _titled(runs[0])
    return f"{name}: {_size(runs)} runs  {runs[0].title}".rstrip()


def _size(runs: Sequence[Case]) -> str:
    """Write how many runs a case has: `300 x 2` where they are all pairs of 300 and 2 values."""
    columns = list(runs[0].swept)
    counts = [len({run.swept.get(column) for run in runs}) for column in columns]
    counts = [count for count in (*counts, len({run.repeat for run in runs})) if count > 1]
    return " x ".join(map(str, counts)) if math.prod(counts) == len(runs) else str(len(runs))


def _titled(case: Case) -> str:
    text = f"{case.run}  {case.title}".rstrip()
    if case.search is None:
        return text
    search = case.search
    return f"{text}  searches {search.column}, at most {search.probes_max} probes"


def _check_rig_file(path: Path, changes: Sequence[Assignment], *, is_strict: bool) -> str:
    rig, files = read_rig(path)
    settings = read_settings(rig, files, [(change, as_written) for change in changes])
    check_rig(settings)
    plant = build_plant(settings)
    try:
        check_plants(settings, plant)
        start_plant(settings, plant)
        of_plants = [*describe_plants(settings, plant), *printed_log(settings)]
        loops = describe_distance(settings, drive_lags_s(settings, plant))
    finally:
        close_plant(plant)
    families = rig_families()
    tables = [text for family in families for text in family.tables(settings)]
    plants = ["\n".join(of_plants)] if of_plants else []
    lacking = [text for family in families for text in family.warn(settings)]
    lacking += [*distance_warnings(settings), *age_warnings(settings)]
    bare = [bare_warning(settings.bare, c) for c in changes if c.column in settings.bare]
    bare += rig_warnings(settings)
    if is_strict:
        refuse_warnings([*map(str, settings.warnings), *bare, *lacking])
    remarks = [f"warning: {warning}" for warning in settings.warnings]
    remarks += [f"note: {note}" for note in settings.notes]
    remarks += [f"warning: {warning}" for warning in (*bare, *lacking)]
    described = describe_axes(settings)
    described += [text for family in families for text in family.describe(settings)]
    axes = "\n".join([*described, *remarks])
    return "\n\n".join([f"{path}: {rig.title}", axes, *loops, *tables, *plants])
