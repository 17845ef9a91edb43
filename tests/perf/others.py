"""One step of two coupled FMUs with several tools: `python tests/perf/others.py TOOL AXIS PROBE`.

TOOL: axisrig, fmpy, ecos (ecospy) or libcosim (libcosimpy), run by a Python that has it. AXIS and
PROBE: `AxisRig.Drives.ServoAxis` and `AxisRig.Sensors.TouchProbe` as FMI 2.0 (`axisrig fmu build
MODEL --fmi 2.0` prints the file). Each tool does the same in steps of 1 ms: position and velocity
of the axis go to the probe, both FMUs are stepped, four outputs are read into a row. Printed: CPU
time of a step, the least of many measurements, and where the axis is at the end.
"""

# Each tool is imported where it is used: hardly anybody has all of them
# ruff: noqa: PLC0415

import sys
import time
from collections.abc import Callable

STEPS, ROUNDS = 1000, 12
STEP_NS = 1_000_000
VELOCITY_M_S = 0.01
MOTION, RESULTS = ("position", "velocity"), ("gap", "clearance")
WIRES = (("position", "z_start"), ("velocity", "z_rate_start"), ("position", "z_end"),
         ("velocity", "z_rate_end"))  # fmt: skip
DEMAND = {"reference_velocity": VELOCITY_M_S, "reference_end": 1e9}
SURFACE_M, SIZE_S = -1.0, 1e-3

Row = tuple[float, ...]
Step = Callable[[int], Row]


def _axisrig(axis_file: str, probe_file: str) -> Step:
    from pathlib import Path

    from axisrig.kernel.cosim.fmi.fmu import Exchange, load_fmu
    from axisrig.kernel.cosim.fmi.steps import StepsInARow

    axis, probe = load_fmu(Path(axis_file), "axis"), load_fmu(Path(probe_file), "probe")
    axis.set_start("enabled", True)
    probe.set_start("surface", SURFACE_M)
    probe.set_start("step_size", SIZE_S)
    axis.initialize(0)
    probe.initialize(0)
    demand = Exchange(axis, list(DEMAND))
    demand.values[:] = list(DEMAND.values())
    demand.write()
    motion, sinks = Exchange(axis, MOTION), [sink for _, sink in WIRES]
    drive = StepsInARow(axis, outputs=motion.references)
    follow = StepsInARow(
        probe, Exchange(probe, sinks).references, Exchange(probe, RESULTS).references
    )

    def step(number: int) -> Row:
        end_ns = (number + 1) * STEP_NS
        (now,) = drive.take([end_ns])
        (seen,) = follow.take([end_ns], [*now, *now])
        return (*now, *seen)

    return step


def _fmpy(axis_file: str, probe_file: str) -> Step:
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    def slave(file: str, name: str) -> tuple[FMU2Slave, dict[str, int]]:
        about = read_model_description(file)
        made = FMU2Slave(
            guid=about.guid,
            unzipDirectory=extract(file),
            modelIdentifier=about.coSimulation.modelIdentifier,
            instanceName=name,
        )
        made.instantiate()
        made.setupExperiment(startTime=0.0)
        return made, {v.name: v.valueReference for v in about.modelVariables}

    (axis, of_axis), (probe, of_probe) = slave(axis_file, "axis"), slave(probe_file, "probe")
    axis.setBoolean([of_axis["enabled"]], [True])
    probe.setReal([of_probe["surface"], of_probe["step_size"]], [SURFACE_M, SIZE_S])
    for made in (axis, probe):
        made.enterInitializationMode()
        made.exitInitializationMode()
    axis.setReal([of_axis[name] for name in DEMAND], list(DEMAND.values()))
    motion, results = [of_axis[n] for n in MOTION], [of_probe[n] for n in RESULTS]
    sinks = [of_probe[sink] for _, sink in WIRES]

    def step(number: int) -> Row:
        at_s = number * STEP_NS * 1e-9
        axis.doStep(at_s, STEP_NS * 1e-9)
        now = axis.getReal(motion)
        probe.setReal(sinks, [*now, *now])
        probe.doStep(at_s, STEP_NS * 1e-9)
        return (*now, *probe.getReal(results))

    return step


def _ecos(axis_file: str, probe_file: str) -> Step:
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("axis", axis_file)
    structure.add_model("probe", probe_file)
    for source, sink in WIRES:
        structure.make_real_connection(f"axis::{source}", f"probe::{sink}")
    start = {f"axis::{name}": value for name, value in DEMAND.items()}
    start |= {"axis::enabled": True, "probe::surface": SURFACE_M, "probe::step_size": SIZE_S}
    structure.add_parameter_set("start", start)
    simulation = EcosSimulation(structure=structure, step_size=STEP_NS * 1e-9)
    simulation.init(parameter_set="start")
    names = [*(f"axis::{name}" for name in MOTION), *(f"probe::{name}" for name in RESULTS)]

    def step(_number: int) -> Row:
        simulation.step()
        return tuple(simulation.get_real(name) for name in names)

    return step


def _libcosim(axis_file: str, probe_file: str) -> Step:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(STEP_NS)
    slaves = [CosimLocalSlave(axis_file, "axis"), CosimLocalSlave(probe_file, "probe")]
    axis, probe = (execution.add_local_slave(slave) for slave in slaves)

    def references(slave: int) -> dict[str, int]:
        return {v.name.decode(): v.reference for v in execution.slave_variables(slave)}

    of_axis, of_probe = references(axis), references(probe)
    for source, sink in WIRES:
        execution.connect_real_variables(axis, of_axis[source], probe, of_probe[sink])
    execution.boolean_initial_value(axis, of_axis["enabled"], True)
    for name, value in DEMAND.items():
        execution.real_initial_value(axis, of_axis[name], value)
    execution.real_initial_value(probe, of_probe["surface"], SURFACE_M)
    execution.real_initial_value(probe, of_probe["step_size"], SIZE_S)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    motion, results = [of_axis[n] for n in MOTION], [of_probe[n] for n in RESULTS]
    kept = (execution, slaves, observer)

    def step(_number: int) -> Row:
        kept[0].step()
        return (
            *observer.last_real_values(axis, motion),
            *observer.last_real_values(probe, results),
        )

    return step


TOOLS = {"axisrig": _axisrig, "fmpy": _fmpy, "ecos": _ecos, "libcosim": _libcosim}


def measure(tool: str, axis_file: str, probe_file: str) -> tuple[float, Row]:
    """Return the CPU time of a step, us, the least of all rounds, and the last row."""
    step = TOOLS[tool](axis_file, probe_file)
    least_ns, rows = 0, list[Row]()
    for number in range(ROUNDS):
        rows = []
        began_ns = time.process_time_ns()
        for place in range(number * STEPS, (number + 1) * STEPS):
            rows.append(step(place))
        spent_ns = time.process_time_ns() - began_ns
        least_ns = min(least_ns or spent_ns, spent_ns)
    return least_ns / STEPS / 1e3, rows[-1]


if __name__ == "__main__":
    spent_us, (position_m, velocity_m_s, *_) = measure(*sys.argv[1:4])
    print(f"{sys.argv[1]}: {spent_us:.2f} us a step; {position_m:.9f} m, {velocity_m_s:.9f} m/s")
