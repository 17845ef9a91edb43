"""How fast are two coupled FMUs: our slaves, scheduler and series beside C and fmpy's methods.

A servo axis in motion and a touch probe that follows it, in steps of 1 ms. Each way does the same:
step the axis, read its position and velocity, hand the motion of the step to the probe, step it,
read its gap and clearance, keep a row.
"""

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from fmpy.fmi3 import FMU3Slave
from tests.perf.loop import compiled_loops

from axisrig.bench.record.series import TIME, Series, SeriesWriter
from axisrig.fmus import BuildError, ensure_built
from axisrig.kernel.cosim.fmi.fmu import Exchange, FmuSlave, load_description, load_fmu
from axisrig.kernel.cosim.fmi.steps import StepsInARow
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, TimeNs
from axisrig.kernel.time.scheduler import new_scheduler

AXIS, PROBE = "AxisRig.Drives.ServoAxis", "AxisRig.Sensors.TouchProbe"
MOTION = ("position", "velocity")
TRAJECTORY = ("step_time", "step_size", "z_start", "z_rate_start", "z_end", "z_rate_end")
RESULTS = ("gap", "clearance")
COLUMNS = ("time_s", *MOTION, *RESULTS)
# The least of many measurements counts, since a busy machine spoils some
STEPS = 500  # of 1 ms in one measurement
ROUNDS = 8
STEP_S = 1e-3
VELOCITY_M_S = 0.01
# The probe touches nothing
START: dict[str, dict[str, bool | float]] = {AXIS: {"enabled": True}, PROBE: {"surface": -1.0}}
DEMAND = {"reference_velocity": VELOCITY_M_S, "reference_end": 1e9}


def measure_pair(repeats: int, clock_ns: Callable[[], int]) -> dict[str, Any]:
    """Time a step of 1 ms of both FMUs, three ways in turns; the least of 8 `repeats` counts.

    Returns `c_loop_us`, `ours_us`, `fmpy_us` for each step, `beyond_c_us`, `fmpy_beyond_c_us` and
    `ratio` of these two, `steps`, `repeats`. Raises UserError when there is no C compiler, or when
    the three ways do not come to the same values.
    """
    try:
        axis, probe = ensure_built(AXIS), ensure_built(PROBE)
        loops = compiled_loops()
    except BuildError as error:
        raise UserError(f"the steps cannot be timed: {error}") from error
    least_ns: dict[str, int] = {}
    for _ in range(repeats):
        with _in_c(loops, axis, probe) as c, _ours(axis, probe) as ours, _fmpy(axis, probe) as fmpy:
            ways = {"c_loop": c, "ours": ours, "fmpy": fmpy}
            for number in range(ROUNDS):
                ends = set()
                for name, run in ways.items():
                    begin = clock_ns()
                    rows = run(number * STEPS)
                    spent = clock_ns() - begin
                    least_ns[name] = min(least_ns.get(name, spent), spent)
                    ends.add(tuple(float(f"{value:.12g}") for value in rows))
                if len(ends) > 1:
                    raise UserError(f"the ways to step differ: {sorted(ends)}")
    us = {f"{name}_us": spent / STEPS / 1e3 for name, spent in least_ns.items()}
    beyond = {
        "beyond_c_us": us["ours_us"] - us["c_loop_us"],
        "fmpy_beyond_c_us": us["fmpy_us"] - us["c_loop_us"],
    }
    ratio = beyond["beyond_c_us"] / (beyond["fmpy_beyond_c_us"] or 1.0)
    return {**us, **beyond, "ratio": ratio, "steps": STEPS, "repeats": repeats}


Run = Callable[[int], tuple[float, ...]]
"""Takes STEPS steps from the step with this number on; returns the last row, see COLUMNS."""


@contextmanager
def _slaves(axis_file: Path, probe_file: Path) -> Iterator[tuple[FmuSlave, FmuSlave]]:
    """Load both, start them, and let the axis follow a constant velocity."""
    axis, probe = load_fmu(axis_file, "axis"), load_fmu(probe_file, "probe")
    try:
        for slave, start in ((axis, START[AXIS]), (probe, START[PROBE])):
            for name, value in start.items():
                slave.set_start(name, value)
            slave.initialize(0)
        demand = Exchange(axis, list(DEMAND))
        demand.values[:] = list(DEMAND.values())
        demand.write()
        yield axis, probe
    finally:
        axis.close()
        probe.close()


@contextmanager
def _ours(axis_file: Path, probe_file: Path) -> Iterator[Run]:
    """Step with our slaves from events of a scheduler; rows go into series as a block.

    Each slave is set, stepped and read in one call, as the plants of a run do it.
    """
    scheduler = new_scheduler()
    with _slaves(axis_file, probe_file) as (axis, probe):
        motion = Exchange(axis, MOTION)
        drive = StepsInARow(axis, outputs=motion.references)
        follow = StepsInARow(
            probe, Exchange(probe, TRAJECTORY).references, Exchange(probe, RESULTS).references
        )
        rows: list[tuple[float, ...]] = []
        times: list[TimeNs] = []
        motion.read()
        now = motion.values[:]

        def step() -> None:
            nonlocal now
            begin_ns, end_ns = axis.time_ns, scheduler.now_ns
            before, (now,) = now, drive.take([end_ns])
            given = [begin_ns * 1e-9, (end_ns - begin_ns) * 1e-9, *before, *now]
            (results,) = follow.take([end_ns], given)
            times.append(end_ns)
            rows.append((*now, *results))
            scheduler.call_at(end_ns + MS, 0, step)

        def run(first: int) -> tuple[float, ...]:
            scheduler.run_until((first + STEPS) * MS)
            series = _series(times, rows)
            last = tuple(float(series.column(name)[-1]) for name in COLUMNS[1:])
            times.clear()
            rows.clear()
            return ((first + STEPS) * STEP_S, *last)

        scheduler.call_at(MS, 0, step)
        yield run


def _series(times: list[TimeNs], rows: list[tuple[float, ...]]) -> Series:
    """Put rows into series, as the recorder of a run does with a block."""
    values = np.array(rows, dtype=np.float64).T
    writer = SeriesWriter(None)
    columns = {name: pa.array(column) for name, column in zip(COLUMNS[1:], values, strict=True)}
    writer.add({TIME: pa.array(np.array(times, dtype=np.int64))} | columns)
    return writer.close()


class _Side(ctypes.Structure):
    """`Side` of step_loop.c."""

    _fields_ = [
        (name, ctypes.c_void_p) for name in ("step", "get", "set", "instance", "inputs", "outputs")
    ]


def _side(slave: FmuSlave, inputs: tuple[str, ...], outputs: tuple[str, ...]) -> _Side:
    library = slave.fmpy.dll
    functions = (library.fmi3DoStep, library.fmi3GetFloat64, library.fmi3SetFloat64)
    places = [ctypes.cast(function, ctypes.c_void_p).value for function in functions]
    references = [
        (ctypes.c_uint32 * len(names))(*(slave.variable(name).valueReference for name in names))
        for names in (inputs, outputs)
    ]
    addresses = [ctypes.addressof(array) for array in references]
    side = _Side(*places, slave.pointer, *addresses)
    side.kept = references  # as long as the side
    return side


@contextmanager
def _in_c(loops: Any, axis_file: Path, probe_file: Path) -> Iterator[Run]:
    """Step in a loop in C, which keeps the rows in an array."""
    loop = loops.couple_loop
    pointer, real = ctypes.c_void_p, ctypes.c_double
    loop.argtypes = (pointer, pointer, real, real, ctypes.c_int, pointer)
    loop.restype = ctypes.c_int
    rows = np.zeros((STEPS, len(COLUMNS)))
    with _slaves(axis_file, probe_file) as (axis, probe):
        sides = _side(axis, (), MOTION), _side(probe, TRAJECTORY, RESULTS)
        places = [ctypes.addressof(side) for side in sides]

        def run(first: int) -> tuple[float, ...]:
            done = loop(*places, first * STEP_S, STEP_S, STEPS, rows.ctypes.data)
            if done != STEPS:
                raise UserError(f"only {done} of {STEPS} steps succeeded")
            return tuple(float(value) for value in rows[-1])

        yield run


@contextmanager
def _fmpy(axis_file: Path, probe_file: Path) -> Iterator[Run]:
    """Step with the methods of fmpy; rows are kept in a list and become an array."""
    axis, motion = _by_fmpy(axis_file, AXIS, MOTION)
    probe, results = _by_fmpy(probe_file, PROBE, RESULTS)
    description, _ = load_description(probe_file)
    trajectory = _references(description, TRAJECTORY)
    demand = _references(load_description(axis_file)[0], tuple(DEMAND))
    axis.setFloat64(demand, list(DEMAND.values()))
    now = axis.getFloat64(motion)

    def run(first: int) -> tuple[float, ...]:
        nonlocal now
        rows = []
        for begin, end in pairwise(range(first, first + STEPS + 1)):
            begin_s, before = begin * STEP_S, now
            axis.doStep(begin_s, STEP_S)
            now = axis.getFloat64(motion)
            probe.setFloat64(trajectory, [begin_s, STEP_S, *before, *now])
            probe.doStep(begin_s, STEP_S)
            rows.append((end * STEP_S, *now, *probe.getFloat64(results)))
        table = np.array(rows)
        return tuple(float(value) for value in table[-1])

    try:
        yield run
    finally:
        for slave in (axis, probe):
            with suppress(Exception):
                slave.terminate()
            slave.fmi3FreeInstance(slave.component)


def _references(description: Any, names: tuple[str, ...]) -> list[int]:
    known = {variable.name: variable.valueReference for variable in description.modelVariables}
    return [known[name] for name in names]


def _by_fmpy(file: Path, model: str, outputs: tuple[str, ...]) -> tuple[Any, list[int]]:
    """Return an initialised slave of fmpy and the references of its outputs."""
    description, folder = load_description(file)
    slave = FMU3Slave(
        instanceName=model.rpartition(".")[2],
        guid=description.instantiationToken,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
    )
    slave.instantiate()
    for name, value in START[model].items():
        references = _references(description, (name,))
        if isinstance(value, bool):
            slave.setBoolean(references, [value])
        else:
            slave.setFloat64(references, [value])
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave, _references(description, outputs)
