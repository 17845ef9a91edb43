"""Cells with several values: itertools, numpy and scipy say what they stand for."""

import itertools
import math
import re
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import kstest, qmc

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.composition import MeantRow
from axisrig.bench.plan.expanded import expanded_text
from axisrig.bench.plan.expansion import draw, parse_cell, variants
from axisrig.bench.plan.pairwise import pairwise
from axisrig.bench.plan.plan import default_seed, read_plan
from axisrig.bench.plan.run_ids import RUN_ID
from axisrig.bench.plan.series import RUNS_MAX
from axisrig.bench.plan.table import Cell, Place
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

HEAD = "case,program,rig"
ROW = "probe.nc,machine.toml"


def _cell(text: str, column: str = "plc:V.E.A") -> Cell:
    return Cell(text, Place(Path("plan.csv"), 2, 4, column))


def _texts(text: str) -> list[str]:
    """The cells that one cell stands for."""
    row = MeantRow(Place(Path("plan.csv"), 2, 1, "case"), {"plc:V.E.A": _cell(text)})
    found = variants(row, ["plc:V.E.A"], [], repeats=1, samples=None, seed="")
    return [variant.texts.get("plc:V.E.A", "") for variant in found[1]]


@pytest.mark.parametrize(
    ("text", "texts"),
    [
        ("300", ["300"]),
        ("[a | b c|d]", ["a", "b c", "d"]),
        ("Z.TPDO1 at=[10ms | 20ms]", ["Z.TPDO1 at=10ms", "Z.TPDO1 at=20ms"]),
        ("[1|2]/[3|4]", ["1/3", "1/4", "2/3", "2/4"]),
        ("[[no list]", ["[no list]"]),
        ("[[1 | 2]", ["[1 | 2]"]),
        ("[- | 5]", ["", "5"]),
        ("[5]", ["5"]),
        ("300 .. 900 step 300", ["300", "600", "900"]),
        ("0 .. 1 step 0.25", ["0", "0.25", "0.5", "0.75", "1"]),
        ("0.1 .. 0.3 step 0.1", ["0.1", "0.2", "0.3"]),
        ("5 .. -5 step -5", ["5", "0", "-5"]),
        ("1e2 .. 3e2 step 1E2", ["100", "200", "300"]),
        ("7 .. 7 step 1", ["7"]),
        ("log(1, 1000, 4)", ["1", "10", "100", "1000"]),
        ("log(100, 1, 3)", ["100", "10", "1"]),
    ],
)
def test_what_a_cell_stands_for(text: str, texts: list[str]) -> None:
    assert _texts(text) == texts


@given(
    first=st.floats(1e-6, 1e6),
    factor=st.floats(1.01, 1e6),
    count=st.integers(2, 40),
)
@pytest.mark.long
def test_log_is_that_of_numpy(first: float, factor: float, count: int) -> None:
    last = first * factor
    texts = _texts(f"log({first!r}, {last!r}, {count})")
    assert (float(texts[0]), float(texts[-1])) == (first, last)
    assert [float(text) for text in texts] == pytest.approx(
        np.geomspace(first, last, count), rel=1e-9
    )


@pytest.mark.long
@given(
    first=st.integers(-1000, 1000),
    step=st.integers(1, 200),
    count=st.integers(0, 50),
    digits=st.integers(0, 4),
)
def test_a_range_has_both_ends_and_decimal_steps(
    first: int, step: int, count: int, digits: int
) -> None:
    """The values are those of whole numbers, shifted by the decimal point."""
    shift = 10**digits
    ends = [f"{value / shift:.{digits}f}" for value in (first, first + count * step, step)]
    texts = _texts(f"{ends[0]} .. {ends[1]} step {ends[2]}")
    assert [round(float(text) * shift) for text in texts] == [
        first + number * step for number in range(count + 1)
    ]
    assert all(abs(float(text) * shift - round(float(text) * shift)) < 1e-6 for text in texts)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("300 .. 3000", "300 .. 3000 step"),
        ("300 .. 3000 step", "cannot be read"),
        ("300..3000 step 0", "does not lead"),
        ("300 .. 3000 step -300", "does not lead"),
        ("300 .. 3000 step 400", "ends at 2700"),
        ("0 .. 1e9 step 1", "more than 100000"),
        ("[]", "the list is empty"),
        ("[ | ]", "the list is empty"),
        ("[a | ]", "a value of the list is missing"),
        ("[a | a]", "twice"),
        ("[a | b", "not closed"),
        ("[1 .. 3 step 1 | 7]", "plain values"),
        ("log(1, 100)", "log needs 3 numbers"),
        ("log(0, 100, 5)", "above 0"),
        ("log(1, 100, 1)", "2 or more"),
        ("log(1, 100, 2.5)", "whole number"),
        ("normal(10, -1)", "negative"),
        ("lhs(2, 1)", "not below"),
        ("sobol(a, 1)", "sobol needs 2 numbers"),
        ("lhs(0, 1)", "need the columns samples and seed"),
    ],
)
def test_what_cannot_be_expanded_names_file_row_and_column(
    write_plan: PlanWriter, text: str, words: str
) -> None:
    path = write_plan(f'{HEAD},plc:V.E.A\na,{ROW},1\nb,{ROW},"{text}"\n')
    with pytest.raises(UserError, match=re.escape(words)) as caught:
        read_plan(path)
    error = caught.value
    assert (error.file, error.line, error.column) == (str(path), 3, 4)


def test_several_lists_are_a_product_the_last_column_fastest(write_plan: PlanWriter) -> None:
    plan = read_plan(
        write_plan(
            f"{HEAD},plc:V.E.A,fault:drop,plant:p.x_mm\n"
            f"a,{ROW},[1 | 2],Z.TPDO1 at=[10ms | 20ms],0 .. 2 step 1\n"
        )
    )
    expected = list(product("12", ("10ms", "20ms"), "012"))
    assert [tuple(case.inputs.values()) for case in plan.cases] == [
        (a, f"Z.TPDO1 at={at}", x) for a, at, x in expected
    ]
    assert [case.run for case in plan.cases] == [
        f"probing-a-{a}-Z.TPDO1_at_{at}-{x}" for a, at, x in expected
    ]
    assert all(case.seed == default_seed(case.run) for case in plan.cases)
    assert [case.index for case in plan.cases] == list(range(12))


def test_zip_lets_limits_go_with_values(write_plan: PlanWriter) -> None:
    head = f"{HEAD},expand,plc:V.E.A,plc:V.E.B,check:latch_mm:Z"
    plan = read_plan(write_plan(f"{head}\na,{ROW},zip,[1 | 2],5 .. 6 step 1,<= [0.1 | 0.2]\n"))
    assert [(case.run, case.checks[0].condition.upper) for case in plan.cases] == [
        ("probing-a-1-5", 0.1),
        ("probing-a-2-6", 0.2),
    ]
    for row, words in (
        (f"a,{ROW},zip,[1 | 2],[1 | 2 | 3],", "3 values"),
        (f"a,{ROW},,[1 | 2],,<= [0.1 | 0.2]", "needs `zip`"),
        (f"a,{ROW},zip,,,<= [0.1 | 0.2]", "the row has none"),
        (f"a,{ROW},zap,,,", "product, zip"),
    ):
        with pytest.raises(UserError, match=words):
            read_plan(write_plan(f"{head}\n{row}\n"))


def test_a_range_in_a_check_stays_a_condition(write_plan: PlanWriter) -> None:
    text = f"{HEAD},expand,plc:V.E.A,check:latch_mm:Z\na,{ROW},zip,[1 | 2],1 .. 2\n"
    plan = read_plan(write_plan(text))
    assert [case.checks[0].condition.upper for case in plan.cases] == [2.0, 2.0]


def test_program_rig_and_seed_can_be_lists(write_plan: PlanWriter, tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "other.nc").write_text("N10 M30\n", encoding="utf-8")
    text = f"{HEAD},seed\na,[probe.nc | sub/other.nc],machine.toml,[3 | 4]\n"
    plan = read_plan(write_plan(text))
    assert [(case.run, case.program.name, case.seed) for case in plan.cases] == [
        ("probing-a-probe.nc-3", "probe.nc", 3),
        ("probing-a-probe.nc-4", "probe.nc", 4),
        ("probing-a-sub_other.nc-3", "other.nc", 3),
        ("probing-a-sub_other.nc-4", "other.nc", 4),
    ]


def test_a_new_value_changes_no_other_id_or_seed(write_plan: PlanWriter) -> None:
    def runs(values: str) -> dict[str, int]:
        text = f"{HEAD},plc:V.E.A,repeats\na,{ROW},[{values}],2\nb,{ROW},7,1\n"
        return {case.run: case.seed for case in read_plan(write_plan(text)).cases}

    fewer, more = runs("5 | 10"), runs("5 | 7.5 | 10 | 20")
    assert len(more) == len(fewer) + 4
    assert fewer.items() <= more.items()
    assert "probing-b" in fewer  # a row without several values keeps its id
    assert "probing-a-5-001" in fewer


def test_long_and_equal_values_get_a_hash(write_plan: PlanWriter) -> None:
    long = "x" * 61
    text = f"{HEAD},plc:V.E.A\na,{ROW},[a/b | a_b | A_B | c | {long}]\n"
    runs = [case.run.removeprefix("probing-a-") for case in read_plan(write_plan(text)).cases]
    assert runs[3] == "c"
    assert all(re.fullmatch("[aA]_[bB]-[0-9a-f]{8}", run) for run in runs[:3])
    assert re.fullmatch("x{40}-[0-9a-f]{8}", runs[4])
    assert len({run.casefold() for run in runs}) == 5


SWEPT = st.text("+-*/ =%abZ019.;,ü", min_size=1, max_size=9).map(str.strip).filter(bool)


@pytest.mark.long
@given(st.sets(SWEPT.filter(lambda text: ".." not in text), min_size=2, max_size=4))
def test_every_value_makes_an_id_that_a_results_folder_takes(values: set[str]) -> None:
    """`at=motion+[10ms | 20ms]` and `+600` are values as others are."""
    texts = ["+600", "motion+10ms", *sorted(values)]
    cell = _cell(f"[{' | '.join(texts)}]")
    row = MeantRow(Place(Path("plan.csv"), 2, 1, "case"), {"plc:V.E.A": cell})
    found = list(variants(row, ["plc:V.E.A"], [], repeats=1, samples=None, seed="")[1])
    assert all(RUN_ID.fullmatch(f"plan-a-{variant.label}") for variant in found)
    assert found[0].label.startswith("_600")


def test_a_latin_hypercube_and_a_sobol_sequence_are_those_of_scipy(write_plan: PlanWriter) -> None:
    head = f"{HEAD},seed,samples,plant:p.a_mm,plant:p.b_mm,plant:p.c_mm,plc:V.E.A"
    row = f"{ROW},11,8,'lhs(0, 2)','sobol(-1, 1)','lhs(5, 6)',[1 | 2]".replace("'", '"')
    plan = read_plan(write_plan(f"{head}\na,{row}\n"))
    assert [case.run for case in plan.cases] == [
        f"probing-a-{value}-{number:03}" for value in (1, 2) for number in range(1, 9)
    ]
    cube = qmc.scale(qmc.LatinHypercube(d=2, seed=11).random(8), [0.0, 5.0], [2.0, 6.0])
    sobol = qmc.scale(qmc.Sobol(d=1, seed=11).random(8), [-1.0], [1.0])
    for cases in (plan.cases[:8], plan.cases[8:]):
        values = np.array([[float(v) for v in case.inputs.values()] for case in cases])
        assert values[:, :3] == pytest.approx(np.column_stack([cube[:, 0], sobol, cube[:, 1]]))
    assert [case.seed for case in plan.cases[:3]] == [11, 12, 13]


def test_normal_draws_once_for_each_run_from_its_seed(write_plan: PlanWriter) -> None:
    head = f"{HEAD},seed,repeats,plant:p.a_mm,plant:p.b_mm"
    text = f'{head}\na,{ROW},5,999,"normal(10, 0.5)","normal(0, 1)"\n'
    plan = read_plan(write_plan(text))
    assert [case.run for case in plan.cases[:2]] == ["probing-a-001", "probing-a-002"]
    first, second = np.array([[float(v) for v in c.inputs.values()] for c in plan.cases]).T
    # A false alarm once in 10^4 seeds; the seed is fixed
    assert kstest(first, "norm", (10.0, 0.5)).pvalue > 1e-4
    assert kstest(second, "norm").pvalue > 1e-4
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.13  # 4 sigma
    assert read_plan(write_plan(text)).cases[7].inputs == plan.cases[7].inputs
    assert plan.cases[7].inputs["plant:p.a_mm"] == draw("plant:p.a_mm", 10.0, 0.5, 12)


def test_too_many_runs_are_refused_before_they_are_made(write_plan: PlanWriter) -> None:
    big = "1 .. 1000 step 1"
    for row in (f"a,{ROW},{big},{big},1", f"a,{ROW},{big},1,999"):
        path = write_plan(f"{HEAD},plc:V.E.A,plc:V.E.B,repeats\n{row}\n")
        with pytest.raises(UserError, match=f"more than {RUNS_MAX}"):
            read_plan(path)


def test_a_value_with_a_unit_is_checked_in_every_run(write_plan: PlanWriter) -> None:
    with pytest.raises(UserError, match="not a number") as caught:
        read_plan(write_plan(f"{HEAD},plant:p.a_mm\na,{ROW},[1 | two]\n"))
    assert (caught.value.column, caught.value.value) == (4, "two")


def test_a_list_in_place_of_a_condition_is_read_as_one_where_nothing_goes_together() -> None:
    assert parse_cell(_cell("== [[done]", "check:msg:N10"), is_condition=True).filled(()) == (
        "== [done]"
    )


def test_the_expanded_plan_is_a_plan_with_the_same_runs(write_plan: PlanWriter) -> None:
    head = f"{HEAD},title,tags,seed,repeats,samples"
    head += ",plc:V.E.A,plant:p.x_mm,plant:p.y_mm,check:latch_mm:Z"
    plan = read_plan(
        write_plan(
            f'{head}\na,{ROW},"T, t",x y,3,2,4,[1 | 2],"lhs(0, 1)",,<= 3\n'
            + f'b,{ROW},,,,2,,[[v],,"normal(1, 1)",\n'
        )
    )
    again = read_plan(write_plan(expanded_text(plan)))
    for case, other in zip(plan.cases, again.cases, strict=True):
        same = ("run", "seed", "inputs", "title", "tags", "program", "rig")
        assert [getattr(case, name) for name in same] == [getattr(other, name) for name in same]
        assert [(c.metric, c.condition) for c in case.checks] == [
            (c.metric, c.condition) for c in other.checks
        ]


@pytest.mark.parametrize(
    ("column", "cell", "hint"),
    [
        ("plant:p.x_um", "600,5", "a decimal point, not a comma: 600.5"),
        ("plant:p.x_um", "[300 600]", r"a list with bars: \[300 \| 600\]"),
        ("plant:p.x_um", "300:3000:300", "with its step: 300 .. 3000 step 300"),
        ("plant:p.x_um", "-2:2:4", "with its step: -2 .. 2 step 4"),  # the last one comes first
        ("plant:p.x_um", "2:9:4", "with its step: 300 .. 3000 step 300"),  # it leads nowhere
        ("plant:p.x_um", "300:300:3000", "with its step: 300 .. 3000 step 300"),
        ("plant:p.x_um", "3:-1:-1", "with its step: 3 .. -1 step -1"),
        ("plant:p.x_um", "1:2:0", "with its step: 300 .. 3000 step 300"),
        ("plant:p.x_um", "x1", None),
        ("plant:p.x_um", "100mm", r"write 100, in the unit of the header \(um\)"),
        ("plant:p.x", "100mm", "write 100; the unit ends the header: plant:p.x_mm"),
        ("plant:p.x", "100 mm/min", "write 100; the unit ends the header: plant:p.x_mm_min"),
        ("plant:p.x", "1.5 furlongs", "write 1.5; the unit ends the header: plant:p.x_<unit>"),
        ("plc:V.E.FEED", "600 mm/min", "write 600 without a unit"),
        ("plant:p.x_um", "high", None),
    ],
)
def test_what_looks_like_a_number_gets_a_hint(
    write_plan: PlanWriter, column: str, cell: str, hint: str | None
) -> None:
    text = f'{HEAD},{column}\na,{ROW},"{cell}"\n'
    path = write_plan(text)
    with pytest.raises(UserError, match="not a number") as caught:
        read_plan(path).cases[0].assignments()[0].si()
    found = caught.value.hint
    assert found is None if hint is None else re.search(hint, found or "")


def test_the_command_line_cannot_set_what_the_plan_sweeps(write_plan: PlanWriter) -> None:
    plan = read_plan(write_plan(f"{HEAD},plc:V.E.A\na,{ROW},[1 | 2]\n"))
    with pytest.raises(UserError, match="several values"):
        plan.with_inputs([parse_assignment("plc:V.E.A=3")])


def test_the_command_line_sets_what_only_rows_sweep_that_are_not_chosen(
    write_plan: PlanWriter,
) -> None:
    text = f"{HEAD},plc:V.E.A,search:plc:V.E.B,check:overtravel_mm\n"
    text += f"swept,{ROW},[1 | 2],,\nsought,{ROW},,1 .. 9 to 1,<= 1\nplain,{ROW},7,,\n"
    plan = read_plan(write_plan(text))
    given = [parse_assignment("plc:V.E.A=3"), parse_assignment("plc:V.E.B=4")]
    found = [case.inputs for case in plan.with_inputs(given, "plain").cases]
    a, b = "plc:V.E.A", "plc:V.E.B"
    assert found == [{a: "1", b: "4"}, {a: "2", b: "4"}, {a: "3"}, {a: "3", b: "4"}]
    for select, column in (("swept", a), ("sought or plain", b)):
        with pytest.raises(UserError, match=f"--set {column}: the plan gives this column several"):
            plan.with_inputs(given, select)


def test_list_with_semicolons_shows_its_bars(write_plan: PlanWriter) -> None:
    path = write_plan(f"{HEAD},plc:V.E.FEED\na,{ROW},[300; 600.5; -1]\n")
    with pytest.raises(UserError, match=r"bars: \[300 \| 600\.5 \| -1\]"):
        read_plan(path)


@pytest.mark.parametrize(
    "counts", [[3] * 10, [2, 3], [4, 3, 2, 2, 2], [2] * 15, [3, 1, 2], [7, 2, 5]]
)
def test_pairwise_holds_every_pair_of_values_in_few_rows(counts: list[int]) -> None:
    rows = pairwise(counts)
    for first, second in itertools.combinations(range(len(counts)), 2):
        pairs = {(row[first], row[second]) for row in rows}
        assert pairs == set(itertools.product(range(counts[first]), range(counts[second])))
    largest = sorted(counts)[-2:]
    assert math.prod(largest) <= len(rows) <= min(math.prod(counts), 3 * math.prod(largest))
    assert rows == pairwise(counts)


def test_pairwise_of_one_column_holds_each_of_its_values(write_plan: PlanWriter) -> None:
    assert pairwise([]) == []
    assert pairwise([3]) == [(0,), (1,), (2,)]
    head = "case,program,rig,plc:V.E.A,plc:V.E.B"
    plan = read_plan(write_plan(f"{head}\na,probe.nc,machine.toml,pairwise(1 | 2 | 3),[7 | 8]\n"))
    found = [(case.inputs["plc:V.E.A"], case.inputs["plc:V.E.B"]) for case in plan.cases]
    assert sorted(found) == [(a, b) for a in "123" for b in "78"]


def test_cells_of_pairwise_give_runs_with_each_pair(write_plan: PlanWriter) -> None:
    columns = {"a": ["1", "2", "3"], "b": ["10", "20", "30"], "c": ["5", "6"]}
    cells = [f"pairwise({' | '.join(values)})" for values in columns.values()]
    header = ",".join(f"plant:p.{name}_um" for name in columns)
    path = write_plan(f"{HEAD},{header},repeats\nx,{ROW},{','.join(cells)},2\n")
    cases = read_plan(path).cases
    inputs = [tuple(case.swept.values()) for case in cases[::2]]
    assert len(cases) == 2 * len(set(inputs)) < 2 * 3 * 3 * 2
    for (i, one), (j, other) in itertools.combinations(enumerate(columns.values()), 2):
        assert {(row[i], row[j]) for row in inputs} == set(itertools.product(one, other))


def test_pairs_are_one_list_beside_the_others(write_plan: PlanWriter) -> None:
    header = "plant:p.a_um,plant:p.b_um,plant:p.c_um"
    cells = 'pairwise(1 | 2),[7 | 8 | 9],"pairwise(boundary(0, 10, 2))"'
    cases = read_plan(write_plan(f"{HEAD},{header}\nx,{ROW},{cells}\n")).cases
    found = [tuple(case.swept.values()) for case in cases]
    wanted = set(itertools.product("12", "789", ["0", "2", "5", "8", "10"]))
    assert len(found) == len(wanted)
    assert set(found) == wanted


def test_pairs_count_where_their_first_list_stands(write_plan: PlanWriter) -> None:
    """The last list changes first: that in the middle, as the pairs begin before it."""
    header = "plant:p.a_um,plant:p.b_um,plant:p.c_um"
    cells = "pairwise(1 | 2),[7 | 8 | 9],pairwise(3 | 4)"
    cases = read_plan(write_plan(f"{HEAD},{header}\nx,{ROW},{cells}\n")).cases
    found = [tuple(case.swept.values()) for case in cases]
    pairs = [(a, c) for a, _b, c in found[::3]]
    assert sorted(pairs) == list(itertools.product("12", "34"))
    assert found == [(a, b, c) for a, c in pairs for b in "789"]


@pytest.mark.parametrize(
    ("cell", "values"),
    [
        ("boundary(300, 3000, 1)", ["300", "301", "1650", "2999", "3000"]),
        ("boundary(-1, 1, 0.25)", ["-1", "-0.75", "0", "0.75", "1"]),
        ("boundary(0, 2, 1)", ["0", "1", "2"]),
    ],
)
def test_boundary_values(write_plan: PlanWriter, cell: str, values: list[str]) -> None:
    cases = read_plan(write_plan(f'{HEAD},plant:p.x_um\na,{ROW},"{cell}"\n')).cases
    assert [case.inputs["plant:p.x_um"] for case in cases] == values


@pytest.mark.parametrize(
    ("cell", "expand", "message"),
    [
        ("boundary(0, 1, 0)", "", "a step above 0 that fits in twice"),
        ("boundary(0, 1, 0.6)", "", "a step above 0 that fits in twice"),
        ("boundary(1, 0, 0.1)", "", "a step above 0 that fits in twice"),
        ("boundary(0, 1)", "", "boundary needs 3 numbers"),
        ("pairwise(1)", "", "holds several values"),
        ("pairwise()", "", "holds several values"),
        ("pairwise(normal(0, 1))", "", "holds several values"),
        ("pairwise(pairwise(1))", "", "holds several values"),
        ("pairwise(1 | 1)", "", "twice in the list"),
        ("pairwise(1 | 2)", "zip", "with pairwise"),
    ],
)
def test_pairs_and_boundaries_that_cannot_be(
    write_plan: PlanWriter, cell: str, expand: str, message: str
) -> None:
    path = write_plan(f'{HEAD},expand,plant:p.x_um\na,{ROW},{expand},"{cell}"\n')
    with pytest.raises(UserError, match=message):
        read_plan(path)


def test_too_many_pairs_are_refused_before_they_are_looked_for(write_plan: PlanWriter) -> None:
    cell = "pairwise(1 .. 1000 step 1)"
    path = write_plan(f"{HEAD},plant:p.x_um,plant:p.y_um\na,{ROW},{cell},{cell}\n")
    with pytest.raises(UserError, match="1000000 runs are more than 100000"):
        read_plan(path)
