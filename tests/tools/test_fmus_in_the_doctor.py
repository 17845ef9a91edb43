"""`axisrig doctor` on the FMUs of the library: shipped, built, missing, not to be built."""

from pathlib import Path

import pytest

from axisrig.bench.tools.listings import doctor
from axisrig.fmus import BuildError
from axisrig.fmus.shipped import Shipped

pytestmark = pytest.mark.interpreted  # replaces what the computer has

A, B, C = "L.One", "L.Two", "L.Three"


def last(model: str) -> str:
    return model.rpartition(".")[2]


@pytest.fixture
def three(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of three models: A came with the installation, B was built here, C is not there."""
    monkeypatch.setattr(doctor, "MODELS", (A, B, C))
    monkeypatch.setattr(doctor, "_interfaces", list)
    monkeypatch.setattr(doctor, "leftovers", list)
    monkeypatch.setattr(doctor, "place_in_cache", lambda model: Path(f"/cache/{last(model)}.fmu"))
    monkeypatch.setattr(doctor, "ensure_built", lambda model: Path(f"/built/{last(model)}.fmu"))
    monkeypatch.setattr(doctor, "is_ours", lambda path: path.stem != last(C))
    monkeypatch.setattr(doctor, "shipped_fmu", lambda model: None)


def came(model: str, folder: str) -> Shipped:
    return Shipped(Path(f"/{folder}/{last(model)}.fmu"), "key", "hash")


def about(model: str, *, is_building: bool = False) -> str:
    found = list(doctor.examine(is_building=is_building))
    (line,) = (line for line in found if f" {model}:" in line)
    return line


@pytest.mark.usefixtures("three")
@pytest.mark.parametrize(("is_building", "folder"), [(False, "cache"), (True, "built")])
def test_an_fmu_is_shipped_where_the_one_that_serves_came_with_the_installation(
    is_building: bool, folder: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that was built here is none, although another one came for the same model."""
    monkeypatch.setattr(doctor, "shipped_fmu", {A: came(A, folder), B: came(B, "else")}.get)
    assert about(A, is_building=is_building) == f"ok    {A}: {last(A)}.fmu, shipped"
    assert about(B, is_building=is_building) == f"ok    {B}: {last(B)}.fmu"


@pytest.mark.usefixtures("three")
def test_what_is_missing_is_counted_and_built_where_that_is_asked_for() -> None:
    found = list(doctor.examine())
    assert about(C) == f"info  {C}: not built; that is done where a run needs it"
    assert "info  1 FMU is not built; axisrig doctor --build builds it now" in found
    assert not any(line.startswith(doctor.LACK) and "fmu" in line for line in found)
    assert about(C, is_building=True) == f"ok    {C}: {last(C)}.fmu"
    assert not any("not built" in line for line in doctor.examine(is_building=True))


@pytest.mark.usefixtures("three")
@pytest.mark.parametrize(("there", "missing"), [((), 3), ((B,), 2), ((A, C), 1), ((A, B, C), 0)])
def test_all_that_are_missing_are_counted(
    monkeypatch: pytest.MonkeyPatch, there: tuple[str, ...], missing: int
) -> None:
    monkeypatch.setattr(doctor, "is_ours", lambda path: path.stem in map(last, there))
    counted = [line for line in doctor.examine() if "doctor --build" in line]
    what = "FMU is" if missing == 1 else "FMUs are"
    begins = [f"info  {missing} {what} not built"] if missing else []
    assert [line.partition(";")[0] for line in counted] == begins


@pytest.mark.usefixtures("three")
def test_a_model_that_cannot_be_built_is_a_lack_and_those_after_it_are_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def ensure(model: str) -> Path:
        if model == A:
            raise BuildError("A.mo", 3, "odd")
        return Path("x.fmu")

    monkeypatch.setattr(doctor, "ensure_built", ensure)
    assert about(A, is_building=True) == f"{doctor.LACK}{A}: A.mo:3: odd"
    assert about(B, is_building=True) == f"ok    {B}: x.fmu"


@pytest.mark.usefixtures("three")
@pytest.mark.parametrize(
    ("models", "is_lack"), [((A, B, C), False), ((A, B), True), ((B, C), True), ((), True)]
)
def test_compilers_are_needed_unless_every_fmu_came_with_the_installation(
    models: tuple[str, ...], is_lack: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = {model: came(model, "cache") for model in models}
    monkeypatch.setattr(doctor, "shipped_fmu", here.get)
    asked: list[bool] = []

    def compilers(*, is_needed: bool) -> list[str]:
        asked.append(is_needed)
        return []

    def modelica(*, is_needed: bool) -> str:
        asked.append(is_needed)
        return ""

    monkeypatch.setattr(doctor, "_compilers", compilers)
    monkeypatch.setattr(doctor, "_modelica", modelica)
    list(doctor.examine())
    assert asked == [is_lack, is_lack]


@pytest.mark.usefixtures("three")
@pytest.mark.parametrize("is_fast", [True, False])
def test_the_slower_build_is_named_where_it_runs(
    is_fast: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "is_compiled", lambda: is_fast)
    found = list(doctor.examine())
    assert any("slower build" in line for line in found) is not is_fast
    folder = Path(doctor.platformdirs.user_cache_dir("axisrig")) / "fmus"
    assert f"info  built FMUs are in {folder}" in found
    assert found[0].startswith("Python 3.")
    assert found[-1].startswith("info  nothing here needs a network")
