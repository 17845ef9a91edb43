"""Makes the stored references of the validation models, without anything of the exporter.

    python tests/fmus/validation/make_references.py [--into FOLDER] [MODEL ...]

Each model of signals.csv has a function of its name in lower case (FixedStop: fixed_stop) in one
of the modules beside this file. It gets the instants in seconds, an array of shape (n,), and gives
the signals by name, arrays of the same shape, in the units of signals.csv. A change of 1 % of any
parameter must show in a signal, but for those that not_physical.csv lists with the reason.
"""

import argparse
import csv
import importlib
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
# Each holds the references of one part of the library.
MODULES = (
    *("mechanics", "drives", "axes", "gantry", "tool_stop", "sampled", "controls"),
    *("edges", "probe", "distance", "tilted", "terminal", "workpieces"),
)

Reference = Callable[[NDArray[np.float64]], Mapping[str, NDArray[np.float64]]]


def read_signals() -> dict[str, list[dict[str, str]]]:
    """The rows of signals.csv by model."""
    with (HERE / "signals.csv").open(encoding="utf-8", newline="") as file:
        models: dict[str, list[dict[str, str]]] = {}
        for row in csv.DictReader(file):
            models.setdefault(row["model"], []).append(row)
    return models


def instants(rows: Sequence[Mapping[str, str]]) -> NDArray[np.float64]:
    """The instants of a model in seconds, from 0 to its stop time.

    Raises ValueError when the rows of a model differ in stop time or interval.
    """
    spans = {(row["stop_time_s"], row["interval_s"]) for row in rows}
    if len(spans) != 1:
        raise ValueError(f"{rows[0]['model']}: one stop_time_s and interval_s, not {spans}")
    ((stop, interval),) = spans
    count = round(float(stop) / float(interval)) + 1
    return np.arange(count, dtype=np.float64) * np.float64(interval)


def find_reference(model: str) -> Reference:
    """The function that makes the reference of a model.

    Raises LookupError when no module has it.
    """
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", model).lower()
    for module in MODULES:
        if (HERE / f"{module}.py").is_file():
            found: Reference | None = getattr(importlib.import_module(module), name, None)
            if found is not None:
                return found
    raise LookupError(f"no module of {', '.join(MODULES)} has a function {name}")


def write_reference(model: str, rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """Write the reference of one model; numbers as the shortest text that reads back the same.

    Raises ValueError when the function gives other signals than signals.csv names.
    """
    time_s = instants(rows)
    signals = find_reference(model)(time_s)
    names = [row["signal"] for row in rows]
    if set(names) != set(signals):
        raise ValueError(f"{model}: signals.csv has {names}, the reference {sorted(signals)}")
    columns = [time_s, *(np.asarray(signals[name], dtype=float) for name in names)]
    with (folder / f"{model}.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time_s", *names])
        writer.writerows(
            [repr(float(value)) for value in row] for row in zip(*columns, strict=True)
        )


def main() -> None:
    """Make the references of the named models, or of all."""
    parser = argparse.ArgumentParser(description="Make the references of the validation models.")
    parser.add_argument("--into", type=Path, default=HERE / "references", help="folder")
    parser.add_argument("models", nargs="*", help="names as in signals.csv; default: all")
    arguments = parser.parse_args()
    models = read_signals()
    for model in arguments.models or models:
        if model not in models:
            parser.error(f"signals.csv has no model {model}")
        write_reference(model, models[model], arguments.into)


if __name__ == "__main__":
    main()
