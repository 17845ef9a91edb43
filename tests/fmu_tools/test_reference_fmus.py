"""The Reference FMUs of the FMI project, stepped by this master and by fmpy's `simulate_fmu`.

They are built outside this project and never part of it. The variable AXISRIG_REFERENCE_FMUS names
a folder with `fmi2/*.fmu` and `fmi3/*.fmu`; without it nothing here runs. Run as a script with that
folder as its argument, it prints the table of docs/reference-fmus.md.
"""

import io
import os
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

from axisrig.bench.tools.fmu.check import check_fmu
from axisrig.kernel.cosim.fmi.fmu import EndedError, Exchange, FmuSlave, load_description, load_fmu
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

LISTS = Path(__file__).parents[2] / "testplans" / "rigs" / "lists"
FOLDER = os.environ.get("AXISRIG_REFERENCE_FMUS", "")
MODELS = ("BouncingBall", "Dahlquist", "Feedthrough", "Resource", "Stair", "VanDerPol")
NAMES = [
    *(f"fmi2/{name}" for name in MODELS),
    *(f"fmi3/{name}" for name in (*MODELS, "StateSpace")),
]
# The FMU's own step, half of it, three of it; and two of the bench
FACTORS = (1.0, 0.5, 3.0)
BENCH_NS: tuple[TimeNs, ...] = (1_000_000, 250_000)
STEPS, OWN_STEPS_MIN = 300, 10
_RECORDED = ("Real", "Integer", "Boolean", "Enumeration", "Float32", "Float64", "Int64", "UInt64")
_RECORDED += ("Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32")

needs_folder = pytest.mark.skipif(
    not FOLDER, reason="AXISRIG_REFERENCE_FMUS names no folder with fmi2/*.fmu and fmi3/*.fmu"
)


@dataclass(frozen=True)
class Compared:
    """A run by both masters.

    values: outputs that were compared. changing: how many of them were not what they were one
    sample before. worst: largest difference; is_equal: equal bit for bit, and as many samples.
    """

    samples: int
    values: int
    changing: int
    is_equal: bool
    worst: float


def _own_step_ns(description: Any) -> TimeNs:
    answer = (
        description.defaultExperiment.stepSize or description.coSimulation.fixedInternalStepSize
    )
    return round(float(answer or 1e-3) * 1e9)


def _plans(description: Any) -> list[tuple[TimeNs, int]]:
    """Steps to run with (whole nanoseconds), and how many of each."""
    own_ns = _own_step_ns(description)
    steps = dict.fromkeys([*(round(own_ns * factor) for factor in FACTORS), *BENCH_NS])
    return [(ns, max(STEPS, OWN_STEPS_MIN * own_ns // ns)) for ns in steps]


def _recorded(description: Any, causality: str) -> list[Any]:
    """Variables that fmpy records: numbers and levels."""
    return [
        v
        for v in description.modelVariables
        if v.causality == causality and v.type in _RECORDED and not v.clocks
    ]


def _signals(inputs: Sequence[Any], times_s: Sequence[float]) -> np.ndarray | None:
    """Inputs that move: waves, counters and levels, one value for each communication point."""
    if not inputs:
        return None
    columns: list[Any] = []
    count = np.arange(len(times_s))
    for number, variable in enumerate(inputs):
        kind: Any = np.float64
        values: Any = np.sin(0.1 * count * (number + 1)) + number
        if variable.type == "Boolean":
            kind, values = np.bool_, (count // (3 + number)) % 2 == 1
        elif variable.type in ("Enumeration",):
            kind, values = np.int64, 1 + count % 2
        elif "Int" in variable.type:
            kind, values = np.int64, (count + number) % 50
        shape = tuple(variable.shape or ())
        if shape:
            values = np.broadcast_to(values[:, None], (len(count), *shape))
        columns.append((variable.name, kind, shape, values))
    dtype = [("time", np.float64), *((n, k, s) if s else (n, k) for n, k, s, _ in columns)]
    signals = np.zeros(len(times_s), dtype=dtype)
    signals["time"] = times_s
    for name, _, _, values in columns:
        signals[name] = values
    return signals


def by_fmpy(path: Path, step_ns: TimeNs, count: int, signals: Any, outputs: Sequence[str]) -> Any:
    """The outputs at every communication point, by fmpy's own master."""
    step_s = step_ns / 1e9
    with redirect_stdout(io.StringIO()):  # it warns of inputs without a signal
        return fmpy.simulate_fmu(
            str(path),
            start_time=0.0,
            stop_time=count * step_s,
            output_interval=step_s,
            fmi_type="CoSimulation",
            input=signals,
            output=list(outputs),
            set_stop_time=False,
        )


def by_this_master(
    path: Path, step_ns: TimeNs, count: int, signals: Any, outputs: Sequence[str]
) -> dict[str, np.ndarray]:
    """The outputs at every communication point, by the slave that rigs use."""
    slave = load_fmu(path, "reference")
    try:
        inputs = () if signals is None else signals.dtype.names[1:]
        writers = {name: Exchange(slave, [name]) for name in inputs}
        readers = {name: Exchange(slave, [name]) for name in outputs}
        rows = list(_run(slave, step_ns, count, (signals, writers), readers))
    finally:
        slave.close()
    return {name: np.array([row[name] for row in rows]) for name in outputs}


def _run(
    slave: FmuSlave,
    step_ns: TimeNs,
    count: int,
    inputs: tuple[Any, Mapping[str, Exchange]],
    readers: Mapping[str, Exchange],
) -> Iterator[dict[str, list[Any]]]:
    """A sample after the initialisation and after each step, also one that ends the simulation."""
    _write(inputs, 0)
    slave.initialize(0)
    yield _read(readers)
    for number in range(1, count + 1):
        _write(inputs, number - 1)
        try:
            slave.step_to(number * step_ns)
        except EndedError:
            yield _read(readers)
            return
        yield _read(readers)


def _read(readers: Mapping[str, Exchange]) -> dict[str, list[Any]]:
    for reader in readers.values():
        reader.read()
    return {name: reader.values[:] for name, reader in readers.items()}


def _write(inputs: tuple[Any, Mapping[str, Exchange]], number: int) -> None:
    signals, writers = inputs
    for name, writer in writers.items():
        writer.values[:] = np.ravel(signals[name][number]).tolist()
        writer.write()


def compare(path: Path, step_ns: TimeNs, count: int) -> Compared:
    """Run both masters over the same steps with the same inputs."""
    description, _ = load_description(path)
    inputs, outputs = (_recorded(description, kind) for kind in ("input", "output"))
    names = [v.name for v in outputs]
    signals = _signals(inputs, [number * (step_ns / 1e9) for number in range(count + 1)])
    theirs = by_fmpy(path, step_ns, count, signals, names)
    ours = by_this_master(path, step_ns, count, signals, names)
    samples = min(len(theirs), len(ours[names[0]]))
    is_equal, worst, values, changing = len(theirs) == len(ours[names[0]]), 0.0, 0, 0
    for name in names:
        a = np.asarray(theirs[name][:samples]).reshape(samples, -1)
        b = ours[name][:samples].reshape(samples, -1).astype(a.dtype)
        is_equal = is_equal and a.tobytes() == b.tobytes()
        worst = max(worst, float(np.max(np.abs(a.astype(float) - b.astype(float)))))
        values += a.size
        changing += int(np.count_nonzero(a[1:] != a[:-1]))
    return Compared(samples, values, changing, is_equal, worst)


@needs_folder
@pytest.mark.parametrize("name", NAMES)
def test_both_masters_give_the_same_bits(name: str) -> None:
    path = Path(FOLDER) / f"{name}.fmu"
    description, _ = load_description(path)
    for step_ns, count in _plans(description):
        result = compare(path, step_ns, count)
        assert result.samples > 10
        assert result.is_equal, (step_ns, result)
        assert result.changing > 0 or "Resource" in name  # which gives out what its file holds


@needs_folder
@pytest.mark.parametrize("name", NAMES)
def test_check_finds_no_fault(name: str) -> None:
    checked = check_fmu(Path(FOLDER) / f"{name}.fmu")
    assert checked.is_good, checked.findings


@needs_folder
def test_clocks_without_co_simulation_are_refused() -> None:
    with pytest.raises(UserError, match="no co-simulation interface"):
        load_fmu(Path(FOLDER) / "fmi3/Clocks.fmu", "clocks")


RIG = """\
title = "Feedthrough as an axis without any dynamics, under the touch probe of the library"

[channel]
list = "lists/channel.lst"

[segment.can1]
bitrate = 1_000_000

[drive.servo]
encoder_increments = 1_048_576
lead_mm = 10.0

[axis.Z]
list = "lists/axis-z.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "z"
probe_1 = "probe"

[plant.z]
fmu = "{fmu}"
kind = "axis"
[plant.z.map]
demand = {{ variable = "Float64_continuous_input", unit = "m" }}
position = {{ variable = "Float64_continuous_output", unit = "m" }}

[plant.probe]
fmu = "AxisRig.Sensors.TouchProbe"
start = {{ surface_mm = -5 }}
wire = {{ z = "z" }}
"""
PROGRAM = """\
N10 G90 G1 Z1 F3000
N20 G100 Z-9 F60
N30 #MSG["%f", V.A.MESS.Z]
N40 M30
"""


@needs_folder
@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_feedthrough_is_an_axis_of_a_rig(
    version: str, tmp_path: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    """The contact comes with a step of the demand, which is held for 62.5 us: 62.5 nm at 1 mm/s.

    The drive latches 4 us later and counts in 10 mm / 2^20 = 9.5 nm.
    """
    shutil.copytree(LISTS, tmp_path / "lists")
    fmu = Path(FOLDER) / version / "Feedthrough.fmu"
    (tmp_path / "rig.toml").write_text(RIG.format(fmu=fmu.as_posix()), encoding="utf-8")
    (tmp_path / "part.nc").write_text(PROGRAM, encoding="utf-8")
    code, out, err = axisrig("nc", "part.nc", "--rig", "rig.toml")
    assert code == 0, err
    assert "plant z: no velocity: numeric derivative of position" in err
    behind_nm = (-5.0 - float(out)) * 1e6
    assert -9.5 <= behind_nm <= 62.5 + 4.0 + 9.5


def table(folder: Path) -> Iterator[str]:
    """The rows of docs/reference-fmus.md."""
    yield "| FMU | step | samples | values | changing | difference |"
    yield "|---|---|---|---|---|---|"
    for name in NAMES:
        description, _ = load_description(folder / f"{name}.fmu")
        for number, (step_ns, count) in enumerate(_plans(description)):
            result = compare(folder / f"{name}.fmu", step_ns, count)
            found = "none" if result.is_equal else f"{result.worst:.3g}"
            yield (
                f"| {name if number == 0 else ''} | {step_ns / 1e6:g} ms | {result.samples} "
                f"| {result.values} | {result.changing} | {found} |"
            )


if __name__ == "__main__":
    print(f"fmpy {fmpy.__version__}, numpy {np.__version__}, Python {sys.version.split()[0]}")
    print("\n".join(table(Path(sys.argv[1]))))
