"""Of several outputs, inputs, units, versions and promises of an FMU each counts; no FMU is run."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts, variable
from tests.fmu_tools.test_examined_archives import MODEL
from tests.fmu_tools.test_examined_before_a_run import described
from tests.fmu_tools.test_fmu_release_folder import ALL, Calls, describe
from tests.fmu_tools.test_fmu_release_folder import calls as calls  # noqa: PLC0414 - a fixture
from tests.fmu_tools.test_options_of_a_build import PROBE, Cache
from tests.fmu_tools.test_options_of_a_build import cache as cache  # noqa: PLC0414 - a fixture
from tests.fmu_tools.test_shown_fmus import unknown
from tests.fmu_tools.test_shown_variables import own, shown
from tests.fmu_tools.test_trials_and_roles import Kinds, Library, role
from tests.fmu_tools.test_trials_and_roles import Slave as Instance
from tests.fmu_tools.trials import FakeTrial

from axisrig.bench.machine import fmu_files
from axisrig.bench.tools.fmu import examine, library, release, roles, show, stages, stepped_instance
from axisrig.bench.tools.fmu.binaries import Binary
from axisrig.bench.tools.fmu.stepped_instance import Reading, Trial, first_difference
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

Pack = Callable[..., Path]
FMU = Path("a.fmu")


# Outputs


class Numbers(Library):
    """An FMU with whole numbers as outputs, by reference."""

    def __init__(self, *numbers: int) -> None:
        super().__init__()
        self._numbers = numbers

    def __getattr__(self, name: str) -> Any:
        return lambda references: [self._numbers[references[0]]]


def read(patch: pytest.MonkeyPatch, *numbers: int) -> Reading:
    outputs = [SimpleNamespace(**vars(variable(f"n{at}", type="Int32", causality="output")),
                               valueReference=at) for at in range(len(numbers))]  # fmt: skip
    slave = Instance(outputs)
    slave.fmpy = Numbers(*numbers)
    patch.setattr(stepped_instance, "load_fmu", lambda _path, _name: slave)
    return Trial(FMU).read()


@pytest.mark.parametrize(
    ("one", "other"), [((1, 12), (11, 2)), ((0, 10), (1, 0)), ((-1, 1), (-11, 0)), ((1, 2), (2, 1))]
)
def test_outputs_that_look_alike_in_a_row_differ(
    one: tuple[int, int], other: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """1 and 12 are not 11 and 2."""
    found = [read(monkeypatch, *numbers) for numbers in (one, other)]
    assert found[0].bits != found[1].bits
    outputs: Any = [variable("a"), variable("b")]
    assert first_difference([found[0]], [found[1]], outputs) == (
        f"a at t = -1e-06 ms is {one[0]} and {other[0]}"
    )
    assert first_difference([found[0]], [read(monkeypatch, *one)], outputs) is None


@pytest.mark.parametrize("place", [0, 1, 2])
def test_any_output_that_differs_makes_two_runs_different(fake: Any, place: int) -> None:
    names = ("a", "b", "c")

    def read_three(trial: FakeTrial) -> Reading:
        odd = 0.5 * (trial.name == "two" and trial.count == 9)
        values = tuple((float(trial.count) + odd * (at == place),) for at in range(3))
        return Reading(trial.slave.time_ns, repr(values).encode(), values)

    fake(outputs=[SimpleNamespace(name=name) for name in names], read=read_three)
    assert texts(stages.determinism(FMU).findings, "FAIL") == [
        f"two runs differ: {names[place]} at t = 9 ms is 9.0 and 9.5"
    ]


def test_an_fmu_without_outputs_goes_through_its_calls(fake: Any) -> None:
    fake(outputs=(), read=lambda trial: Reading(trial.slave.time_ns, b"", ()))
    assert texts(stages.sequence(FMU).findings) == ["100 steps of 1 ms, terminated, freed"]


@pytest.mark.parametrize(
    ("kind", "moves"),
    [("Real", True), ("Float64", True), ("Float32", True), ("Int32", False), ("String", False),
     ("Enumeration", False)],
)  # fmt: skip
def test_inputs_of_every_kind_of_real_number_move(kind: str, moves: bool) -> None:
    found = list(stepped_instance._moved_inputs([variable("u", type=kind, start="1")], 2))
    assert [value for _, value in found] == ([pytest.approx(1.002)] if moves else [])


# Released files


@pytest.mark.parametrize(
    ("step", "step_ns", "count"),
    [("0.0001", 100_000, 3000), ("0.00005", 50_000, 6000), ("2e-3", 2 * MS, 150)],
)
def test_results_have_the_step_of_the_experiment_however_short(
    step: str, step_ns: int, count: int, calls: Calls, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    describe(monkeypatch, stopTime="0.3", stepSize=step)
    (tmp_path / "a.fmu").write_bytes(b"")
    place = release.release(
        tmp_path, "Lib.B", "3.0", ALL[:1], tmp_path / "a.fmu", runs_here=True
    ).parent
    assert [call[3:] for call in calls] == [(step_ns, count)]
    assert f"StepSize, {step_ns * 1e-9!r}\n" in (place / "B_ref.opt").read_text(encoding="utf-8")


def test_inputs_of_a_release_are_in_the_order_of_the_description(
    calls: Calls, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each column under its own name."""
    starts = {"z": "3", "a": "1", "off": "false", "m": "2", "on": "true"}
    inputs = [
        variable(name, start=start, type="Boolean" if name[0] == "o" else "Float64")
        for name, start in starts.items()
    ]
    description = SimpleNamespace(defaultExperiment=None, modelVariables=inputs)
    monkeypatch.setattr(release, "load_description", lambda _path: (description, "folder"))
    (tmp_path / "a.fmu").write_bytes(b"")
    place = release.release(
        tmp_path, "Lib.B", "3.0", ALL[:1], tmp_path / "a.fmu", runs_here=True
    ).parent
    head, first, _ = (place / "B_in.csv").read_text(encoding="utf-8").splitlines()
    assert head == '"time","z","a","off","m","on"'
    assert first == "0.0,3.0,1.0,0,2.0,1"
    assert len(calls) == 1


def test_each_version_is_released_as_what_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    built = [SimpleNamespace(model="Lib.A", fmi=fmi, path=Path(fmi)) for fmi in ("2.0", "3.0")]
    found: list[tuple[str, Path]] = []

    def put(
        _folder: Path, model: str, fmi: str, _names: Any, path: Path, *, runs_here: bool
    ) -> Path:
        assert runs_here
        found.append((fmi, path))
        return Path(model)

    monkeypatch.setattr(release, "build_models", lambda *_: iter(built))
    monkeypatch.setattr(release, "release", put)
    monkeypatch.setattr(release, "write_sums", lambda folder: folder)
    list(release.release_models(Path("out"), "A", ["2.0", "3.0"]))
    assert found == [("2.0", Path("2.0")), ("3.0", Path("3.0"))]


# What is built


def test_an_fmu_from_the_cache_is_of_the_version_that_is_asked_for(cache: Cache) -> None:
    cache.present = {f"{PROBE}-2.0-default"}
    found = [(one.model, one.fmi) for one in library.build_models("TouchProbe", ["2.0", "3.0"])]
    assert found == [(PROBE, "2.0"), (PROBE, "3.0")]
    assert [task[2] for task in cache.tasks] == ["3.0"]


def test_an_empty_word_is_no_model(cache: Cache) -> None:
    """All of them are meant by no word at all."""
    with pytest.raises(UserError, match="the library has no such model") as caught:
        list(library.build_models(""))
    assert caught.value.value == ""
    assert cache.looked == []


def test_a_model_of_ones_own_is_named_by_its_file_without_folder_and_ending(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "Ramp.mo"
    path.touch()
    monkeypatch.setattr(fmu_files, "own_fmu", lambda source: source.with_suffix(".fmu"))
    (found,) = library.build_models(str(path))
    assert found == ("Ramp", "3.0", tmp_path / "Ramp.fmu")


# What is examined and shown


def test_a_description_with_double_names_fails_once(pack: Pack) -> None:
    """Nothing behind it is looked at: neither its libraries nor its units."""
    twice = MODEL.replace(b'name="time"', b'name="y"')
    found = examine.examine(pack(description=twice))
    assert not found.can_run
    assert [one.area for one in found.findings if one.level == "FAIL"] == ["description"]
    assert {one.area for one in found.findings} == {"archive", "description"}


@pytest.mark.parametrize(
    ("error", "words"), [(ValueError("no root"), "no root"), (KeyError(), "KeyError")]
)
def test_a_description_that_cannot_be_read_says_why(
    error: Exception, words: str, pack: Pack, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(_folder: Path) -> Any:
        raise error

    monkeypatch.setattr(examine, "_read", breaks)
    found = examine.examine(pack(description=MODEL))
    assert texts(found.findings, "FAIL") == [f"it cannot be read: {words}"]
    assert found.findings[-1].remedy == "export it again"


def test_each_library_is_named_with_what_it_was_built_for(monkeypatch: pytest.MonkeyPatch) -> None:
    description: Any = SimpleNamespace(
        fmiVersion="3.0", coSimulation=SimpleNamespace(modelIdentifier="m"), modelName="Model"
    )
    monkeypatch.setattr(examine, "_folder_here", lambda _: "x86_64-linux")
    there = [Binary("x86_64-linux", "m.so", "linux", ("x86_64",)),
             Binary("aarch64-darwin", "m.dylib", "darwin", ("x86_64", "aarch64"))]  # fmt: skip
    monkeypatch.setattr(examine, "find_binaries", lambda *_: there)
    assert texts(examine._binaries(description, FMU)) == [
        "x86_64-linux (x86_64, linux), aarch64-darwin (universal: x86_64 + aarch64, darwin)"
    ]
    monkeypatch.setattr(examine, "find_binaries", lambda *_: [])
    assert texts(examine._binaries(description, FMU)) == [
        "binaries/x86_64-linux holds no library m", "none",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("given", "has_outputs"),
    [
        ({}, True),
        ({"clocks": ["c"]}, False),
        ({"type": "Clock"}, False),
        ({"causality": "local"}, False),
    ],
)
def test_outputs_that_never_have_a_value_are_none(given: dict[str, Any], has_outputs: bool) -> None:
    found = texts(examine._variables(described(variable("y", **{"causality": "output", **given}))))
    assert ("it has no outputs" in found) is not has_outputs


def test_every_unit_that_is_not_known_is_named_in_the_order_of_the_alphabet() -> None:
    made = described(*(variable(f"v{unit}", unit=unit, causality="output")
                       for unit in ("parsec", "mm", "ell", "parsec", "fathom")))  # fmt: skip
    assert texts(examine._units(made, made.modelVariables)) == [
        "units not known: ell, fathom, parsec"
    ]
    many = described(*(variable(f"v{n}", unit=f"u{n}x", causality="input") for n in range(9)))
    assert texts(examine._units(many, many.modelVariables)) == [
        "units not known: u0x, u1x, u2x, u3x, u4x, u5x and 3 more"
    ]


@pytest.mark.parametrize("hidden", [0, 1, 2])
def test_a_single_hidden_variable_is_mentioned_too(
    hidden: int, capsys: pytest.CaptureFixture[str]
) -> None:
    local = [own(f"l{number}", causality="local") for number in range(hidden)]
    show.show_fmu(shown(own("y", causality="output"), *local), is_all=False)
    text = capsys.readouterr().out
    assert ("are not shown" in text) is (hidden > 0)
    if hidden:
        assert f"{hidden} variables, local ones and time, are not shown" in text


@pytest.mark.parametrize(
    ("once", "tool"), [(True, False), (False, True), (True, True), (False, False)]
)
def test_what_an_fmu_needs_is_shown_each_by_itself(once: bool, tool: bool) -> None:
    can: Any = SimpleNamespace(
        can_vary_step=False, can_save_state=True, can_serialize_state=False, can_return_early=True,
        fixed_step_s=None, once_per_process=once, needs_tool=tool,
    )  # fmt: skip
    assert list(show._capabilities(can)) == [
        "take steps of any length: no", "save and restore its state: yes",
        "write its state as bytes: no", "return early from a step: yes",
        *["exist once in a process only"] * once, *["run only with the tool that made it"] * tool,
    ]  # fmt: skip


@pytest.mark.parametrize("given", ["startTime", "stopTime", "stepSize"])
def test_of_an_experiment_only_what_is_given_is_shown(given: str) -> None:
    """0 is given."""
    words = {"startTime": "start", "stopTime": "stop", "stepSize": "step"}
    for value in ("0", "0.5"):
        experiment = SimpleNamespace(**{**dict.fromkeys(words), given: value})
        found = list(show._experiment(SimpleNamespace(defaultExperiment=experiment)))  # type: ignore[arg-type]
        assert found == [("experiment", f"{words[given]} {value} s")]


def test_the_structure_counts_each_kind_by_itself() -> None:
    made: Any = SimpleNamespace(
        outputs=[unknown("y"), unknown("z", given=False)], derivatives=[1] * 3, eventIndicators=[],
        numberOfEventIndicators=4, initialUnknowns=[1] * 5,
    )  # fmt: skip
    assert list(show._structure(made)) == [
        "structure", "  y: depends on nothing", "  z: dependencies are not given",
        "  3 continuous states, 4 event indicators, 5 initial unknowns",
    ]  # fmt: skip


# Roles


def offered(patch: pytest.MonkeyPatch, asked: Any, variables: list[Any], takes: Any) -> list[str]:
    """Findings of an FMU with these variables; takes: whether a role is bound to a source."""
    kinds = Kinds(patch)
    patch.setattr(roles, "KINDS", ("axis",))
    kinds.roles["axis"] = asked

    def bind(_slave: object, name: str, _role: Any, source: Any) -> None:
        if not takes(name, source):
            raise UserError("no")

    patch.setattr(roles, "bind", bind)
    slave: Any = SimpleNamespace(description=SimpleNamespace(modelVariables=variables))
    return texts(roles.role_findings(slave))


HEAD = "kind axis with a map (docs/rigs.md): "
NOTHING = ["nothing in it can be an axis or a sensor of a rig"]


@pytest.mark.parametrize("group", ["plain", "position"])
def test_a_role_that_is_required_is_asked_for_in_whatever_group(
    group: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In `roles.csv` each required role is a group of its own."""
    asked = {"position": role("required", group), "demand": role("demand", causality="input")}
    outputs = [variable("here", causality="output"), variable("there")]
    good = offered(monkeypatch, asked, outputs, lambda name, _: name == "demand")
    assert good == NOTHING
    both = offered(monkeypatch, asked, outputs, lambda *_: True)
    assert both == [f"{HEAD}position = here; demand = there"]  # the input for what is written


@pytest.mark.parametrize(
    ("how", "words"),
    [("plain", "a"), ("lead", "a (lead_mm)"), ("unit", "a (unit)"), ("unit lead", "a (lead_mm)"),
     ("lead plain unit", "a")],
)  # fmt: skip
def test_what_the_map_has_to_say_is_the_plainest_way_that_fits(
    how: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The unit is that of the role."""

    def takes(_name: str, source: Any) -> bool:
        if source.lead_m is not None:
            return "lead" in how
        if source.unit is not None:
            assert source.unit == "m/s"
            return "unit" in how
        return "plain" in how

    asked = {"velocity": role(unit="m/s")}
    found = offered(monkeypatch, asked, [variable("a", causality="output")], takes)
    assert found == [f"{HEAD}velocity = {words}"]


def test_a_level_is_no_number_whatever_the_map_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """And a number is a level by a threshold."""
    level = variable("on", causality="output", type="Boolean")
    number = variable("x", causality="output")
    assert offered(monkeypatch, {"position": role()}, [level], lambda *_: True) == NOTHING
    asked = {"signal": role(type="flag")}
    assert offered(monkeypatch, asked, [level], lambda *_: True) == [f"{HEAD}signal = on"]
    assert offered(monkeypatch, asked, [number], lambda *_: True) == [
        f"{HEAD}signal = x (threshold)"
    ]
    assert offered(monkeypatch, asked, [number, level], lambda *_: True) == [f"{HEAD}signal = on"]
