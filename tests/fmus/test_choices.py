"""Equations that only one branch of a choice needs: computed in that branch, to the same bits."""

import re
import zipfile
from pathlib import Path
from typing import Any

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


SIDES = pytest.mark.parametrize("is_first", [True, False])


def chosen(index: int, condition: int, branch: int, other: int, is_first: bool) -> Assignment:
    """A choice with `branch` as the first or as the second one."""
    return choice(index, condition, *((branch, other) if is_first else (other, branch)))


def branch_of(lazy: Any, is_first: bool) -> tuple[Any, Any]:
    """The rows of a branch and of the other one."""
    _, first, second = lazy
    return (first, second) if is_first else (second, first)


@SIDES
@pytest.mark.parametrize("needed", [10, 15, 17])
def test_what_the_condition_needs_is_computed_before_it(is_first: bool, needed: int) -> None:
    """Also where a branch needs it too: nobody knows yet which branch it will be."""
    rows = [row(1), *chain(10, 30), chosen(50, needed, 30, 1, is_first)]
    *outside, lazy = indices(lazy_rows(rows, [leaf(50)]))
    assert outside == [*range(10, needed + 1)]
    assert branch_of(lazy, is_first) == ([*range(needed + 1, 31)], [1])


@SIDES
def test_what_the_condition_needs_by_way_of_other_equations_is_before_it(is_first: bool) -> None:
    rows = [row(1), *chain(10, 30), row(40, 14), row(41, 40), chosen(50, 41, 30, 1, is_first)]
    *outside, lazy = indices(lazy_rows(rows, [leaf(50)]))
    assert outside == [*range(10, 15), 40, 41]
    assert branch_of(lazy, is_first) == ([*range(15, 31)], [1])


def test_what_both_branches_need_is_computed_before_them() -> None:
    rows = [row(1), *chain(10, 13), *chain(20, 25, end=13), *chain(30, 35, end=12)]
    rows = [*rows, choice(50, 1, 25, 35)]
    *outside, lazy = indices(lazy_rows(rows, [leaf(50)]))
    # 13 is of the first branch alone: the second one begins at 12
    assert outside == [1, 10, 11, 12]
    assert lazy == (50, [13, *range(20, 26)], [*range(30, 36)])


@SIDES
def test_a_branch_that_is_the_other_one_too_has_nothing_of_its_own(is_first: bool) -> None:
    rows = [row(1), *chain(10, 30), chosen(50, 1, 30, 30, is_first)]
    assert indices(lazy_rows(rows, [leaf(50)])) == [each.index for each in rows]


@SIDES
@pytest.mark.parametrize("count", [branches.ROWS_MIN - 1, branches.ROWS_MIN])
def test_as_many_equations_as_the_least_are_enough(is_first: bool, count: int) -> None:
    last = 9 + count
    rows = [row(1), *chain(10, last), chosen(50, 1, last, 1, is_first)]
    found = indices(lazy_rows(rows, [leaf(50)]))
    if count < branches.ROWS_MIN:
        assert found == [each.index for each in rows]
    else:
        assert branch_of(found[-1], is_first) == ([*range(10, last + 1)], [])


@pytest.mark.parametrize(("first", "second"), [(4, 4), (1, 7), (7, 1), (3, 4)])
def test_equations_of_both_branches_count_together(first: int, second: int) -> None:
    rows = [row(1), *chain(10, 9 + first), *chain(30, 29 + second)]
    rows = [*rows, choice(50, 1, 9 + first, 29 + second)]
    found = indices(lazy_rows(rows, [leaf(50)]))
    if first + second < branches.ROWS_MIN:
        assert found == [each.index for each in rows]
    else:
        assert found == [1, (50, [*range(10, 10 + first)], [*range(30, 30 + second)])]


@SIDES
def test_a_choice_inside_either_branch_has_its_own(is_first: bool) -> None:
    inner = [*chain(10, 20), chosen(25, 1, 20, 1, is_first)]
    rows = [row(1), *inner, *chain(30, 40, end=25), chosen(50, 1, 40, 1, is_first)]
    *outside, lazy = indices(lazy_rows(rows, [leaf(50)]))
    own, other = branch_of(lazy, is_first)
    assert (outside, other, own[1:]) == ([1], [], [*range(30, 41)])
    assert branch_of(own[0], is_first) == ([*range(10, 21)], [])


def test_two_choices_have_what_each_alone_needs() -> None:
    """12 is needed by both: it is computed before the first of them."""
    rows = [row(1), *chain(10, 12), *chain(20, 29, end=12), choice(40, 1, 29, 1)]
    rows = [*rows, *chain(50, 59, end=12), choice(70, 1, 1, 59)]
    found = indices(lazy_rows(rows, [leaf(40), leaf(70)]))
    assert found == [1, 10, 11, 12, (40, [*range(20, 30)], []), (70, [], [*range(50, 60)])]


@SIDES
def test_a_later_choice_that_needs_a_row_leaves_it_outside_of_the_former(is_first: bool) -> None:
    """In its condition or in a branch."""
    for later in (choice(70, 25, 1, 1), chosen(70, 1, 25, 1, is_first)):
        rows = [row(1), *chain(20, 34), choice(40, 1, 34, 1), later]
        found = indices(lazy_rows(rows, [leaf(40), leaf(70)]))
        assert found == [1, *range(20, 26), (40, [*range(26, 35)], []), 70]


@SIDES
@pytest.mark.parametrize("needed", [10, 14, 20])
def test_what_a_branch_itself_needs_of_a_choice_inside_it_is_computed_before_that(
    is_first: bool, needed: int
) -> None:
    """Its value is the sum of the inner choice and of a row that else the inner one alone needs."""
    both = Expr("Add", [leaf(45), leaf(needed)])
    held = Expr("Gt", [leaf(1), Expr("const", value=0.0)])
    args = [held, both, leaf(1)] if is_first else [held, leaf(1), both]
    whole = Assignment("y", 50, Expr("Select", args), None)
    rows = [row(1), *chain(10, 30), choice(45, 1, 30, 1), whole]
    *outside, lazy = indices(lazy_rows(rows, [leaf(50)]))
    own, other = branch_of(lazy, is_first)
    # Of 21 equations those from `needed` on are of the inner choice: at least 8 of them
    assert (outside, other) == ([1], [])
    assert own == [*range(10, needed + 1), (45, [*range(needed + 1, 31)], [])]


def test_rows_without_a_choice_stay_as_they_are() -> None:
    rows = chain(1, 20)
    assert lazy_rows(rows, [leaf(20)]) == rows
    assert lazy_rows([], []) == []


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


@pytest.mark.long
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
