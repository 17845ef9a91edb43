"""Models of the FMU library: names, platforms, builds from the cache, an FMU by file or name."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.processes import Died
from axisrig.bench.tools.fmu import library, place
from axisrig.fmus import MODELS, PLATFORMS, BuildError
from axisrig.kernel.errors import UserError


def test_models_and_platforms_are_meant_by_their_words() -> None:
    name = next(name for name in MODELS if name.endswith(".TouchProbe"))
    assert library.named("TouchProbe") == library.named(name) == [name]
    assert library.named("touchprobe") == []
    every = [one.name for one in PLATFORMS.values() if one.in_all]
    first = next(iter(PLATFORMS))
    assert library.chosen_platforms(["all", first]) == every
    assert library.chosen_platforms([first, first]) == [first]
    assert library.chosen_platforms([]) == []


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"model": "TouchProb"}, "the library has no such model"),
        ({"fmi": ["1.0"]}, "no such FMI version"),
        ({"platforms": ["solaris"]}, "no such platform"),
        ({"compiler": "tcc"}, "no such compiler"),
    ],
)
def test_a_word_that_the_library_does_not_know_is_refused_before_anything_is_built(
    given: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(library, "_built", lambda *_: pytest.fail("it is built"))
    with pytest.raises(UserError, match=message) as caught:
        list(library.build_models(**{"model": None, **given}))
    assert caught.value.allowed


def test_only_what_the_cache_lacks_is_built_and_all_come_in_their_order(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def run_apart(_function: object, tasks: Any, **_: object) -> Any:
        asked.extend((task[0], task[2]) for task in tasks)
        return iter([Path(f"/new/{task[0]}-{task[2]}") for task in tasks])

    monkeypatch.setattr(library, "MODELS", ("L.a", "L.b", "L.c"))
    monkeypatch.setattr(
        library, "place_in_cache", lambda name, _p, fmi, *_: Path(f"/old/{name}-{fmi}")
    )
    monkeypatch.setattr(library, "is_ours", lambda path: path.name in ("L.b-3.0", "L.a-2.0"))
    monkeypatch.setattr(library, "run_apart", run_apart)
    found = [str(one.path) for one in library.build_models(None, ["3.0", "2.0", "3.0"])]
    assert found == ["/new/L.a-3.0", "/old/L.b-3.0", "/new/L.c-3.0",
                     "/old/L.a-2.0", "/new/L.b-2.0", "/new/L.c-2.0"]  # fmt: skip
    assert asked == [("L.a", "3.0"), ("L.c", "3.0"), ("L.b", "2.0"), ("L.c", "2.0")]
    monkeypatch.setattr(library, "run_apart", lambda *_, **__: iter([Died("no memory")]))
    with pytest.raises(UserError, match=r"L\.a cannot be built: no memory"):
        list(library.build_models("a"))


def test_an_fmu_is_a_file_a_model_or_a_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(place, "own_fmu", lambda path: Path(f"built of {path}"))
    monkeypatch.setattr(place, "library_fmu", lambda name: Path(f"library {name}"))
    monkeypatch.setattr(place, "named", lambda text: {"One": ["L.One"], "Two": ["A.Two", "B.Two"]}
                        .get(text, []))  # fmt: skip
    there = tmp_path / "a file"
    there.touch()
    for text, found in (
        ("m.mo", "built of m.mo"), ("gone.fmu", "gone.fmu"), (str(there), str(there)),
        ("One", "library L.One"),
    ):  # fmt: skip
        assert str(place.find_fmu(text)) == found
    for text in ("Two", "Three"):
        with pytest.raises(UserError, match="neither an FMU file nor a model") as caught:
            place.find_fmu(text)
        assert ("A.Two, B.Two" in str(caught.value.allowed)) is (text == "Two")


def test_the_list_has_steps_in_microseconds_what_is_built_and_where(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One is built, one is not, and of one it cannot be known; each place and reason comes once."""
    steps_s = {"L.Long": 50e-6, "L.b": 1e-3, "L.c": 2.5e-6, "L.d": 1e-3}
    rows = [
        SimpleNamespace(name=name, step_s=step_s, title=f"title of {name}")
        for name, step_s in steps_s.items()
    ]

    def place_of(name: str) -> Path:
        if name in ("L.c", "L.d"):
            raise BuildError(None, None, "no compiler")
        return Path("/cache") / name

    monkeypatch.setattr(library, "CATALOGUE", {row.name: row for row in rows})
    monkeypatch.setattr(library, "MODELS", tuple(row.name for row in rows))
    monkeypatch.setattr(library, "place_in_cache", place_of)
    monkeypatch.setattr(library, "is_ours", lambda path: path.name == "L.Long")
    assert library.listing().splitlines() == [
        "L.Long     50 us  built  title of L.Long",
        "L.b      1000 us  -      title of L.b",
        "L.c       2.5 us  ?      title of L.c",
        "L.d      1000 us  ?      title of L.d",
        "",
        f"built FMUs are in {Path('/cache')}",
        "nothing can be built: no compiler",
    ]


@pytest.mark.parametrize("at", ["place", "build"])
def test_a_model_that_cannot_be_built_is_refused_with_the_reason(
    at: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No compiler for any of them, or the build of one that breaks off."""

    def refuse(*_: object, **__: object) -> Any:
        raise BuildError(None, None, "no compiler")

    def built(*_: object, **__: object) -> Any:
        yield refuse()

    monkeypatch.setattr(library, "MODELS", ("L.a",))
    monkeypatch.setattr(library, "is_ours", lambda _: False)
    monkeypatch.setattr(library, "place_in_cache", refuse if at == "place" else lambda *_: Path())
    monkeypatch.setattr(library, "run_apart", built)
    words = "nothing can be built: no compiler" if at == "place" else "L.a cannot be built: no comp"
    with pytest.raises(UserError, match=re.escape(words)):
        list(library.build_models("a"))
