"""Trials of an FMU, each in a process of its own: whatever it does there harms nothing else."""

import hashlib
import locale
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from axisrig.bench.rig.fmu_output import printed_lines
from axisrig.bench.tools.fmu.courses import course_findings
from axisrig.bench.tools.fmu.findings import Finding, fail, ok, warn
from axisrig.bench.tools.fmu.roles import role_findings
from axisrig.bench.tools.fmu.stepped_instance import (
    Reading,
    Trial,
    first_difference,
    largest_share,
    not_finite,
    step_of,
)
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

STEPS = 100
STATE_BOUND = 1e-9
"""Of the range of an output: 1 nm of 1 m, a tenth of an increment of 10 mm in 2^20."""
# Exchange steps of rigs: the default of docs/rigs.md, a long one, and the fine ones near an edge
BENCH_STEPS_NS: tuple[TimeNs, ...] = (1_000_000, 250_000, 50_000)
_NEEDED = {
    "fmi2": (
        *("GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance", "SetupExperiment"),
        *("EnterInitializationMode", "ExitInitializationMode", "Terminate", "Reset", "DoStep"),
        *("GetReal", "GetInteger", "GetBoolean", "SetReal", "SetInteger", "SetBoolean"),
    ),
    "fmi3": (
        *("GetVersion", "InstantiateCoSimulation", "FreeInstance", "DoStep", "Reset", "Terminate"),
        *("EnterInitializationMode", "ExitInitializationMode", "GetFloat64", "SetFloat64"),
    ),
}
_STATE = ("Get{0}", "Set{0}", "Free{0}")
_SERIAL = ("Serialized{0}Size", "Serialize{0}", "{1}erialize{0}")


@dataclass
class Outcome:
    """What a trial found. digest: of all outputs, to be compared with another process."""

    findings: list[Finding] = field(default_factory=list)
    digest: str = ""


@contextmanager
def _trial(path: Path, name: str = "trial", *, moves: bool = True) -> Iterator[Trial]:
    trial = Trial(path, name, moves=moves)
    try:
        yield trial
    finally:
        trial.close()


def _step_ns(trial: Trial) -> TimeNs:
    return step_of(trial.slave.description)


def load(path: Path) -> Outcome:
    """Load the library: has it all functions, and the version that the description gives?"""
    with _trial(path) as trial:
        slave = trial.slave
        dll, word = slave.fmpy.dll, slave.STATE_WORD
        names = list(_NEEDED[slave.PREFIX])
        if slave.can.can_save_state:
            names += [name.format(word) for name in _STATE]
        if slave.can.can_serialize_state:
            back = "DeS" if slave.PREFIX == "fmi2" else "Des"
            names += [name.format(word, back) for name in _SERIAL]
        missing = [name for name in names if not hasattr(dll._dll, f"{slave.PREFIX}{name}")]
        version = slave.fmpy.fmi2GetVersion if slave.PREFIX == "fmi2" else slave.fmpy.fmi3GetVersion
        said = "" if missing else version().decode("utf-8", errors="replace")
    found = Outcome()
    if missing:
        text = ", ".join(f"{slave.PREFIX}{name}" for name in missing)
        found.findings.append(fail("library", f"functions are missing: {text}", "export it again"))
    else:
        found.findings.append(ok("library", f"loads, has every function needed, version {said}"))
    declared = str(slave.description.fmiVersion)
    if said and said.split(".")[0] != declared.split(".", maxsplit=1)[0]:
        text = f"the library says version {said}, the description {declared}"
        found.findings.append(fail("library", text, "export it again"))
    return found


def _surroundings() -> dict[str, object]:
    """What an FMU shares with everything else in its process."""
    return {
        "working folder": str(Path.cwd()),
        "locale of numbers": locale.localeconv()["decimal_point"],
        "arithmetic": _has_plain_arithmetic(),
        "environment": dict(os.environ),
    }


def _has_plain_arithmetic() -> bool:
    """Return whether denormal numbers exist and sums round to nearest (IEEE 754)."""
    smallest, one = sys.float_info.min, float(len(sys.argv[:1]) or 1)
    return smallest / 4.0 * one > 0.0 and one + 2.0**-53 == one and one + 1.5 * 2.0**-53 > one


def _changes(before: dict[str, object], after: dict[str, object]) -> Iterator[Finding]:
    for what, was in before.items():
        if after[what] == was:
            continue
        if what == "arithmetic":
            text = "it switches denormal numbers or the rounding of the whole process"
            yield fail("call sequence", text, "it was built with -ffast-math; build it without")
        else:
            text = f"it changes the {what} of the process"
            yield warn("call sequence", text, "its case alone feels it")


def sequence(path: Path) -> Outcome:
    """Go through a run as a rig does: instantiate, initialise, step, terminate, free."""
    found, before = Outcome(), _surroundings()
    with _trial(path, moves=False) as trial:
        trial.start()
        first = trial.read()
        step_ns = _step_ns(trial)
        readings = trial.run([step_ns] * STEPS)
        last = (readings or [first])[-1]
        broken = not_finite(first, trial.outputs) or not_finite(last, trial.outputs)
        messages = list(trial.slave.messages)
    text = f"{len(readings)} steps of {step_ns / 1e6:g} ms, terminated, freed"
    found.findings.append(ok("call sequence", text))
    if len(readings) < STEPS:
        text = f"it ended the simulation by itself after t = {last.time_ns / 1e6:g} ms"
        found.findings.append(warn("call sequence", text, "a run of the bench must end before"))
    if broken:
        text = f"outputs that are no finite number: {', '.join(broken[:6])}"
        found.findings.append(warn("call sequence", text, "set start values and inputs in the rig"))
    if messages:
        text = f"{len(messages)} messages, the first: {messages[0].text}"
        found.findings.append(warn("call sequence", text))
    found.findings += _changes(before, _surroundings())
    printed = printed_lines()
    if printed:
        text = f"{len(printed)} lines on standard output, the first: {printed[0]}"
        found.findings.append(warn("call sequence", text, "a run has them in its log"))
    return found


def steps(path: Path) -> Outcome:
    """Take steps of other lengths than the FMU proposes."""
    found = Outcome()
    with _trial(path) as trial:
        step_ns, can = _step_ns(trial), trial.slave.can
    inner_ns = round((can.fixed_step_s or 0.0) * 1e9)
    plans = {f"{ns / 1e6:g} ms": [ns] * STEPS for ns in BENCH_STEPS_NS}
    if can.can_vary_step:
        mixed = [max(1, step_ns // part) for part in (1, 3, 1, 10, 7)] * (STEPS // 10)
        plans["mixed lengths"] = [*mixed, *(2 * step_ns for _ in mixed)]
    taken = []
    for words, lengths in plans.items():
        try:
            with _trial(path) as trial:
                trial.start()
                trial.run(lengths)
            taken.append(words)
        except PlantError as error:
            text = f"refuses steps of {words}: {error.reason}"
            remedy = "choose a cycle and exchange_us that it takes (docs/rigs.md)"
            found.findings.append(warn("steps", text, remedy))
    if taken:
        found.findings.append(ok("steps", f"takes {', '.join(taken)}"))
    found.findings += course_findings(path, inner_ns)
    if inner_ns > BENCH_STEPS_NS[1]:
        text = f"its own step of {inner_ns / 1e6:g} ms is longer than those of the bench"
        found.findings.append(warn("steps", text, "outputs change only that often"))
    return found


def determinism(path: Path) -> Outcome:
    """Run twice in one process; the digest is compared with a third run in another process."""
    runs: list[list[Reading]] = []
    for name in ("one", "two"):
        with _trial(path, name) as trial:
            trial.start()
            runs.append([trial.read(), *trial.run([_step_ns(trial)] * STEPS)])
            outputs = trial.outputs
    digest = hashlib.sha256(b"".join(reading.bits for reading in runs[0])).hexdigest()
    difference = first_difference(runs[0], runs[1], outputs)
    if difference:
        text = f"two runs differ: {difference}"
        return Outcome([fail("determinism", text, "results with it cannot be repeated")], digest)
    text = f"two runs of {len(runs[0]) - 1} steps are equal bit for bit"
    return Outcome([ok("determinism", text)], digest)


def reset(path: Path) -> Outcome:
    """Reset after a run and run again."""
    with _trial(path) as trial:
        step_ns = _step_ns(trial)
        trial.start()
        first = [trial.read(), *trial.run([step_ns] * STEPS)]
        try:
            trial.reset()
            trial.start()
            again = [trial.read(), *trial.run([step_ns] * STEPS)]
        except Exception as error:  # fmpy reports a refused reset by a plain Exception
            text = f"refuses: {error}"
            return Outcome([warn("reset", text, "the bench makes new instances instead")])
        difference = first_difference(first, again, trial.outputs)
    if difference:
        text = f"a run after reset differs: {difference}"
        return Outcome([warn("reset", text, "the bench makes new instances instead")])
    return Outcome([ok("reset", "a run after reset is equal bit for bit")])


def state(path: Path) -> Outcome:
    """Save the state, go on, go back, go on again; then the same through bytes."""
    with _trial(path) as trial:
        can = trial.slave.can
        if not can.can_save_state:
            return Outcome()
        length = [_step_ns(trial)] * (STEPS // 4)
        trial.start()
        trial.run(length)
        saved = trial.slave.save_state()
        count = trial.count
        first = trial.run(length)
        found = []
        for _ in range(2):
            trial.slave.restore_state(saved)
            trial.count = count
            found.append(_compared("state", "restored", first, trial.run(length), trial))
        if can.can_serialize_state and not any(item.level == "FAIL" for item in found):
            fmu = trial.slave.fmpy
            packed = fmu.serializeFMUState(saved.handle)
            handle = fmu.deserializeFMUState(packed)
            fmu.setFMUState(handle)
            trial.slave.time_ns, trial.count = saved.time_ns, count
            again = trial.run(length)
            fmu.freeFMUState(handle)
            what = f"state of {len(packed)} bytes unpacked"
            found.append(_compared("state as bytes", what, first, again, trial))
    return Outcome(found[1:] if found[0] == found[1] else found)


def _compared(
    area: str, how: str, first: Sequence[Reading], again: Sequence[Reading], trial: Trial
) -> Finding:
    difference = first_difference(first, again, trial.outputs)
    if difference:
        share = largest_share(first, again, trial.outputs)
        text = (
            f"{how}, the run differs: {difference}; by {share:.1e} of the range of an output,"
            f" bound {STATE_BOUND:g}"
        )
        if share <= STATE_BOUND:
            return warn(area, text, "less than an increment of an encoder: edges are searched")
        remedy = "edges cannot be searched with it: leave canGetAndSetFMUState out of the FMU"
        return fail(area, text, remedy)
    return ok(area, f"{how}, the run is equal bit for bit")


def instances(path: Path) -> Outcome:
    """Step two instances in turns: each must run as it does alone."""
    with _trial(path) as trial:
        if trial.slave.can.once_per_process:
            return Outcome([ok("instances", "one only, as its description says")])
        step_ns = _step_ns(trial)
        trial.start()
        alone = trial.run([step_ns] * STEPS)
    with _trial(path, "one") as one, _trial(path, "two") as two:
        half, rest = len(alone) // 2, len(alone) - len(alone) // 2
        one.start()
        first = one.run([step_ns] * half)
        two.start()
        second: list[Reading] = []
        for _ in range(rest):
            second += two.run([step_ns])
            first += one.run([step_ns])
        second += two.run([step_ns] * half)
        difference = first_difference(alone, first, one.outputs) or first_difference(
            alone, second, one.outputs
        )
    if difference:
        text = f"two instances disturb each other: {difference}"
        return Outcome([fail("instances", text, "use it once in a rig")])
    return Outcome([ok("instances", "two stepped in turns run as each does alone")])


def roles(path: Path) -> Outcome:
    """Say what the FMU could be in a rig, and what would be missing."""
    with _trial(path) as trial:
        return Outcome(list(role_findings(trial.slave)))


Stage = Callable[[Path], Outcome]
# Each only after the one before: what does not load cannot run
FIRST: dict[str, Stage] = {"library": load, "call sequence": sequence}
REST: dict[str, Stage] = {
    "steps": steps,
    "determinism": determinism,
    "reset": reset,
    "state": state,
    "instances": instances,
    "roles": roles,
}


def run_stage(area: str, path: Path) -> Outcome:
    """Run one stage: what the FMU does wrong is a finding."""
    stage = (FIRST | REST)[area]
    try:
        return stage(path)
    except UserError as error:
        return Outcome([fail(area, error.message, error.hint or "")])
    except PlantError as error:
        text = f"at t = {error.time_ns / 1e6:g} ms: {error.reason}"
        return Outcome([fail(area, text, "see what the FMU says; set its start values")])
    except Exception as error:  # fmpy reports a bad status by a plain Exception
        return Outcome([fail(area, str(error) or type(error).__name__)])
