"""Runs one FMU in ecos: reads a task as JSON, prints the outputs at each communication point.

A program of its own, with the python that has ecospy: what the importer does there harms nothing.
"""

import json
import sys

import ecospy


def main() -> None:
    task = json.load(sys.stdin)
    kinds = {"real": float, "bool": bool, "int": int}
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("m", task["fmu"])
        start = {f"m::{name}": kinds[kind](value) for name, kind, value in task["start"]}
        structure.add_parameter_set("start", start)
        with ecospy.EcosSimulation(structure=structure, step_size=task["step_s"]) as simulation:
            get = {
                "real": simulation.get_real,
                "bool": simulation.get_bool,
                "int": simulation.get_integer,
            }
            set_ = {
                "real": simulation.set_real,
                "bool": simulation.set_bool,
                "int": simulation.set_integer,
            }
            simulation.init(parameter_set="start")
            outputs = [(get[kind], f"m::{name}") for name, kind in task["outputs"]]
            rows = [[float(read(name)) for read, name in outputs]]
            for step in range(task["count"]):
                for at, name, kind, value in task["changes"]:
                    if at == step:
                        set_[kind](f"m::{name}", kinds[kind](value))
                simulation.step()
                rows.append([float(read(name)) for read, name in outputs])
            simulation.terminate()
    print(json.dumps(rows))


if __name__ == "__main__":
    main()
