"""What a build of the library is asked for is also where its FMU is looked for."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.tools.fmu import library
from axisrig.fmus import MODELS, BuildError
from axisrig.kernel.errors import UserError

PROBE = next(name for name in MODELS if name.endswith(".TouchProbe"))


class Cache:
    """A cache with a file for each model and its options; keeps what is asked and built."""

    def __init__(self) -> None:
        self.present: set[str] = set()
        self.looked: list[tuple[Any, ...]] = []
        self.tasks: list[list[Any]] = []

    def place(self, name: str, cache_dir: Path | None, fmi: str, *options: Any) -> Path:
        self.looked.append((name, cache_dir, fmi, *options))
        platforms, compiler = options
        return Path("/cache", "-".join([name, fmi, *platforms, compiler or "default"]))

    def run_apart(self, _function: object, tasks: Any, **_: Any) -> Any:
        self.tasks = [list(task) for task in tasks]
        return iter([self.place(*task) for task in tasks])


@pytest.fixture
def cache(monkeypatch: pytest.MonkeyPatch) -> Cache:
    made = Cache()
    monkeypatch.setattr(library, "place_in_cache", made.place)
    monkeypatch.setattr(library, "is_ours", lambda path: path.name in made.present)
    monkeypatch.setattr(library, "run_apart", made.run_apart)
    return made


def built(**given: Any) -> list[str]:
    return [one.path.name for one in library.build_models("TouchProbe", **given)]


@pytest.mark.parametrize("compiler", ["cc", "zig", "omc"])
def test_the_fmu_of_another_compiler_is_none_of_this_one(cache: Cache, compiler: str) -> None:
    cache.present = {f"{PROBE}-3.0-default"}
    assert built() == [f"{PROBE}-3.0-default"]
    assert cache.tasks == []
    assert built(compiler=compiler) == [f"{PROBE}-3.0-{compiler}"]
    assert cache.tasks == [[PROBE, None, "3.0", [], compiler]]


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ({"compiler": "zig"}, "3.0-zig"),
        ({"fmi": ["2.0"]}, "2.0-default"),
        ({"platforms": ["x86_64-windows"]}, "3.0-x86_64-windows-default"),
        ({"platforms": ["x86_64-windows", "x86_64-linux"]},
         "3.0-x86_64-windows-x86_64-linux-default"),
        ({"fmi": ["2.0"], "platforms": ["x86_64-darwin"], "compiler": "zig"},
         "2.0-x86_64-darwin-zig"),
    ],
)  # fmt: skip
def test_an_fmu_with_the_same_options_is_taken_from_the_cache(
    cache: Cache, given: dict[str, Any], name: str
) -> None:
    cache.present = {f"{PROBE}-{name}"}
    assert built(**given) == [f"{PROBE}-{name}"]
    assert cache.tasks == []
    assert built() == [f"{PROBE}-3.0-default"]
    assert cache.tasks == [[PROBE, None, "3.0", [], None]]


def test_all_options_are_those_of_each_version(cache: Cache) -> None:
    platforms = ["x86_64-windows"]
    found = built(fmi=["2.0", "3.0"], platforms=platforms * 2, compiler="zig")
    assert found == [f"{PROBE}-{fmi}-x86_64-windows-zig" for fmi in ("2.0", "3.0")]
    wanted = [[PROBE, None, fmi, platforms, "zig"] for fmi in ("2.0", "3.0")]
    assert cache.tasks == wanted
    assert [list(one) for one in cache.looked[:2]] == wanted


@pytest.mark.parametrize(
    "given", [{"fmi": ["2.0"]}, {"fmi": ["3.0", "2.0"]}, {"platforms": ["x86_64-linux"]},
              {"compiler": "cc"}],
)  # fmt: skip
def test_a_model_of_ones_own_takes_no_options(tmp_path: Path, given: dict[str, Any]) -> None:
    own = tmp_path / "Ramp.mo"
    own.write_text("model Ramp end Ramp;", encoding="utf-8")
    with pytest.raises(UserError, match=r"built as FMI 3\.0 for this platform") as caught:
        list(library.build_models(str(own), **given))
    assert caught.value.value == str(own)
    assert caught.value.hint == "leave out --fmi, --platform, --compiler"


def test_a_model_of_ones_own_that_is_not_there_has_near_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("Ramp.mo").touch()
    with pytest.raises(UserError, match="there is no such model") as caught:
        list(library.build_models("Rampe.mo"))
    assert (caught.value.file, caught.value.hint) == ("Rampe.mo", "near it: Ramp.mo")


def fails(*_: Any, **__: Any) -> Path:
    raise BuildError("M.mo", 3, "odd")


@pytest.mark.parametrize("yields", [True, False])
def test_a_build_that_fails_names_its_model(
    cache: Cache, monkeypatch: pytest.MonkeyPatch, yields: bool
) -> None:
    """In turn: what was built before it has come."""

    def run_apart(_function: object, tasks: Any, **_: Any) -> Any:
        if yields:
            yield cache.place(*tasks[0])
        fails()

    monkeypatch.setattr(library, "run_apart", run_apart)
    found = library.build_models("TouchProbe", ["3.0", "2.0"])
    if yields:
        assert next(found) == (PROBE, "3.0", Path("/cache", f"{PROBE}-3.0-default"))
    with pytest.raises(UserError, match=rf"{PROBE} cannot be built: M\.mo:3: odd"):
        next(found)


def listed() -> dict[str, list[str]]:
    rows = library.listing().split("\n\n", maxsplit=1)[0].splitlines()
    return {row.split()[0]: row.split()[1:4] for row in rows}


def test_the_list_has_each_model_with_its_step_and_whether_it_is_built(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(library, "place_in_cache", lambda name: Path("/cache", name))
    monkeypatch.setattr(library, "is_ours", lambda path: path.name == PROBE)
    found = listed()
    assert list(found) == list(MODELS)
    assert {row[2] for name, row in found.items() if name != PROBE} == {"-"}
    assert found[PROBE][2] == "built"
    for name, row in found.items():
        assert float(row[0]) == pytest.approx(library.CATALOGUE[name].step_s * 1e6)
        assert row[1] == "us"
    assert library.listing().splitlines()[-1] == "built FMUs are in /cache"


def test_the_list_says_once_why_nothing_can_be_built(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "place_in_cache", fails)
    assert {row[2] for row in listed().values()} == {"?"}
    lines = library.listing().split("\n\n")[1].splitlines()
    assert lines == ["nothing can be built: M.mo:3: odd"]


def test_what_cannot_be_looked_for_cannot_be_built(
    cache: Cache, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(library, "place_in_cache", fails)
    with pytest.raises(UserError, match=r"nothing can be built: M\.mo:3: odd"):
        built()
    assert cache.tasks == []


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize(
    ("option", "good", "bad", "message"),
    [
        ("fmi", "3.0", "1.0", "no such FMI version"),
        ("platforms", "x86_64-linux", "solaris", "no such platform"),
        ("platforms", "all", "solaris", "no such platform"),
    ],
)
def test_each_word_of_an_option_has_to_be_one_of_it(
    cache: Cache, option: str, good: str, bad: str, message: str, first: bool
) -> None:
    """Before and after a good one; nothing is built, and nothing is looked for."""
    words = [bad, good] if first else [good, bad]
    with pytest.raises(UserError, match=message) as caught:
        built(**{option: words})
    assert caught.value.value == bad
    assert cache.looked == []


@pytest.mark.parametrize(
    ("given", "allowed"),
    [
        ({"compiler": "zip"}, "cc, zig, omc"),
        ({"compiler": "gcc"}, "cc, zig, omc"),
        ({"fmi": ["3.1"]}, ", ".join(library.FMI_VERSIONS)),
        ({"platforms": ["linux"]}, ", ".join(["all", *library.PLATFORMS])),
    ],
)
def test_of_a_few_words_all_are_shown_that_are_allowed(
    cache: Cache, given: dict[str, Any], allowed: str
) -> None:
    """Not only those that look like the wrong one."""
    assert len(allowed.split(", ")) <= 6
    with pytest.raises(UserError) as caught:
        built(**given)
    assert caught.value.allowed == allowed
    assert cache.looked == []


def test_of_many_models_the_near_ones_are_shown() -> None:
    with pytest.raises(UserError, match="the library has no such model") as caught:
        list(library.build_models(f"{PROBE}s"))
    allowed = str(caught.value.allowed).split(", ")
    assert allowed[0] == PROBE
    assert len(allowed) < len(MODELS)
    assert caught.value.value == f"{PROBE}s"


@pytest.mark.parametrize("folder", ["", "sub/"])
def test_a_model_of_ones_own_is_looked_for_where_its_path_says(
    folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The path is one from the working folder; near names are those beside it."""
    monkeypatch.chdir(tmp_path)
    Path("sub").mkdir()
    Path(f"{folder}Ramp.mo").touch()
    with pytest.raises(UserError, match="there is no such model") as caught:
        list(library.build_models(f"{folder}Rampe.mo"))
    assert caught.value.file == f"{folder}Rampe.mo"
    assert caught.value.hint == "near it: Ramp.mo"
