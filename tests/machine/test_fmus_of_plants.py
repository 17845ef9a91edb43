"""Which FMU a plant gets, what is wrong with its name or its model, and remarks on it."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.made_rigs import RIGS, settings_of

from axisrig.bench.machine import fmu_files
from axisrig.bench.machine.fmu_files import library_fmu, own_fmu, plant_path, problems, remarks
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.fmus import MODELS, BuildError
from axisrig.kernel.errors import UserError

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

PROBE = RIGS / "probe-z.toml"
LINE = 1 + PROBE.read_text(encoding="utf-8").splitlines().index('fmu = "AxisRig.Drives.ServoAxis"')


def path_of(fmu: str) -> Path:
    return plant_path(settings_of(PROBE), "z", PlantTable(fmu=fmu))


def refused(fmu: str) -> UserError:
    with pytest.raises(UserError) as caught:
        path_of(fmu)
    assert (caught.value.file, caught.value.value) == (str(PROBE), fmu)
    assert caught.value.line == LINE
    return caught.value


def test_a_file_is_taken_as_it_is_named() -> None:
    """A file that is missing is refused only when it is loaded."""
    assert path_of("/nowhere/own.fmu") == Path("/nowhere/own.fmu")


def test_a_model_that_is_missing_has_those_near_it(tmp_path: Path) -> None:
    (tmp_path / "Slider.mo").write_text("", encoding="utf-8")
    error = refused(str(tmp_path / "Slidr.mo"))
    assert error.message == "there is no such model"
    assert error.hint == "near it: Slider.mo"
    assert refused(str(tmp_path) + "/x/y.mo").hint == f"looked in {tmp_path}/x"


@pytest.mark.parametrize(
    ("fmu", "is_near"), [("AxisRig.Drives.ServoAxes", True), ("zzzz", False), ("own.fmx", False)]
)
def test_a_name_that_is_no_model_of_the_library_has_those_near_it_or_all(
    fmu: str, is_near: bool
) -> None:
    error = refused(fmu)
    assert error.message == "neither a model of the library nor a path that ends in .fmu or .mo"
    assert error.allowed is not None
    if is_near:
        assert error.allowed.startswith("AxisRig.Drives.ServoAxis,")
        assert "did you mean" in str(error)
    else:
        assert error.allowed == ", ".join(MODELS)


def test_a_model_of_the_user_is_built_where_it_is(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    source = tmp_path / "Own.mo"
    source.write_text("", encoding="utf-8")
    asked: list[Path] = []
    monkeypatch.setattr(
        fmu_files, "ensure_own_built", lambda path: asked.append(path) or tmp_path / "Own.fmu"
    )
    assert path_of(str(source)) == tmp_path / "Own.fmu"
    assert asked == [source]


@pytest.mark.parametrize(
    ("file", "line", "found"),
    [
        ("Part.mo", 7, ("Part.mo", 7)),  # beside the model
        ("sub/Other.mo", 3, ("sub/Other.mo", 3)),
        ("Gone.mo", 9, ("Own.mo", None)),  # of the library: no file of the user
        (None, None, ("Own.mo", None)),
        ("Own.mo", 1, ("Own.mo", 1)),
    ],
)
def test_a_mistake_of_a_model_has_its_file_and_line(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    file: str | None,
    line: int | None,
    found: tuple[str, int | None],
) -> None:
    (tmp_path / "sub").mkdir()
    for name in ("Own.mo", "Part.mo", "sub/Other.mo"):
        (tmp_path / name).write_text("", encoding="utf-8")

    def fail(_source: Path) -> Path:
        raise BuildError(file, line, "no end of the model")

    monkeypatch.setattr(fmu_files, "ensure_own_built", fail)
    with pytest.raises(UserError) as caught:
        own_fmu(tmp_path / "Own.mo")
    assert caught.value.message == "the model cannot be built: no end of the model"
    name, at = found
    assert (caught.value.file, caught.value.line) == (str(tmp_path / name), at)


def test_a_model_of_the_library_that_cannot_be_built_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What has failed is tried again."""

    def fail(_model: str) -> Path:
        raise BuildError("ServoAxis.mo", 7, "no compiler")

    with monkeypatch.context() as patched:
        patched.setattr(fmu_files, "ensure_built", fail)
        library_fmu.cache_clear()
        for _ in range(2):
            with pytest.raises(UserError) as caught:
                library_fmu("AxisRig.Drives.ServoAxis")
            assert caught.value.message == (
                "AxisRig.Drives.ServoAxis cannot be built: ServoAxis.mo:7: no compiler"
            )
    assert library_fmu("AxisRig.Drives.ServoAxis").suffix == ".fmu"


@pytest.mark.parametrize(
    ("found", "words"),
    [
        ([], []),
        (["The unit xyz"], ["(unit): The unit xyz;"]),
        (["The unit xyz", "a has no start value."], ["(unit): The unit xyz (and 1 more);"]),
        (["a has no start value.", "b", "c"],
         ["(start-value): a has no start value. (and 2 more);"]),
    ],
)  # fmt: skip
def test_an_fmu_that_breaks_the_standard_has_its_first_problem_and_their_number(
    found: list[str], words: list[str]
) -> None:
    slave: Any = SimpleNamespace(problems=found, path=Path("/x/own.fmu"))
    assert problems(slave) == [
        f"its description breaks the standard {one} axisrig fmu check own.fmu lists it"
        for one in words
    ]


def roles_of(kind: str = "axis", grid_ns: int | None = None, *, varies: bool = True,
             tool: bool = False, spare: tuple[str, ...] = ()) -> Any:  # fmt: skip
    can = SimpleNamespace(can_vary_step=varies, needs_tool=tool)
    return SimpleNamespace(
        kind=kind, slave=SimpleNamespace(can=can, grid_ns=grid_ns), spare_inputs=lambda: list(spare)
    )


ALL = {"grid_ns": 2_500_000, "varies": False, "tool": True, "spare": ("supply", "heat")}


@pytest.mark.parametrize(
    ("keys", "lines"),
    [
        ({}, []),
        ({"grid_ns": 2_500_000}, ["takes steps of 2.5 ms only: interpolated between"]),
        ({"grid_ns": 1_000_000, "kind": "probe"}, ["takes steps of 1 ms only: held between"]),
        ({"grid_ns": 1_000_000, "kind": "distance"}, ["takes steps of 1 ms only: held between"]),
        ({"varies": False}, ["takes steps of one length only and does not say of which"]),
        ({"tool": True},
         ["needs the tool that made it on this machine (needsExecutionTool)"]),
        ({"spare": ("supply",)}, ["nothing is wired to supply: start values are kept"]),
        (ALL, [
            "takes steps of 2.5 ms only: interpolated between",
            "needs the tool that made it on this machine (needsExecutionTool)",
            "nothing is wired to supply, heat: start values are kept",
        ]),
    ],
)  # fmt: skip
def test_the_limits_of_an_fmu_of_the_user_are_remarked_on_and_none_of_a_model(
    keys: dict[str, Any], lines: list[str]
) -> None:
    assert remarks(PlantTable(fmu="/x/own.fmu"), roles_of(**keys)) == lines
    for fmu in ("AxisRig.Drives.ServoAxis", "/x/own.mo"):
        assert remarks(PlantTable(fmu=fmu), roles_of(**keys)) == []
