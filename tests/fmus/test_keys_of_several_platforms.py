"""Keys and targets of FMUs for several platforms, and a compiler that does not run."""

import itertools
import subprocess
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus import build as building
from axisrig.fmus import compiler as compilers
from axisrig.fmus.compiler import PLATFORMS, Compiler
from axisrig.fmus.reading.errors import BuildError

AXIS = "AxisRig.Drives.ServoAxis"
LINUX, WINDOWS, ARM = "x86_64-linux", "x86_64-windows", "aarch64-linux"


def test_every_platform_of_an_fmu_is_in_its_key(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whichever is the first: two FMUs that differ in any library are two in the cache."""
    zig = Compiler("zig", ("zig",), "zig 1")
    monkeypatch.setattr(building, "compiler_for", lambda *_: zig)
    names = (LINUX, WINDOWS, ARM)
    chosen = [each for count in (1, 2, 3) for each in itertools.combinations(names, count)]
    keys = [building.cache_key(AXIS, platforms=each) for each in chosen]
    assert len(set(keys)) == len(chosen) == 7
    assert building.cache_key(AXIS, platforms=[LINUX, WINDOWS, LINUX]) == keys[chosen.index(
        (LINUX, WINDOWS)
    )]  # fmt: skip


@pytest.mark.parametrize("own", ["aarch64-darwin", "x86_64-darwin"])
def test_a_build_for_this_platform_needs_no_other_one(
    own: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """macOS: FMI 2.0 has one folder for two machines, but the system's cc builds for one alone."""
    both = [PLATFORMS["x86_64-darwin"], PLATFORMS["aarch64-darwin"]]
    monkeypatch.setattr(building, "this_platform", lambda: PLATFORMS[own])
    for names in ((), (own,)):
        assert building._targets(names, "2.0") == [PLATFORMS[own]]
        assert building._targets(names, "3.0") == [PLATFORMS[own]]
    (other,) = (each for each in both if each.name != own)
    found = building._targets([other.name], "2.0")
    assert sorted(each.name for each in found) == sorted(each.name for each in both)
    assert building._targets([other.name], "3.0") == [other]


@pytest.mark.parametrize("code", [1, -11, 127])
def test_a_compiler_that_does_not_run_says_why(code: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """By its answer to --version: it may answer to the other question all the same."""
    asked: list[str] = []

    def run(command: list[str], **_: Any) -> Any:
        asked.append(command[1])
        is_version = command[1] == "--version"
        return SimpleNamespace(
            returncode=code if is_version else 0, stdout="x86_64-linux-gnu\n",
            stderr="no licence \n" if is_version else "a warning",
        )  # fmt: skip

    monkeypatch.setattr(compilers.shutil, "which", lambda name: f"/opt/broken{code}/{name}")
    monkeypatch.setattr(subprocess, "run", run)
    with pytest.raises(BuildError) as error:
        compilers.find_compiler("cc")
    assert error.value.message == f"/opt/broken{code}/cc does not run: no licence"
    assert asked[0] == "--version"
