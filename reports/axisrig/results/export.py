"""`axisrig export`: the time series of runs for other programs, as MF4 or CSV."""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from axisrig.bench.files import naming
from axisrig.results.loading import Results

FORMS = ("mf4", "csv")
TIME = "time_ns"
DIAGNOSIS_HEADS = {"zstd": "Distance Control:", "cmd_offset": "Dist-Ctrl Interface:"}
"""Heads of the diagnosis data, by the first name under each."""


def export(results: Results, runs: Sequence[str], into: Path, form: str) -> Iterator[Path]:
    """Write a file for each run into a folder and yield its path.

    runs: ids; empty for all that left time series. form: "mf4" (ASAM MDF 4.10, each signal with its
    unit) or "csv" (the units in a second row). Raises UserError for a run that cannot be written,
    ImportError without asammdf.
    """
    chosen = list(runs) or list(results.traces())
    tables = ((run, results.signals(run)) for run in chosen)
    write = _mf4 if form == "mf4" else _csv
    into.mkdir(parents=True, exist_ok=True)
    for run, table in tables:
        path = into / f"{run}.{form}"
        with naming(path):
            write(path, run, table)
        yield path


def export_diagnosis(results: Results, runs: Sequence[str], into: Path) -> Iterator[Path]:
    """Write the diagnosis data of 3D distance control of each run as a text, and yield its path.

    Names and order are those of FCT-M3 12.10: what releases the control (figure 55), then a dump
    for each change of it and one for the end of the run. Raises UserError for a run without 3D
    distance control.
    """
    into.mkdir(parents=True, exist_ok=True)
    for run in list(runs) or list(results.traces()):
        table = results.diagnosis(run)
        lines = ["DECODER : CONFIGURATION CHANNEL-NO.: 1"]
        lines += [f"  {name:<44}{value}" for name, value in table.attrs["decoder"].items()]
        for row in table.itertuples(index=False):
            for name, value in zip(table.columns, row, strict=True):
                if name == TIME:
                    lines.append(f"# SYNC {value / 1e6:g} ms")
                    continue
                if name in DIAGNOSIS_HEADS:
                    lines.append(DIAGNOSIS_HEADS[name])
                lines.append(f"  {name + ':':<24}{value}")
        path = into / f"{run}.diag_data.txt"
        with naming(path):
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        yield path


def _csv(path: Path, _: str, table: pd.DataFrame) -> None:
    units = table.attrs["units"]
    head = pd.DataFrame(
        [[units.get(column, "") for column in table.columns]], columns=table.columns
    )
    text = head.to_csv(index=False, lineterminator="\n")
    text += table.to_csv(index=False, header=False, lineterminator="\n")
    path.write_text(text, encoding="utf-8", newline="")


def _mf4(path: Path, run: str, table: pd.DataFrame) -> None:
    """Write one channel group; texts are left out, truth values are 0 and 1."""
    if sys.modules.get("asammdf", ...) is None:  # set aside when the command line started
        del sys.modules["asammdf"]
    from asammdf import MDF, Signal  # noqa: PLC0415 - an extra, and slow to import

    units = table.attrs["units"]
    times_s = table[TIME].to_numpy() / 1e9
    signals = []
    for column in table.columns:
        values: Any = table[column].to_numpy()
        if values.dtype == np.bool_:
            values = values.astype(np.uint8)
        if column != TIME and np.issubdtype(values.dtype, np.number):
            signals.append(Signal(values, times_s, unit=units.get(column, ""), name=column))
    with MDF(version="4.10") as mdf:
        mdf.start_time = pd.Timestamp(0, tz="UTC").to_pydatetime()  # the clock of a run begins at 0
        mdf.append(signals, comment=f"run {run}, rig {table.attrs.get('rig', '')}")
        mdf.save(path, overwrite=True)
