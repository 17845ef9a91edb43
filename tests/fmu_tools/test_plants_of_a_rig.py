"""The FMU of a plant of a rig: where it comes from, who is blamed for a mistake, what is noted."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import fmu_files
from axisrig.bench.machine.fmu_files import own_fmu, plant_path, problems, remarks
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.fmus import MODELS, BuildError
from axisrig.kernel.errors import UserError

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml"


@pytest.fixture
def models(tmp_path: Path) -> Path:
    """A model, one beside it and one in a folder, all of which it may use."""
    folder = tmp_path / "mo"
    (folder / "parts").mkdir(parents=True)
    for name in ("Ramp.mo", "Slope.mo", "parts/Gain.mo"):
        (folder / name).write_text("model M\nend M;\n", encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("file", "line", "blamed", "at"),
    [
        ("Ramp.mo", 2, "Ramp.mo", 2),
        ("Slope.mo", 7, "Slope.mo", 7),
        ("parts/Gain.mo", 1, "parts/Gain.mo", 1),
        ("Slope.mo", None, "Slope.mo", None),
        (None, None, "Ramp.mo", None),
        # Of the library, or no file at all: the line of another file would be no help
        ("AxisRig/Drives/ServoAxis.mo", 12, "Ramp.mo", None),
        ("Ramp", 5, "Ramp.mo", None),
        ("parts", 5, "Ramp.mo", None),
    ],
)
def test_a_mistake_is_blamed_on_the_file_that_has_it(
    models: Path, file: str | None, line: int | None, blamed: str, at: int | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    def refused(_source: Path) -> Path:
        raise BuildError(file, line, "there is no k")

    monkeypatch.setattr(fmu_files, "ensure_own_built", refused)
    with pytest.raises(UserError) as caught:
        own_fmu(models / "Ramp.mo")
    assert caught.value.message == "the model cannot be built: there is no k"
    assert (caught.value.file, caught.value.line) == (str(models / blamed), at)


def test_a_mistake_in_a_file_that_is_elsewhere_has_its_whole_path(
    models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    far = tmp_path / "Far.mo"
    far.touch()

    def refused(_source: Path) -> Path:
        raise BuildError(far, 4, "odd")

    monkeypatch.setattr(fmu_files, "ensure_own_built", refused)
    with pytest.raises(UserError) as caught:
        own_fmu(models / "Ramp.mo")
    assert (caught.value.file, caught.value.line) == (str(far), 4)


def test_a_real_mistake_beside_a_model_is_blamed_on_its_own_file(models: Path) -> None:
    """The model is right; the one that it uses names a variable that is not there, in line 4."""
    (models / "Ramp.mo").write_text(
        "model Ramp\n  Slope slope;\n  output Real y = slope.k;\nend Ramp;\n", encoding="utf-8"
    )
    (models / "Slope.mo").write_text(
        "model Slope\n  Real k;\nequation\n  k = 2*tme;\nend Slope;\n", encoding="utf-8"
    )
    with pytest.raises(UserError, match="tme") as caught:
        own_fmu(models / "Ramp.mo")
    assert (caught.value.file, caught.value.line) == (str(models / "Slope.mo"), 4)


def test_a_model_of_the_user_is_looked_at_again_for_every_machine(
    models: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It, or one that it uses, may have another content by then; a mistake may be mended."""
    asked: list[Path] = []

    def ensure(source: Path) -> Path:
        asked.append(source)
        text = source.read_text(encoding="utf-8")
        if "mistake" in text:
            raise BuildError(None, 1, "odd")
        return Path(f"{source.stem}-{len(text)}.fmu")

    monkeypatch.setattr(fmu_files, "ensure_own_built", ensure)
    ramp, slope = models / "Ramp.mo", models / "Slope.mo"
    settings = settings_of(RIG, [])

    def found(source: Path) -> str:
        return str(plant_path(settings, "z", PlantTable(fmu=str(source))))

    assert [found(ramp), found(slope), found(ramp)] == [
        "Ramp-15.fmu",
        "Slope-15.fmu",
        "Ramp-15.fmu",
    ]
    ramp.write_text("model M\nReal x;\nend M;\n", encoding="utf-8")
    assert [found(ramp), found(slope)] == ["Ramp-23.fmu", "Slope-15.fmu"]
    ramp.write_text("a mistake", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(UserError, match="cannot be built: odd"):
            found(ramp)
    ramp.write_text("model M\nend M;\n", encoding="utf-8")
    assert found(ramp) == "Ramp-15.fmu"
    assert "".join(path.stem[0] for path in asked) == "RSRRSRRR"


def test_where_the_fmu_of_a_plant_comes_from(models: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fmu_files, "own_fmu", lambda path: Path(f"own {path}"))
    monkeypatch.setattr(fmu_files, "library_fmu", lambda name: Path(f"library {name}"))
    settings = settings_of(RIG, [])
    own = str(models / "Ramp.mo")
    for fmu, found in (
        ("gone/a.fmu", "gone/a.fmu"), (own, f"own {own}"), (MODELS[2], f"library {MODELS[2]}"),
    ):  # fmt: skip
        assert str(plant_path(settings, "z", PlantTable(fmu=fmu))) == found


@pytest.mark.parametrize(
    ("fmu", "message", "words"),
    [
        ("AxisRig.Drives.ServoAxes", "neither a model of the library nor a path",
         "did you mean: AxisRig.Drives.ServoAxis"),
        ("zzz", "neither a model of the library nor a path", f"allowed: {', '.join(MODELS)}"),
        ("{models}/Rampe.mo", "there is no such model", "near it: Ramp.mo"),
        ("{models}/none/Q.mo", "there is no such model", "looked in {models}/none"),
    ],
)  # fmt: skip
def test_a_plant_that_is_not_there_is_blamed_on_its_line_with_what_is_near(
    models: Path, fmu: str, message: str, words: str
) -> None:
    """`fmu` of `[plant.probe]`, the second of two."""
    wanted = fmu.format(models=models.as_posix())
    with pytest.raises(UserError, match=message) as caught:
        plant_path(settings_of(RIG, []), "probe", PlantTable(fmu=wanted))
    lines = RIG.read_text(encoding="utf-8").splitlines()
    line = lines.index("[plant.probe]") + 2
    assert (caught.value.file, caught.value.line) == (str(RIG), line)
    assert caught.value.value == wanted
    assert words.format(models=models.as_posix()) in str(caught.value)


def test_a_model_of_the_library_that_cannot_be_built_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[str] = []

    def ensure(model: str) -> Path:
        asked.append(model)
        if model == "B":
            raise BuildError(None, None, "no compiler")
        return Path(f"{model}.fmu")

    monkeypatch.setattr(fmu_files, "ensure_built", ensure)
    fmu_files.library_fmu.cache_clear()
    try:
        assert [str(fmu_files.library_fmu(name)) for name in "AACA"] == ["A.fmu"] * 2 + [
            "C.fmu", "A.fmu",
        ]  # fmt: skip
        assert asked == ["A", "C"]
        for _ in range(2):  # what has failed is tried again
            with pytest.raises(UserError, match="B cannot be built: no compiler"):
                fmu_files.library_fmu("B")
        assert asked == ["A", "C", "B", "B"]
    finally:
        fmu_files.library_fmu.cache_clear()


# What is noted


def slave(**given: Any) -> Any:
    can = {"can_vary_step": True, "needs_tool": False}
    own = {name: given.pop(name) for name in tuple(given) if name in can}
    values = {"problems": [], "grid_ns": None, "path": Path("folder/pump.fmu")}
    return SimpleNamespace(can=SimpleNamespace(**(can | own)), **(values | given))


def roles(kind: str = "axis", spare: tuple[str, ...] = (), **given: Any) -> Any:
    return SimpleNamespace(slave=slave(**given), kind=kind, spare_inputs=lambda: list(spare))


OWN = PlantTable(fmu="pump.fmu")


@pytest.mark.parametrize(
    ("found", "lines"),
    [
        (roles(), []),
        (roles(grid_ns=2_500_000), ["takes steps of 2.5 ms only: interpolated between"]),
        (roles("probe", grid_ns=1_000_000), ["takes steps of 1 ms only: held between"]),
        (roles(can_vary_step=False),
         ["takes steps of one length only and does not say of which"]),
        # Whose length is known does not count as unknown too
        (roles(grid_ns=1_000_000, can_vary_step=False),
         ["takes steps of 1 ms only: interpolated between"]),
        (roles(needs_tool=True),
         ["needs the tool that made it on this machine (needsExecutionTool)"]),
        (roles(spare=("draught", "heat")),
         ["nothing is wired to draught, heat: start values are kept"]),
        (roles("probe", ("heat",), grid_ns=1_000_000, needs_tool=True),
         ["takes steps of 1 ms only: held between",
          "needs the tool that made it on this machine (needsExecutionTool)",
          "nothing is wired to heat: start values are kept"]),
    ],
)  # fmt: skip
def test_what_the_bench_makes_of_an_fmu_of_ones_own(found: Any, lines: list[str]) -> None:
    assert remarks(OWN, found) == lines
    for ours in ("AxisRig.Drives.ServoAxis", "mo/Ramp.mo"):
        assert remarks(PlantTable(fmu=ours), found) == []


def test_what_breaks_the_standard_is_noted_with_its_count() -> None:
    first = "first thing is odd"
    for rest, more in (([], ""), (["b"], " (and 1 more)"), (["b", "c"], " (and 2 more)")):
        assert problems(slave(problems=[first, *rest])) == [
            f"its description breaks the standard (other): first thing is odd{more};"
            " axisrig fmu check pump.fmu lists it"
        ]
    assert problems(slave()) == []
