"""When an FMU is built again, and what the keys of the cache and of a wheel are made of."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.fmus import MODELS, BuildError, ensure_built, ensure_own_built, is_ours
from axisrig.fmus import build as building
from axisrig.fmus.compiler import PLATFORMS, Compiler, this_platform
from axisrig.fmus.shipped import Shipped
from axisrig.fmus.sources import files_below, files_named, hash_of
from axisrig.fmus.watching import building as announced
from axisrig.fmus.watching import heard

AXIS, PROBE = "AxisRig.Drives.ServoAxis", "AxisRig.Sensors.TouchProbe"
OTHER = next(one for one in PLATFORMS.values() if one is not this_platform())


class Builds:
    """Builds that write the name of their model; keeps what was asked for."""

    def __init__(self, place: Path) -> None:
        self.place, self.asked = place, list[tuple[Any, ...]]()
        self.refused = False

    def __call__(self, model: str, path: Path, *rest: Any, **options: Any) -> Path:
        self.asked.append((model, *rest, options))
        if self.refused:
            raise BuildError("M.mo", 3, "odd")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"FMU of {model} {options}", encoding="utf-8")
        return path


@pytest.fixture
def builds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Builds:
    made = Builds(tmp_path / "cache")
    monkeypatch.setattr(building, "build", made)
    monkeypatch.setattr(building, "shipped", dict)
    return made


def library_model(builds: Builds) -> Path:
    return ensure_built(AXIS, builds.place)


def own_model(builds: Builds) -> Path:
    source = builds.place.parent / "Ramp.mo"
    if not source.exists():
        source.write_text("model Ramp end Ramp;", encoding="utf-8")
    return ensure_own_built(source, builds.place)


EITHER = pytest.mark.parametrize("ensure", [library_model, own_model])


# When it is built


@EITHER
@pytest.mark.parametrize("bad", [b"", b"another", b"longer", b"cut"])
def test_what_is_not_byte_for_byte_an_fmu_of_ours_is_built_again(
    builds: Builds, ensure: Callable[[Builds], Path], bad: bytes
) -> None:
    path = ensure(builds)
    good = path.read_bytes()
    assert ensure(builds) == path
    assert len(builds.asked) == 1
    path.write_bytes({b"longer": good + b"\0", b"cut": good[:-1]}.get(bad, bad))
    assert not is_ours(path, builds.place)
    assert ensure(builds) == path
    assert (path.read_bytes(), len(builds.asked)) == (good, 2)
    assert is_ours(path, builds.place)
    ensure(builds)
    assert len(builds.asked) == 2


@EITHER
def test_a_file_that_somebody_else_put_there_is_no_fmu_of_ours(
    builds: Builds, ensure: Callable[[Builds], Path]
) -> None:
    path = ensure(builds)
    good = path.read_bytes()
    (builds.place / "sha256" / next((builds.place / "sha256").iterdir()).name).unlink()
    assert not is_ours(path, builds.place)
    ensure(builds)
    assert len(builds.asked) == 2
    path.unlink()
    assert not is_ours(path, builds.place)
    assert ensure(builds).read_bytes() == good
    assert len(builds.asked) == 3


@EITHER
def test_a_build_that_fails_is_tried_again(
    builds: Builds, ensure: Callable[[Builds], Path]
) -> None:
    builds.refused = True
    for _ in range(2):
        with pytest.raises(BuildError, match=r"M\.mo:3: odd"):
            ensure(builds)
    builds.refused = False
    assert is_ours(ensure(builds), builds.place)
    assert len(builds.asked) == 3


@EITHER
def test_who_listens_hears_of_a_build_and_its_end_also_where_it_fails(
    builds: Builds, ensure: Callable[[Builds], Path]
) -> None:
    words: list[str] = []
    with heard(words.append):
        builds.refused = True
        with pytest.raises(BuildError):
            ensure(builds)
        builds.refused = False
        ensure(builds)
        ensure(builds)
    name = AXIS if ensure is library_model else "Ramp.mo"
    assert words == [f"building {name}", ""] * 2
    ensure(builds).unlink()
    ensure(builds)
    assert len(words) == 4


def test_an_fmu_is_ours_wherever_it_lies_and_in_its_own_cache_alone(
    builds: Builds, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = library_model(builds)
    copy = tmp_path / "copy.fmu"
    copy.write_bytes(path.read_bytes())
    assert is_ours(copy, builds.place)
    assert not is_ours(copy, tmp_path / "another")
    monkeypatch.setattr(building.platformdirs, "user_cache_dir", lambda _: tmp_path / "user")
    assert not is_ours(copy)
    assert ensure_built(AXIS).parent == tmp_path / "user" / "fmus"
    assert is_ours(copy)


def test_options_of_a_build_reach_it(builds: Builds) -> None:
    path = ensure_built(PROBE, builds.place, "2.0", [this_platform().name], "cc")
    given = {"fmi": "2.0", "platforms": [this_platform().name], "compiler": "cc"}
    assert builds.asked == [(PROBE, given)]
    plain = ensure_built(PROBE, builds.place)
    assert builds.asked[1:] == [(PROBE, {"fmi": "3.0", "platforms": (), "compiler": None})]
    assert path != plain
    assert own_model(builds).name.startswith("Ramp-")
    assert builds.asked[2:] == [("Ramp", builds.place.parent / "Ramp.mo", {})]


def test_an_own_model_that_is_not_there_is_an_error(builds: Builds, tmp_path: Path) -> None:
    with pytest.raises(BuildError, match="there is no such model") as caught:
        ensure_own_built(tmp_path / "Nothing.mo", builds.place)
    assert (caught.value.file, caught.value.line) == (str(tmp_path / "Nothing.mo"), None)
    assert builds.asked == []


def test_models_beside_an_own_model_count_and_other_files_do_not(builds: Builds) -> None:
    first, folder = own_model(builds), builds.place.parent
    (folder / "Notes.txt").write_text("a note", encoding="utf-8")
    assert own_model(builds) == first
    (folder / "parts").mkdir()
    (folder / "parts" / "Slope.mo").write_text("model Slope end Slope;", encoding="utf-8")
    second = own_model(builds)
    assert second != first
    (folder / "parts" / "Slope.mo").unlink()
    assert own_model(builds) == first


# Keys

OF_BOTH: list[tuple[str, Any]] = [
    ("_version", lambda: "9.9"), ("TARGET", Path(building.__file__).parent / "reading"),
    ("LIBRARY", Path(building.__file__).parent / "AxisRig" / "Sensors"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "other"), [*OF_BOTH, ("this_platform", lambda: OTHER)])
def test_a_shipped_fmu_is_of_its_platform_and_sources(
    name: str, other: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    keys = [building.source_key(AXIS), building.source_key(AXIS)]
    monkeypatch.setattr(building, name, other)
    keys += [building.source_key(AXIS), building.source_key(PROBE)]
    assert keys[0] == keys[1]
    assert len(set(keys)) == 3


@pytest.mark.parametrize(
    ("name", "other"),
    [("_rumoca", lambda: "9.9"), ("_headers", lambda _: []), ("ZIG_FLAGS", ("-odd",)),
     ("LINK", ("-odd",)), ("compiler_for", lambda *_: None)],
)  # fmt: skip
def test_the_tools_are_in_no_key_of_a_wheel(
    name: str, other: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = building.source_key(AXIS)
    monkeypatch.setattr(building, name, other)
    assert building.source_key(AXIS) == before


@pytest.mark.parametrize(
    ("name", "other"),
    [*OF_BOTH, ("_rumoca", lambda: "9.9"), ("ZIG_FLAGS", ("-odd",)), ("LINK", ("-odd",)),
     ("flags", lambda _: ("-odd",)), ("_headers", lambda _: []),
     ("compiler_for", lambda *_: Compiler("cc", ("cc",), "another one"))],
)  # fmt: skip
def test_an_fmu_in_the_cache_is_of_its_tools_too(
    name: str, other: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of a model of ones own, which may use the library."""
    own = tmp_path / "Ramp.mo"
    own.write_text("model Ramp end Ramp;", encoding="utf-8")
    before = building.cache_key("Ramp", own)
    assert building.cache_key("Ramp", own) == before
    monkeypatch.setattr(building, name, other)
    assert building.cache_key("Ramp", own) != before


def test_each_option_of_a_build_is_in_its_key(tmp_path: Path) -> None:
    for name in ("Ramp.mo", "Slope.mo"):
        (tmp_path / name).write_text("model Ramp end Ramp;", encoding="utf-8")
    own = tmp_path / "Ramp.mo"
    keys = [
        building.cache_key("Ramp", own),
        building.cache_key("Slope", own),
        building.cache_key("Ramp", tmp_path / "Slope.mo"),
        building.cache_key("Ramp", own, step_s=20e-6),
        building.cache_key("Ramp", own, fmi="2.0"),
        building.cache_key("Ramp", own, is_optimised=False),
    ]
    assert len(set(keys)) == len(keys)
    assert building.cache_key("Ramp", own, step_s=building.DEFAULT_STEP_S) == keys[0]
    assert building.cache_key("Ramp", own, platforms=[this_platform().name]) == keys[0]


def test_the_step_of_a_model_is_in_both_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = [building.source_key(AXIS), building.cache_key(AXIS)]
    monkeypatch.setattr(building, "CATALOGUE", {AXIS: building.Model(AXIS, 7e-6, "")})
    assert building.source_key(AXIS) != keys[0]
    assert building.cache_key(AXIS) != keys[1]
    assert AXIS in MODELS


# Files


def written(file: Path, text: str, mtime_ns: int) -> bytes:
    """The hash of a file that somebody writes; its time is set afterwards, as a copy does."""
    file.write_text(text, encoding="utf-8")
    os.utime(file, ns=(mtime_ns, mtime_ns))
    return hash_of(files_named([file]))


SECOND = 1_700_000_000_000_000_000


@pytest.mark.parametrize("after_ns", [20_000_000, -20_000_000, 10**9, 0])
def test_a_file_of_the_same_size_is_read_again_within_the_same_second(
    tmp_path: Path, after_ns: int
) -> None:
    """Also where its old time is put back: the time of its entry is another one then."""
    file = tmp_path / "M.mo"
    before = written(file, "kv = 30;", SECOND + 500_000_000)
    first = files_named([file])
    entry_ns = file.stat().st_ctime_ns
    while True:  # the clock of a file system goes in steps of some milliseconds
        after = written(file, "kv = 40;", SECOND + 500_000_000 + after_ns)
        if file.stat().st_ctime_ns != entry_ns:
            break
    assert files_named([file]) != first
    assert after != before


def test_a_stamp_has_times_in_ns_and_the_size(tmp_path: Path) -> None:
    file = tmp_path / "M.mo"
    written(file, "äb", SECOND + 123_456_700)
    ((name, path, mtime_ns, ctime_ns, size),) = files_named([file])
    assert (name, path, size) == ("M.mo", str(file), 3)
    assert mtime_ns == SECOND + 123_456_700
    assert ctime_ns == file.stat().st_ctime_ns


def test_files_come_by_name_from_whatever_depth(tmp_path: Path) -> None:
    for name in ("b.mo", "a/z.mo", "a/b/c.csv", "a.mo", "a/__pycache__/x.mo", "z.py", "c.mo.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name, encoding="utf-8")

    def names(*endings: str) -> list[str]:
        return [name for name, *_ in files_below(tmp_path, endings)]

    assert names(".mo") == ["a.mo", "a/z.mo", "b.mo"]
    assert names(".py", ".csv") == ["a/b/c.csv", "z.py"]
    assert names("") == ["a.mo", "a/b/c.csv", "a/z.mo", "b.mo", "c.mo.txt", "z.py"]
    assert names(".odd") == []


def test_each_who_listens_hears_the_begin_and_the_end_until_it_goes() -> None:
    """In whatever order they go; an end is an empty text."""
    words: dict[str, list[str]] = {name: [] for name in "abc"}
    listening = {name: heard(texts.append) for name, texts in words.items()}

    def build(model: str) -> None:
        with announced(model):
            pass

    for one in listening.values():
        one.__enter__()
    build("1")
    for number, name in enumerate("bac", 2):
        listening[name].__exit__(None, None, None)
        build(str(number))

    def notices(*models: int) -> list[str]:
        return [text for number in models for text in (f"building {number}", "")]

    assert words == {"a": notices(1, 2), "b": notices(1), "c": notices(1, 2, 3)}


def test_an_fmu_that_came_with_the_wheel_is_ours_by_its_bytes_alone(
    builds: Builds, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A copy of it is; a file in its place that somebody has changed is none."""
    path = tmp_path / "shipped.fmu"
    path.write_bytes(b"shipped")
    one = Shipped(path, "key", hashlib.sha256(b"shipped").hexdigest())
    monkeypatch.setattr(building, "shipped", lambda: {AXIS: one})
    (tmp_path / "copy.fmu").write_bytes(b"shipped")
    for place in (path, tmp_path / "copy.fmu"):
        assert is_ours(place, builds.place)
    path.write_bytes(b"changed")
    assert not is_ours(path, builds.place)
    assert is_ours(tmp_path / "copy.fmu", builds.place)


@pytest.mark.parametrize("more", [(), (this_platform().name,)])
def test_openmodelica_builds_for_this_platform_and_for_no_other_beside_it(
    more: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[Any, ...]] = []
    monkeypatch.setattr(building, "build_with_omc", lambda *given: asked.append(given) or given[1])
    path = tmp_path / "a.fmu"
    for names in ((OTHER.name, *more), (*more, OTHER.name)):
        with pytest.raises(BuildError, match=f"builds for {this_platform().name} only"):
            building.build(AXIS, path, platforms=names, compiler="omc")
    assert asked == []
    assert building.build(AXIS, path, platforms=more * 2, compiler="omc") == path
    assert asked == [(AXIS, path, building.LIBRARY, "3.0")]
