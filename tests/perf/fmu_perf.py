"""How fast is an axis: a step of 1 ms from Python beside the same step in a loop of C.

Three times of one step: of a loop in C over fmi3DoStep, of the bare call from Python (the same
arguments, but no instance, which the function refuses at once), and of our slave.
"""

import ctypes
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.perf.loop import compiled_loops

from axisrig.fmus import BuildError, ensure_built
from axisrig.kernel.cosim.fmi.fmu import Exchange, FmuSlave, load_fmu
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

MODEL = "AxisRig.Drives.ServoAxis"
# A measurement is shorter than the slice of time that a busy machine gives, and the least counts.
STEPS = 100  # of 1 ms in one measurement
ROUNDS = 20
VELOCITY_M_S = 0.01


def measure_fmu(repeats: int, clock_ns: Callable[[], int]) -> dict[str, Any]:
    """Time a step of 1 ms of an axis in motion; the least of 20 `repeats` measurements counts.

    Returns `c_loop_us`, `call_us`, `slave_us`, `ratio` = slave/(loop + call), `steps`, `repeats`.
    Raises UserError when there is no C compiler.
    """
    try:
        path = ensure_built(MODEL)
        loop = _loop()
    except BuildError as error:
        raise UserError(f"the step cannot be timed: {error}") from error
    times_ns: dict[str, list[int]] = {"c_loop": [], "call": [], "slave": []}
    runs = (("c_loop", _in_c(loop)), ("call", _bare_call), ("slave", _slave))
    for _ in range(repeats):
        axis = _moving(path)
        for name, run in runs * ROUNDS:
            begin = clock_ns()
            run(axis)
            times_ns[name].append(clock_ns() - begin)
        axis.close()
    least_us = {f"{name}_us": min(times) / STEPS / 1e3 for name, times in times_ns.items()}
    ratio = least_us["slave_us"] / (least_us["c_loop_us"] + least_us["call_us"])
    return {"fmu": path.name, **least_us, "ratio": ratio, "steps": STEPS, "repeats": repeats}


def show_fmu(result: dict[str, Any], as_json: bool) -> str:
    """Return the result as one JSON object or as a table."""
    if as_json:
        return json.dumps(result)
    return "\n".join(
        [
            f"{result['fmu']}: a step of 1 ms, us (least of {result['repeats'] * ROUNDS} times"
            f" {result['steps']} steps)",
            f"  loop in C       {result['c_loop_us']:8.2f}",
            f"  bare call       {result['call_us']:8.2f}",
            f"  slave           {result['slave_us']:8.2f}",
            f"slave / (loop + call) = {result['ratio']:.2f}",
        ]
    )


def _moving(path: Path) -> FmuSlave:
    """A new axis that has followed a constant velocity for 0.1 s."""
    axis = load_fmu(path, "axis")
    axis.initialize(0)
    for names, values in (
        (["enabled"], [True]),
        (["reference_velocity", "reference_end"], [VELOCITY_M_S, 1e9]),
    ):
        exchange = Exchange(axis, names)
        exchange.values[:] = values
        exchange.write()
    axis.step_to(100 * MS)
    return axis


def _loop() -> Any:
    """The loop in C over doStep."""
    function = compiled_loops().step_loop
    pointer, real = ctypes.c_void_p, ctypes.c_double
    function.argtypes = (pointer, pointer, real, real, ctypes.c_int)
    function.restype = ctypes.c_int
    return function


def _in_c(loop: Any) -> Callable[[FmuSlave], None]:
    def run(axis: FmuSlave) -> None:
        address = ctypes.cast(axis.fmpy.dll.fmi3DoStep, ctypes.c_void_p)
        done = loop(address, axis.pointer, axis.time_ns * 1e-9, 1e-3, STEPS)
        axis.time_ns += STEPS * MS
        if done != STEPS:
            raise UserError(f"only {done} of {STEPS} steps succeeded")

    return run


def _bare_call(axis: FmuSlave) -> None:
    step, tail = axis._step, axis._step_tail
    for _ in range(STEPS):
        step(None, 0.1, 1e-3, True, *tail)


def _slave(axis: FmuSlave) -> None:
    begin_ns = axis.time_ns
    for number in range(1, STEPS + 1):
        axis.step_to(begin_ns + number * MS)
