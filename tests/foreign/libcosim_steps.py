"""Runs one FMU in libcosim: reads a task as JSON, prints the outputs at each communication point.

A program of its own, with the python that has libcosimpy: a crash of the importer harms nothing.
"""

import json
import sys

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

WORDS = {"real": "real", "int": "integer", "bool": "boolean"}
KINDS = {"real": float, "int": int, "bool": bool}


def main() -> None:
    task = json.load(sys.stdin)
    execution = CosimExecution.from_step_size(step_size=task["step_ns"])
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=task["fmu"], instance_name="m"))
    references = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
    for name, kind, value in task["start"]:
        set_start = getattr(execution, f"{WORDS[kind]}_initial_value")
        set_start(slave, references[name], KINDS[kind](value))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    manipulator = CosimManipulator.create_override()
    execution.add_manipulator(manipulator)
    outputs = [
        (getattr(observer, f"last_{WORDS[kind]}_values"), references[name])
        for name, kind in task["outputs"]
    ]
    rows = []
    for step in range(task["count"]):
        for at, name, kind, value in task["changes"]:
            if at == step:
                change = getattr(manipulator, f"slave_{WORDS[kind]}_values")
                change(slave, [references[name]], [KINDS[kind](value)])
        execution.step()
        rows.append([float(read(slave, [reference])[0]) for read, reference in outputs])
    print("\n" + json.dumps(rows))


if __name__ == "__main__":
    main()
