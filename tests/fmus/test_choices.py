"""Equations that only one branch of a choice needs: computed in that branch, to the same bits."""

import re
import zipfile
from pathlib import Path

import pytest

from axisrig.fmus import ensure_built
from axisrig.fmus.build import build
from axisrig.fmus.equations.system import Assignment
from axisrig.fmus.reading.expressions import Expr
from axisrig.fmus.writing import branches
from axisrig.fmus.writing.branches import Lazy, lazy_rows
from axisrig.kernel.cosim.fmi.fmu import Exchange, load_fmu
from axisrig.kernel.time.clock import MS, US

CHAIN = "\n".join(f"    Real c{k}; Real d{k};" for k in range(10))
EQUATIONS = "\n".join(
    f"    c{k} = sin({'time' if k == 0 else f'c{k - 1}'} + {k});"
    f" d{k} = cos({'time' if k == 0 else f'd{k - 1}'} - {k});"
    for k in range(10)
)
MODEL = f"""package Choice
  model Of
    input Real level(start = 0);
    output Real y(unit="1", start = 0, fixed = true) "Integral";
    output Real shared(unit="1") "Both branches need it, and the output";
{CHAIN}
    Real chosen;
  equation
{EQUATIONS}
    shared = sin(3*time) + level;
    chosen = noEvent(if level*(1 + y^2) > 0.5 then c9*shared else d9 - shared);
    der(y) = chosen;
  end Of;
end Choice;
"""


def leaf(index: int) -> Expr:
    return Expr("y", index=index)


def row(index: int, *needs: int) -> Assignment:
    value = Expr("Sin", [leaf(needs[0])]) if needs else Expr("time")
    for other in needs[1:]:
        value = Expr("Add", [value, leaf(other)])
    return Assignment("y", index, value, None)


def chain(first: int, last: int, end: int | None = None) -> list[Assignment]:
    """Equations each of which needs the one before."""
    begin = [row(first) if end is None else row(first, end)]
    return [*begin, *(row(k, k - 1) for k in range(first + 1, last + 1))]


def choice(index: int, condition: int, first: int, second: int) -> Assignment:
    held = Expr("Gt", [leaf(condition), Expr("const", value=0.0)])
    value = Expr("Select", [held, leaf(first), leaf(second)])
    return Assignment("y", index, value, None)


def indices(rows: list[Assignment | Lazy]) -> list[object]:
    """Indices in order; a choice as its own with those of its branches."""
    return [
        (each.choice.index, *map(indices, each.branches)) if isinstance(each, Lazy) else each.index
        for each in rows
    ]


def test_rows_of_each_branch_go_into_it() -> None:
    rows = [row(1), *chain(10, 15), *chain(20, 25), choice(30, 1, 15, 25)]
    found = indices(lazy_rows(rows, [leaf(30)]))
    assert found == [1, (30, [10, 11, 12, 13, 14, 15], [20, 21, 22, 23, 24, 25])]


def test_what_anything_else_needs_stays_outside() -> None:
    rows = [row(1), *chain(10, 20), *chain(30, 40, end=12), choice(50, 1, 20, 40), row(51, 15)]
    found = indices(lazy_rows(rows, [leaf(50), leaf(51)]))
    assert found == [1, *range(10, 16), (50, [16, 17, 18, 19, 20], [*range(30, 41)]), 51]
    as_roots = indices(lazy_rows(rows[:-1], [leaf(50), leaf(20), leaf(40)]))
    assert as_roots == [r.index for r in rows[:-1]]


def test_equal_values_of_two_rows_are_two_uses() -> None:
    copy = Assignment("y", 60, leaf(20), None)  # the value of the choice's branch once more
    rows = [row(1), *chain(10, 20), choice(50, 1, 20, 1), copy]
    assert indices(lazy_rows(rows, [leaf(50), leaf(60)])) == [r.index for r in rows]


def test_few_rows_are_left_where_they_are() -> None:
    rows = [row(1), *chain(10, 10 + branches.ROWS_MIN - 2), choice(50, 1, 16, 1)]
    assert indices(lazy_rows(rows, [leaf(50)])) == [r.index for r in rows]


def test_choice_inside_a_branch() -> None:
    inner = [*chain(10, 20), choice(25, 1, 20, 1)]
    rows = [row(1), *inner, *chain(30, 40, end=25), choice(50, 1, 40, 1)]
    found = indices(lazy_rows(rows, [leaf(50)]))
    assert found == [1, (50, [(25, [*range(10, 21)], []), *range(30, 41)], [])]


def run(path: Path) -> list[float]:
    """The integral after steps in which the other branch is chosen now and then."""
    slave = load_fmu(path, path.stem)
    slave.initialize(0)
    level, out = Exchange(slave, ["level"]), Exchange(slave, ["y", "shared"])
    found: list[float] = []
    for k in range(60):
        level.values[0] = float(k // 7 % 2)
        level.write()
        slave.step_to((k + 1) * MS)
        out.read()
        found += out.values[:]
    slave.close()
    return found


def test_values_are_the_same_bits_with_and_without(tmp_path, monkeypatch) -> None:
    library = tmp_path / "Choice"
    library.mkdir()
    (library / "package.mo").write_text(MODEL, encoding="utf-8")
    with_blocks = build("Choice.Of", tmp_path / "with.fmu", library)
    monkeypatch.setattr(branches, "ROWS_MIN", 10**9)
    without = build("Choice.Of", tmp_path / "without.fmu", library)

    def source(path: Path) -> str:
        return zipfile.ZipFile(path).read("sources/Choice_Of.c").decode()

    block = re.compile(r"^    double y\d+_chosen;.*\n    if \(", re.MULTILINE)
    assert block.search(source(with_blocks))
    assert not block.search(source(without))
    assert run(with_blocks) == run(without)


@pytest.mark.parametrize(
    ("noise", "order", "draws", "moves"),
    [(0.0, 0, False, False), (1e-9, 0, True, False), (0.0, 1, True, True), (1e-9, 2, True, True)],
)
def test_distance_sensor_does_only_what_its_output_needs(noise, order, draws, moves) -> None:
    slave = load_fmu(ensure_built("AxisRig.Sensors.DistanceSensor"), "sensor")
    slave.set_start("noise", noise)
    slave.set_start("order", order)
    inputs = Exchange(slave, ["step_time", "step_size", "z_start", "z_rate_start", "z_end"])
    inputs.values[:] = [0.0, 1e-3, 5e-3, 0.0, 6e-3]
    inputs.write()
    slave.initialize(0)
    slave.step_to(950 * US)
    states = [slave.get(f"filter.{name}") for name in ("first", "second", "second_rate")]
    assert bool(slave.get("noise_source.y")) == draws
    assert any(states) == moves
    slave.close()
