"""FMUs that a process keeps: those in use count, and a file in the place of another is another."""

import os
from pathlib import Path
from typing import Any

import pytest
from tests.machine.test_kept_fmus_by_hand import OWN, World

from axisrig.bench.machine import kept_fmus
from axisrig.bench.machine.kept_fmus import close_fmus, take_fmu

STATE = kept_fmus._state  # before a world of its own replaces it

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


@pytest.mark.parametrize(("in_use", "given_back"), [(0, 4), (1, 4), (2, 2), (3, 1), (4, 3), (0, 3)])
def test_instances_in_use_count_among_those_that_are_kept(
    monkeypatch: pytest.MonkeyPatch, in_use: int, given_back: int
) -> None:
    """Three at most; what is in use stays, and those that were not used for longest go."""
    world = World(monkeypatch)
    monkeypatch.setattr(kept_fmus, "KEPT_MAX", 3)
    used: list[Any] = [take_fmu(OWN, f"u{n}") for n in range(in_use)]
    others: list[Any] = [take_fmu(OWN, f"o{n}") for n in range(given_back)]
    close_fmus(others)
    gone = min(max(in_use + given_back - 3, 0), given_back)
    assert world.closed == [one.number for one in others[:gone]]
    assert all(slave.pointer for slave in used)


def test_a_file_that_took_the_place_of_another_is_another(tmp_path: Path) -> None:
    """With as many bytes and the same time; one that is missing has no state."""
    path, other = tmp_path / "a.fmu", tmp_path / "b.fmu"
    for file, text in ((path, "one"), (other, "two")):
        file.write_text(text, encoding="utf-8")
        os.utime(file, ns=(5, 5))
    first = STATE(path)
    assert STATE(path) == first
    other.replace(path)
    second = STATE(path)
    assert second != first
    os.utime(path, ns=(5, 6))
    third = STATE(path)
    path.write_text("longer", encoding="utf-8")
    os.utime(path, ns=(5, 6))
    assert len({first, second, third, STATE(path)}) == 4
    path.unlink()
    assert STATE(path) is None
