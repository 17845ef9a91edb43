"""Where `axisrig fmu release` puts an FMU, and the reference results that it steps for it."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import variable

from axisrig.bench.tools.fmu import release
from axisrig.bench.tools.fmu.release import Change
from axisrig.fmus import PLATFORMS
from axisrig.kernel.time.clock import MS

Calls = list[tuple[Any, ...]]


class Slave:
    """An FMU whose outputs are its time and the last value of its input."""

    VARIABLES = (
        variable("y", causality="output"), variable("n", causality="output", type="Int32"),
        variable("field", causality="output", dimensions=[2]),
        variable("z", causality="output"), variable("u"),
    )  # fmt: skip

    def __init__(self, fails_ns: int | None = None) -> None:
        self.time_ns, self.u, self.is_closed, self._fails_ns = -1, 0.0, False, fails_ns
        self.given: list[tuple[int, str, float]] = []

    def names(self, causality: str) -> list[str]:
        return [each.name for each in self.VARIABLES if each.causality == causality]

    def variable(self, name: str) -> Any:
        return next(each for each in self.VARIABLES if each.name == name)

    def set_start(self, name: str, value: float) -> None:
        self.given.append((self.time_ns, name, value))
        self.u = value

    def initialize(self, time_ns: int) -> None:
        self.time_ns = time_ns

    def step_to(self, time_ns: int) -> None:
        if time_ns == self._fails_ns:
            raise RuntimeError("it ended")
        self.time_ns = time_ns

    def close(self) -> None:
        self.is_closed = True


class Exchange:
    def __init__(self, slave: Slave, names: list[str]) -> None:
        self._slave, self._names, self.values = slave, names, [0.0]

    def read(self) -> None:
        found = {"y": self._slave.time_ns / MS, "z": self._slave.u, "n": 7}
        self.values = [found[name] for name in self._names]


@pytest.fixture
def instance(monkeypatch: pytest.MonkeyPatch) -> Callable[[Slave], None]:
    monkeypatch.setattr(release, "Exchange", Exchange)
    return lambda slave: monkeypatch.setattr(release, "load_fmu", lambda _path, _name: slave)


def test_results_are_those_at_each_point_with_outputs_by_type(
    instance: Callable[[Slave], None],
) -> None:
    """Arrays are left out. A change acts from the first point that is not before it."""
    slave = Slave()
    instance(slave)
    course = [Change(0.0, "u", 1.0), Change(0.001, "u", 2.0), Change(0.0025, "u", 3.0)]
    names, rows = release.walk(Path("a.fmu"), course, MS, 4)
    assert names == ["time", "y", "z", "n"]
    assert rows == [
        pytest.approx(row)
        for row in ([0.0, 0, 1, 7], [1e-3, 1, 1, 7], [2e-3, 2, 2, 7], [3e-3, 3, 2, 7],
                    [4e-3, 4, 3, 7])
    ]  # fmt: skip
    assert slave.given == [(-1, "u", 1.0), (MS, "u", 2.0), (3 * MS, "u", 3.0)]
    assert slave.is_closed


def test_an_instance_is_freed_where_a_step_fails(instance: Callable[[Slave], None]) -> None:
    slave = Slave(fails_ns=2 * MS)
    instance(slave)
    with pytest.raises(RuntimeError):
        release.walk(Path("a.fmu"), [], MS, 4)
    assert slave.is_closed


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Calls:
    """What is stepped and built, in place of both."""
    found: Calls = []

    def walk(*args: Any) -> tuple[list[str], list[list[float]]]:
        found.append(("walk", *args))
        return ["time", "y"], [[0.0, 1.5]]

    def built(model: str, *, fmi: str) -> Path:
        found.append(("build", model, fmi))
        return Path("here.fmu")

    monkeypatch.setattr(release, "walk", walk)
    monkeypatch.setattr(release, "ensure_built", built)
    monkeypatch.setattr(release.importlib.metadata, "version", lambda _name: "9.8")
    monkeypatch.setattr(release, "courses", lambda: {"Lib.A": [Change(0.0, "u", 2.0)]})
    return found


def describe(monkeypatch: pytest.MonkeyPatch, **experiment: str | None) -> None:
    names = ("startTime", "stopTime", "stepSize", "tolerance")
    own = SimpleNamespace(**dict.fromkeys(names) | experiment) if experiment else None
    description = SimpleNamespace(
        defaultExperiment=own,
        modelVariables=[variable("u", start="0.5"), variable("k", causality="parameter", start="1"),
                        variable("y", causality="output")],
    )  # fmt: skip
    monkeypatch.setattr(release, "load_description", lambda _path: (description, "folder"))


ALL = [platform.name for platform in PLATFORMS.values() if platform.in_all]


@pytest.mark.parametrize("runs_here", [True, False])
@pytest.mark.parametrize(
    ("platforms", "folder"),
    [(ALL, "all"), (ALL[::-1], "all"), (ALL[:1], ALL[0]), (ALL[1::-1], f"{ALL[1]}+{ALL[0]}")],
)
def test_an_fmu_is_copied_to_its_folder_and_stepped_where_it_runs(
    platforms: list[str], folder: str, runs_here: bool, calls: Calls, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Else the same model is built for this platform and stepped."""
    describe(monkeypatch)
    source = tmp_path / "source.fmu"
    source.write_bytes(b"an fmu")
    path = release.release(tmp_path, "Lib.A", "2.0", platforms, source, runs_here=runs_here)
    assert path == tmp_path / "2.0" / "cs" / folder / "axisrig" / "9.8" / "A" / "A.fmu"
    assert path.read_bytes() == b"an fmu"
    stepped = path if runs_here else Path("here.fmu")
    walked = ("walk", stepped, [Change(0.0, "u", 2.0)], MS, 1000)
    assert calls == [*([] if runs_here else [("build", "Lib.A", "2.0")]), walked]
    names = ["A.fmu", "A_in.csv", "A_ref.csv", "A_ref.opt"]
    assert sorted(each.name for each in path.parent.iterdir()) == names


@pytest.mark.parametrize(
    ("experiment", "count", "step_ns", "options"),
    [
        ({}, 1000, MS, (0.0, 1.0, 0.001, 1e-9)),
        ({"startTime": "0.5", "stopTime": "2", "stepSize": "0.01", "tolerance": "1e-6"},
         150, 10 * MS, (0.5, 2.0, 0.01, 1e-6)),
        ({"stopTime": "0.25"}, 250, MS, (0.0, 0.25, 0.001, 1e-9)),
        ({"stepSize": "0.4"}, 2, 400 * MS, (0.0, 1.0, 0.4, 1e-9)),
    ],
)  # fmt: skip
def test_results_inputs_and_options_follow_the_experiment(
    experiment: dict[str, str], count: int, step_ns: int, options: tuple[float, ...],
    calls: Calls, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """What a description leaves out has its default. Parameters are no inputs."""
    describe(monkeypatch, **experiment)
    (tmp_path / "a.fmu").write_bytes(b"")
    place = release.release(
        tmp_path, "Lib.B", "3.0", ALL[:1], tmp_path / "a.fmu", runs_here=True
    ).parent  # fmt: skip
    ((_, _, course, walked_ns, steps),) = calls
    assert (list(course), walked_ns, steps) == ([], step_ns, count)
    start, stop, step, tolerance = options
    assert (place / "B_ref.opt").read_text(encoding="utf-8") == (
        f"StartTime, {start}\nStopTime, {stop}\nStepSize, {step}\nRelTol, {tolerance}\n"
    )
    assert (place / "B_ref.csv").read_text(encoding="utf-8") == '"time","y"\n0.0,1.5\n'
    assert (place / "B_in.csv").read_text(encoding="utf-8") == (
        f'"time","u"\n{start},0.5\n{stop},0.5\n'
    )


@pytest.mark.parametrize(
    ("words", "names", "runs_here"),
    [((), ["here"], True), (("here",), ["here"], True), (("there",), ["there"], False),
     (("there", "here"), ["there", "here"], True)],
)  # fmt: skip
def test_models_are_released_in_turn_and_sums_come_last(
    words: tuple[str, ...], names: list[str], runs_here: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    built = [SimpleNamespace(model=f"Lib.{n}", fmi="3.0", path=Path(n)) for n in ("a", "b")]
    calls: Calls = []

    def put(*args: Any, runs_here: bool) -> Path:
        calls.append((*args, runs_here))
        return Path(f"{args[1]}.fmu")

    monkeypatch.setattr(release, "this_platform", lambda: SimpleNamespace(name="here"))
    monkeypatch.setattr(release, "build_models", lambda *args: calls.append(args) or iter(built))
    monkeypatch.setattr(release, "release", put)
    monkeypatch.setattr(release, "write_sums", lambda folder: folder / "SHA256SUMS")
    folder = Path("out")
    found = list(release.release_models(folder, None, ["3.0"], words, "zig"))
    assert found == [Path("Lib.a.fmu"), Path("Lib.b.fmu"), folder / "SHA256SUMS"]
    assert calls == [
        (None, ["3.0"], words, "zig"),
        *((folder, each.model, "3.0", names, each.path, runs_here) for each in built),
    ]


def test_numbers_of_an_fmu_are_written_as_numbers_whatever_their_type(
    instance: Callable[[Slave], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A truth value is 0.0 or 1.0, a whole number has a point: all importers read that."""

    class Typed(Exchange):
        def read(self) -> None:
            found: dict[str, Any] = {"y": True, "z": 0.5, "n": 7}
            self.values = [found[name] for name in self._names]

    instance(Slave())
    monkeypatch.setattr(release, "Exchange", Typed)
    names, rows = release.walk(Path("a.fmu"), [], MS, 1)
    release._write_csv(tmp_path / "a.csv", names, rows)
    assert (tmp_path / "a.csv").read_text(encoding="utf-8") == (
        '"time","y","z","n"\n0.0,1.0,0.5,7.0\n0.001,1.0,0.5,7.0\n'
    )


@pytest.mark.parametrize(
    ("kind", "given", "written"),
    [
        ("Real", 0.5, "0.5"), ("Float64", 0.5, "0.5"), ("Real", 2.0, "2.0"), ("Int32", 3.0, "3"),
        ("Integer", 3.0, "3"), ("UInt8", 1.0, "1"), ("Boolean", 1.0, "1"), ("Boolean", 0.0, "0"),
    ],
)  # fmt: skip
def test_values_of_an_input_are_those_of_its_type(
    kind: str, given: float, written: str, tmp_path: Path
) -> None:
    """Of FMI 2.0 and FMI 3.0; from the start value to what a change makes of it."""
    start = "true" if kind == "Boolean" else "1"
    inputs = [variable("u", type=kind, start=start)]
    first = "1.0" if kind in ("Real", "Float64") else "1"
    rows = release._input_rows(inputs, [Change(0.5, "u", given)], 0.0, 1.0)
    release._write_csv(tmp_path / "a.csv", ["time", "u"], rows)
    assert (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()[1:] == [
        f"0.0,{first}", f"0.5,{first}", f"0.5,{written}", f"1.0,{written}",
    ]  # fmt: skip


OTHERS = [platform.name for platform in PLATFORMS.values() if not platform.in_all]


@pytest.mark.parametrize(
    ("platforms", "folder"),
    [
        ([*ALL, *OTHERS], "+".join([*ALL, *OTHERS])),
        (OTHERS, OTHERS[0]),
        (ALL[1:], "+".join(ALL[1:])),
    ],
)
def test_a_folder_of_all_platforms_has_these_and_no_others(
    platforms: list[str], folder: str, calls: Calls, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """`--platform all` is what it says; one more platform is named as any other choice."""
    describe(monkeypatch)
    (tmp_path / "a.fmu").write_bytes(b"")
    path = release.release(tmp_path, "Lib.A", "3.0", platforms, tmp_path / "a.fmu", runs_here=True)
    assert path.relative_to(tmp_path).parts[:3] == ("3.0", "cs", folder)
    assert len(calls) == 1


@pytest.mark.parametrize(
    ("stop", "step", "count"),
    [("0.3", "0.1", 3), ("0.7", "0.1", 7), ("0.6", "0.2", 3), ("1.2", "0.4", 3),
     ("0.35", "0.1", 3), ("0.05", "0.1", 0)],
)  # fmt: skip
def test_results_have_as_many_steps_as_there_is_time_for(
    stop: str, step: str, count: int, calls: Calls, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """0.3 / 0.1 is 2.9999999999999996 as a double; time is whole nanoseconds."""
    describe(monkeypatch, stopTime=stop, stepSize=step)
    (tmp_path / "a.fmu").write_bytes(b"")
    release.release(tmp_path, "Lib.B", "3.0", ALL[:1], tmp_path / "a.fmu", runs_here=True)
    ((*_, walked),) = calls
    assert walked == count
