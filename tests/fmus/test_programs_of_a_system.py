"""All programs of one model as a system, from a representation that is written down.

State x = y[0], z = y[1]; k = p[0], n = p[1] with pre(n) = p[2], m = p[3] with pre(m) = p[4]; what
the compiler keeps for itself from p[5] on. Slots of this exporter begin at p[20].
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.equations import system as systems
from axisrig.fmus.equations.actions import START_TOLERANCE
from axisrig.fmus.equations.events import Row
from axisrig.fmus.equations.system import System, _Reader
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import (
    ONE,
    TIME,
    Expr,
    apply,
    const,
    parameter,
    variable,
)
from axisrig.fmus.reading.ir import Ir, Source

X, Z = variable(0), variable(1)
P = [parameter(number) for number in range(30)]
TEXT = "\n" * 50
OWN = 20
Ops = list[dict[str, Any]]


def ops(value: Expr, into: int = 0) -> Ops:
    """Register code of an expression, in the form of a plan."""
    made: Ops = []

    def register(e: Expr) -> int:
        parts = [register(arg) for arg in e.args]
        dst = len(made)
        if e.kind == "const":
            made.append({"kind": "Const", "value": e.value, "value_class": "finite", "dst": dst})
        elif e.kind == "time":
            made.append({"kind": "LoadTime", "dst": dst})
        elif e.kind in ("y", "p"):
            made.append({"kind": f"Load{e.kind.upper()}", "index": e.index, "dst": dst})
        else:
            kind = "Unary" if len(parts) == 1 else "Compare" if e.logical else "Binary"
            names = ("arg",) if len(parts) == 1 else ("lhs", "rhs")
            operands = dict(zip(names, parts, strict=True))
            made.append({"kind": kind, "operator": e.kind, **operands, "dst": dst})
        return dst

    src = register(value)
    return [*made, {"kind": "StoreOutput", "src": src, "output_index": into}]


def plan(*values: Expr | tuple[int, Expr], line: int = 1) -> dict[str, Any]:
    """A program for each value, on a line of its own; the first of a pair is its output."""
    pairs = [one if isinstance(one, tuple) else (n, one) for n, one in enumerate(values)]
    programs = [
        {"span": {"source": 1, "start": line + n - 1}, "output_count": 1, "ops": ops(value, into)}
        for n, (into, value) in enumerate(pairs)
    ]
    return {"programs": programs, "output_count": len(programs)}


def raw(value: Expr, *indices: int) -> dict[str, Any]:
    """A node of the start: the same code in the compiler's own form."""
    program = []
    for op in ops(value):
        own = {k: v for k, v in op.items() if k not in ("kind", "value_class", "output_index")}
        if "operator" in own:
            own["op"] = own.pop("operator")
        program.append({op["kind"]: own})
    return {"ScalarPrograms": {"programs": [program], "output_indices": list(indices),
                               "program_spans": [{"source": 1, "start": indices[0]}]}}  # fmt: skip


def slots(*targets: Expr) -> list[dict[str, Any]]:
    return [{one.kind.upper(): {"index": one.index}} for one in targets]


def model(**changes: Any) -> Ir:
    """x' = 1 and z = 2 x, and what is changed: the path of a part of the solve representation."""
    names = {"x": X, "z": Z, "k": P[0], "n": P[1], "m": P[3]}
    solve: dict[str, Any] = {
        "layout": {
            "bindings": dict(zip(names, slots(*names.values()), strict=True)),
            "p_scalars": OWN, "y_scalars": 2,
        },
        "solve_layout": {
            "state_scalar_count": 1, "initial_homotopy_parameter_index": None,
            "initial_event_parameter_index": 9, "solver_maps": {"names": ["x", "z"]},
            "pre_param_bindings": [
                {"dest_p_index": 2, "source": slots(P[1])[0]},
                {"dest_p_index": 4, "source": slots(P[3])[0]},
            ],
        },
        "continuous": {
            "derivative_rhs": {"scalar_plan": plan(ONE)},
            "implicit_row_targets": slots(Z),
            "implicit_rhs": {"scalar_plan": plan(apply("Sub", Z, apply("Mul", const(2.0), X)))},
        },
        "discrete": {
            "update_targets": [], "rhs_plan": plan(), "guarded_assignment_plan": plan(),
            "runtime_assignment_plan": plan(), "runtime_assignment_targets": [],
        },
        "initialization": {
            "update_plan": plan(), "update_targets": [], "residual": {"nodes": []},
            "projection_plan": {"blocks": []}, "row_roles": [],
        },
        "events": {
            "root_relation_memory_targets": [], "root_conditions": {"program_spans": []},
            "root_zero_domains": [], "root_plan": plan(), "action_plan": plan(), "actions": [],
        },
        "clocks": {"activation_parameter_indices": []},
    }  # fmt: skip
    for path, value in changes.items():
        first, last = path.split("__")
        solve[first][last] = value
    empty = {"conditions": {"conditions": []}, "clocks": {"ownerships": [], "clocks": []},
             "discrete_values": {"owners": []}, "discrete_real": {"residuals": []}}  # fmt: skip
    both = {"scalar_names": ["x", "z"], "attributes": {"binding": None}, "role": "state"}
    dae = {"functions": [], "expressions": [], "domains": [], "value_types": [],
           "variables": [both], "systems": empty}  # fmt: skip
    return Ir("M", solve, dae, {}, {1: (Path("/lib/M.mo"), TEXT)}, Path("/lib"))


def system(**changes: Any) -> System:
    return _Reader(model(**changes)).read()


def targets(rows: Sequence[Row]) -> list[tuple[str, int, Expr]]:
    return [(row.vector, row.index, row.value) for row in rows]


# Rows


def test_rows_have_the_targets_of_their_outputs_in_whatever_order_they_come() -> None:
    one, two = apply("Add", P[0], ONE), apply("Add", P[0], const(2.0))
    found = system(
        discrete__runtime_assignment_plan=plan((1, two), (0, one)),
        discrete__runtime_assignment_targets=slots(P[3], P[1]),
    ).runtime
    assert targets(found) == [("p", 3, one), ("p", 1, two)]
    assert [row.place for row in found] == [Source("M.mo", 2), Source("M.mo", 1)]


def test_equations_of_named_variables_are_updates_and_all_others_conditions() -> None:
    """Behind them come the targets of when-clauses and of reinit()."""
    values = [apply("Mul", P[0], const(float(n))) for n in range(2, 6)]
    found = system(
        discrete__rhs_plan=plan(*values[:2]), discrete__guarded_assignment_plan=plan(*values[2:]),
        discrete__update_targets=slots(P[7], P[1], P[3], X),
    )  # fmt: skip
    assert targets(found.updates) == [("p", 1, values[1])]
    assert targets(found.conditions) == [("p", 7, values[0])]
    assert targets(found.whens) == [("p", 3, values[2])]
    assert targets(found.reinits) == [("y", 0, values[3])]
    assert found.previous == [(2, "p", 1), (4, "p", 3)]
    assert (found.y_count, found.state_count, found.initial_flag) == (2, 1, 9)


def test_a_when_clause_holds_what_its_variable_was_before() -> None:
    value = apply("Add", P[3], P[1])
    found = system(
        discrete__guarded_assignment_plan=plan(value), discrete__update_targets=slots(P[3])
    )
    assert targets(found.whens) == [("p", 3, apply("Add", P[4], P[1]))]


@pytest.mark.parametrize("slot", [6, 0])
def test_homotopy_is_its_first_argument(slot: int) -> None:
    mixed = apply("Add", apply("Mul", P[slot], P[5]), P[1])
    plain = apply("Add", apply("Mul", ONE, P[5]), P[1])
    given = {"discrete__runtime_assignment_plan": plan(mixed),
             "discrete__runtime_assignment_targets": slots(P[3])}  # fmt: skip
    assert system(**given).runtime[0].value == mixed
    (row,) = system(solve_layout__initial_homotopy_parameter_index=slot, **given).runtime
    assert row.value in (plain, Expr("Add", (Expr("Mul", (ONE, P[5])), P[1])))


# Memories


def test_whole_parts_and_comparisons_of_the_time_have_a_memory_but_not_in_when_clauses() -> None:
    """A when-clause keeps its floor(): it is computed at its own instant. Both compare the time."""
    whole, late = apply("Floor", X), apply("Gt", TIME, P[0])
    for name, rows, values, kinds in (
        ("rhs_plan", "updates", [P[OWN], P[OWN + 1]], ["WHOLE_BELOW", "ZERO_IS_FALSE"]),
        ("guarded_assignment_plan", "whens", [whole, P[OWN]], ["ZERO_IS_FALSE"]),
    ):
        found = system(
            **{f"discrete__{name}": plan(whole, late)}, discrete__update_targets=slots(P[1], P[3])
        )
        assert [row.value for row in getattr(found, rows)] == values
        assert [relation.kind for relation in found.relations] == kinds
        assert found.relations[-1].function == apply("Sub", P[0], TIME)
        assert found.p_count == OWN + len(kinds)
    (row,) = system(
        discrete__guarded_assignment_plan=plan(whole), discrete__update_targets=slots(X)
    ).reinits
    assert row.value is whole


def test_derivatives_and_algebraic_equations_jump_where_a_memory_says_so() -> None:
    found = system(
        continuous__derivative_rhs={"scalar_plan": plan(apply("Floor", X))},
        continuous__implicit_rhs={"scalar_plan": plan(apply("Sub", Z, apply("Ceil", X)))},
    )
    kinds = {parameter(relation.memory): relation.kind for relation in found.relations}
    assert kinds[found.derivatives[0].value] == "WHOLE_BELOW"
    assert kinds[found.algebraics[0].value] == "WHOLE_ABOVE"


# Relations


def relations(*values: Expr, spans: Sequence[Any] = (), domains: str = "NonPositive") -> System:
    return system(
        events__root_plan=plan(*values, line=11),
        events__root_relation_memory_targets=slots(*P[10 : 10 + len(values)]),
        events__root_conditions={"program_spans": list(spans)},
        events__root_zero_domains=[domains] * len(values),
    )


def test_relations_of_the_compiler_come_before_those_of_the_exporter() -> None:
    found = system(
        events__root_plan=plan(apply("Sub", X, P[0]), apply("Sub", X, P[1])),
        events__root_relation_memory_targets=slots(P[12], P[11]),
        events__root_zero_domains=["Positive", "Previous"],
        discrete__runtime_assignment_plan=plan(apply("Floor", X)),
        discrete__runtime_assignment_targets=slots(P[3]),
    ).relations
    assert [(one.memory, one.kind) for one in found] == [
        (12, "ZERO_IS_FALSE"), (11, "ZERO_KEEPS"), (OWN, "WHOLE_BELOW"),
    ]  # fmt: skip


def test_marks_of_whole_numbers_are_no_relations_and_places_are_those_of_the_conditions() -> None:
    mark = Expr("Sub", (const(0.0), Expr("Sin", (Expr("Mul", (const(math.pi), X)),))))
    plain = [apply("Sub", X, P[n]) for n in (0, 1)]
    spans = [{"source": 1, "start": n} for n in (29, 30, 31)]
    found = relations(plain[0], mark, plain[1], spans=spans).relations
    assert [(one.function, one.memory) for one in found] == [(plain[0], 10), (plain[1], 12)]
    assert [one.place for one in found] == [Source("M.mo", 30), Source("M.mo", 32)]
    found = relations(plain[0], mark, plain[1], spans=spans[:2]).relations
    assert [one.place for one in found] == [Source("M.mo", 11), Source("M.mo", 13)]
    with pytest.raises(BuildError, match="zero domain Odd of a relation is not known") as error:
        relations(plain[0], domains="Odd")
    assert error.value.line == 11


# Actions


def with_actions(*kinds: str, clock: int | None = None) -> Ir:
    """A model with actions: each at its own line, with the value of x in its message."""
    message = {"parts": [{"Text": "x = "}, {"Conversion": {
        "source": "Real", "format": {"Options": {}},
        "value": [{"LoadY": {"index": 0, "dst": 0}}, {"StoreOutput": {"src": 0}}],
    }}]}  # fmt: skip
    given = [
        {"kind": kind, "message": message, "clock_owner": clock,
         "span": {"source": 1, "start": 30 + n}}
        for n, kind in enumerate(kinds)
    ]  # fmt: skip
    return model(
        events__action_plan=plan(*[apply("Lt", X, P[0])] * len(kinds)), events__actions=given
    )


def test_an_action_is_checked_like_a_relation_and_warnings_remember_that_they_were_given() -> None:
    read = _Reader(with_actions("Assert", "Warning", "Terminate", "Warning")).read()
    found, (relation,) = read.actions, read.relations
    assert relation.function == apply("Sub", X, P[0])
    assert [one.kind for one in found] == ["assert", "warning", "terminate", "warning"]
    assert [one.condition for one in found] == [parameter(relation.memory)] * 4
    assert [one.memory for one in found] == [-1, OWN + 1, -1, OWN + 2]
    assert [one.place for one in found] == [Source("M.mo", 31 + n) for n in range(4)]
    assert {(one.text, tuple(one.values)) for one in found} == {("x = %.6g", (("Real", X),))}
    assert read.p_count == OWN + 3


@pytest.mark.parametrize("clock", [0, 1])
def test_an_assertion_that_waits_for_a_clock_holds_at_its_instants(clock: int) -> None:
    """The flag of clock 0 is p[25], that of clock 1 is p[26]."""
    reader: Any = _Reader(with_actions("Assert", clock=clock))
    reader._clocks.of_clock.update({0: 25, 1: 26})
    read = reader.read()
    (found,), (relation,) = read.actions, read.relations
    assert found.condition == apply("And", P[25 + clock], parameter(relation.memory))
    other: Any = _Reader(with_actions("Assert", clock=clock))
    other._clocks.of_clock[1 - clock] = 25
    with pytest.raises(BuildError, match="waits for several clocks") as error:
        other.read()
    assert error.value.line == 31


def test_an_action_that_is_not_known_is_named_with_its_line() -> None:
    with pytest.raises(BuildError, match=r"^M\.mo:32: Pause is not supported$"):
        _Reader(with_actions("Assert", "Pause")).read()


# The start


def test_the_start_has_parameters_that_follow_and_what_they_need() -> None:
    """n = z + k and m = 3 k; z = 2 x comes along, so that it is there before n."""
    found = system(
        initialization__update_plan=plan(apply("Mul", const(3.0), P[0]), apply("Add", Z, P[0])),
        initialization__update_targets=slots(P[3], P[1]),
    ).initial
    assert sorted(targets(found), key=lambda row: row[:2]) == [
        ("p", 1, apply("Add", Z, P[0])), ("p", 3, apply("Mul", const(3.0), P[0])),
        ("y", 1, apply("Mul", const(2.0), X)),
    ]  # fmt: skip
    places = [row[:2] for row in targets(found)]
    assert places.index(("y", 1)) < places.index(("p", 1))
    alone = system(
        initialization__update_plan=plan(P[0]), initialization__update_targets=slots(P[3])
    )
    assert targets(alone.initial) == [("p", 3, P[0])]


def start(roles: Sequence[str], blocks: Sequence[Mapping[str, Any]]) -> System:
    """Rows 5 and 3 of the residual: x - k = 0 and n - 2 x = 0."""
    nodes = [raw(apply("Sub", X, P[0]), 5),
             raw(apply("Sub", P[1], apply("Mul", const(2.0), X)), 3)]  # fmt: skip
    return system(
        initialization__residual={"nodes": nodes}, initialization__row_roles=list(roles),
        initialization__projection_plan={"blocks": list(blocks)},
    )  # fmt: skip


def test_equations_of_the_start_are_assigned_by_their_rows() -> None:
    for blocks in (
        [{"rows": [5, 3], "unknowns": slots(X, P[1])}],
        [{"rows": [3], "unknowns": slots(P[1])}, {"rows": [5], "unknowns": slots(X)}],
    ):
        found = start(["Solved"] * 6, blocks).initial
        assert targets(found) == [("y", 0, P[0]), ("p", 1, apply("Mul", const(2.0), X))]
        assert [row.place for row in found] == [Source("M.mo", 6), Source("M.mo", 4)]


def test_what_decides_nothing_at_the_start_has_to_agree() -> None:
    roles = ["Solved", "Solved", "Solved", "Surplus", "SolvedThroughAlgebraicRefresh", "Solved"]
    (check,) = start(roles, [{"rows": [5], "unknowns": slots(X)}]).actions
    residual = apply("Sub", P[1], apply("Mul", const(2.0), X))
    assert check.condition == apply("Gt", apply("Abs", residual), const(START_TOLERANCE))
    assert (check.at_start, check.place) == (True, Source("M.mo", 4))
    assert start(["Solved"] * 6, []).actions == []


@pytest.mark.parametrize("order", [1, -1])
def test_a_parameter_inside_follows_the_one_around_it_at_the_start(order: int) -> None:
    """Both have the number of one modifier: a.b.m = p[3] follows a.m = p[0]."""
    ir = model()
    names = {"a.m": P[0], "a.b.m": P[3]}
    bindings = ir.solve["layout"]["bindings"]
    bindings |= dict(zip(names, slots(*names.values()), strict=True))
    ir.dae["expressions"].append(
        {"variability": "constant", "provenance": {"span": {"source": 1, "start": 24}},
         "operation": {"kind": "literal", "value": {"real": 5.0}}}
    )  # fmt: skip
    ir.dae["variables"].extend([
        {"name": name, "scalar_names": [name], "role": "parameter", "declaration": {},
         "attributes": {"binding": 0}, "value_type": {"dimensions": []}}
        for name in list(names)[::order]
    ])  # fmt: skip
    found = _Reader(ir).read().initial
    assert targets(found) == [("p", 3, P[0])]
    assert found[0].place == Source("M.mo", 25)


# What is refused


def test_of_several_variables_without_an_equation_the_first_is_named() -> None:
    ir = model()
    ir.solve["layout"]["y_scalars"] = 4
    ir.solve["solve_layout"]["solver_maps"]["names"] += ["v", "w"]
    with pytest.raises(BuildError, match=r"no equation for v$"):
        _Reader(ir).read()


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("continuous__derivative_rhs", {"scalar_plan": plan(ONE)}),
        ("discrete__rhs_plan", plan(ONE)),
        ("events__root_plan", plan(ONE)),
    ],
)
def test_an_operation_that_is_not_known_is_refused_at_its_line(path: str, value: Any) -> None:
    programs = value.get("scalar_plan", value)["programs"]
    programs[0] |= {"ops": [{"kind": "Miracle", "dst": 0}], "span": {"source": 1, "start": 7}}
    with pytest.raises(BuildError) as error:
        system(**{path: value}, discrete__update_targets=slots(P[1]))
    assert str(error.value) == "M.mo:8: the operation Miracle of the compiler is not supported"


def test_a_start_of_another_form_is_refused() -> None:
    block = {"rows": [0], "unknowns": slots(X)}
    with pytest.raises(BuildError, match="a residual of the form Tensor is not supported"):
        system(initialization__residual={"nodes": [{"Tensor": {}}]},
               initialization__projection_plan={"blocks": [block]})  # fmt: skip


def test_a_function_that_is_too_deep_is_refused_at_its_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def too_deep(*_: object) -> Any:
        raise RecursionError

    monkeypatch.setattr(systems, "Functions", lambda _ir: SimpleNamespace(call=too_deep))
    call = {"kind": "PureCall", "owner": 0, "input_starts": [], "dst_start": 0}
    program = {"span": {"source": 1, "start": 11}, "output_count": 1, "ops": [call]}
    with pytest.raises(BuildError) as error:
        system(discrete__runtime_assignment_plan={"programs": [program], "output_count": 1},
               discrete__runtime_assignment_targets=slots(P[3]))  # fmt: skip
    assert str(error.value) == "M.mo:12: a function is too long"
