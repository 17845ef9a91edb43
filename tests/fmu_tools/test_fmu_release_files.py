"""Files of `axisrig fmu release`: courses of inputs, CSV, checksums."""

import hashlib
from collections import deque
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import variable

from axisrig.bench.tools.fmu import release
from axisrig.bench.tools.fmu.release import Change
from axisrig.fmus import MODELS
from axisrig.kernel.time.clock import MS


def test_a_course_is_written_before_and_after_each_change() -> None:
    inputs: Any = [variable("x", start="0.5"), variable("on", type="Boolean", start="true"),
                   variable("n", type="Int32", start="3")]  # fmt: skip
    course = [Change(0.0, "x", 1.0), Change(0.2, "n", 4.0), Change(0.2, "on", 0.0)]
    rows = list(release._input_rows(inputs, course, 0.0, 1.0))
    assert rows == [[0.0, 1.0, 1, 3], [0.2, 1.0, 1, 3], [0.2, 1.0, 0, 4], [1.0, 1.0, 0, 4]]
    assert list(release._input_rows(inputs, [], 0.0, 1.0)) == [[0.0, 0.5, 1, 3], [1.0, 0.5, 1, 3]]
    late = list(release._input_rows(inputs, [Change(0.1, "x", 2.0)], 0.05, 1.0))
    assert late == [[0.05, 0.5, 1, 3], [0.1, 0.5, 1, 3], [0.1, 2.0, 1, 3], [1.0, 2.0, 1, 3]]
    early = list(release._input_rows(inputs, [Change(0.0, "x", 2.0)], 0.05, 1.0))
    assert early == [[0.05, 2.0, 1, 3], [1.0, 2.0, 1, 3]]


def test_a_change_acts_from_the_first_point_that_is_not_before_it() -> None:
    given: list[tuple[str, float]] = []

    def set_start(name: str, value: float) -> None:
        given.append((name, value))

    slave: Any = SimpleNamespace(variable=variable, set_start=set_start)
    waiting = deque([Change(0.0, "a", 1.0), Change(0.002, "b", 2.0), Change(0.0021, "c", 3.0)])
    came = []
    for ms in (0, 1, 2, 3):
        release._apply(slave, waiting, ms * MS)
        came.append(len(given))
    assert came == [1, 1, 2, 3]
    assert given == [("a", 1.0), ("b", 2.0), ("c", 3.0)]


def test_sums_are_of_every_file_but_themselves(tmp_path: Path) -> None:
    for name in ("b/x.fmu", "a.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name, encoding="utf-8")
    for _ in range(2):
        path = release.write_sums(tmp_path)
        assert path.read_text(encoding="utf-8").splitlines() == [
            f"{hashlib.sha256(name.encode()).hexdigest()}  {name}" for name in ("a.csv", "b/x.fmu")
        ]
    release._write_csv(tmp_path / "v.csv", ["time", "x.y"], [[0.1 + 0.2, 1], [1e-9, 0]])
    assert (tmp_path / "v.csv").read_text(encoding="utf-8") == (
        '"time","x.y"\n0.30000000000000004,1\n1e-09,0\n'
    )


def test_courses_of_models_are_in_the_order_of_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = ("L.a,0.5,x,1", "L.b,0,y,2", "L.a,0.25,z,3", "L.a,0,x,4")
    path = tmp_path / "courses.csv"
    path.write_text("\n".join(["model,at_s,variable,value", *rows, ""]), encoding="utf-8")
    monkeypatch.setattr(release, "COURSES_FILE", path)
    assert release.courses.__wrapped__() == {
        "L.a": [Change(0.0, "x", 4.0), Change(0.25, "z", 3.0), Change(0.5, "x", 1.0)],
        "L.b": [Change(0.0, "y", 2.0)],
    }


def test_every_model_of_the_library_has_a_course() -> None:
    assert set(release.courses()) == set(MODELS)
