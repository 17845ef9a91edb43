"""Which sample() each discrete variable waits for, and its start and interval from parameters.

Nothing is compiled: clocks, conditions and equations as rumoca 0.10.2 describes them.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from axisrig.fmus.equations.clocks import Clocks, Schedule, read_clocks
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import Expr, apply, const, parameter
from axisrig.fmus.reading.ir import Ir

FIRST = 40
"""The slot of the first flag."""
TS, T2 = parameter(5), parameter(6)
SLOTS = {"ts": 5, "t2": 6}


class Model:
    """A model M of samples and of variables that wait for them; each sample has its own line."""

    def __init__(self, *samples: str, **slots: int) -> None:
        self.lines = ["// " + 40 * "\u00e4", "model M"]
        self.clocks: list[Any] = []
        self.conditions: list[Any] = []
        self.variables: list[Any] = []
        self.expressions: list[Any] = []
        self.ownerships: list[Any] = []
        self.owners: list[Any] = []
        self.residuals: list[Any] = []
        self.bindings: dict[str, Any] = {
            name.replace("_", "."): {"P": {"index": slot}} for name, slot in slots.items()
        }
        for text in samples:
            self.sample(text)

    def _span(self, text: str) -> dict[str, int]:
        """The place of a text in a line of its own."""
        start = len("\n".join([*self.lines, ""]).encode())
        self.lines.append(text)
        return {"source": 1, "start": start, "end": start + len(text.encode())}

    def sample(self, text: str, clock: int | None = None, **times: str) -> int:
        """One more sample(), of a clock of its own unless another one's is given."""
        if clock is None:
            clock = len(self.clocks)
            lattice = {
                name: {"num": Fraction(time).numerator, "den": Fraction(time).denominator}
                for name, time in ({"phase": "0", "period": "1/1000"} | times).items()
            }
            operation = {"kind": "periodic", "anchor": "absolute", "lattice": lattice}
            self.clocks.append({"operation": operation})
        return self.condition("clock", span=self._span(text), clock=clock)

    def condition(self, kind: str, span: Any = None, **parts: int) -> int:
        provenance = {} if span is None else {"span": span}
        self.conditions.append({"operation": {"kind": kind, **parts}, "provenance": provenance})
        return len(self.conditions) - 1

    def variable(
        self, name: str, slot: int, clock: int = 0, *, elements: int = 0, vector: str = "P",
        sampled: bool = False,
    ) -> int:  # fmt: skip
        """A variable that some clock owns."""
        names = [f"{name}[{k + 1}]" for k in range(elements)] or [name]
        declaration = {"span": self._span(f"Integer {name};")}
        self.variables.append({"name": name, "scalar_names": names, "declaration": declaration})
        for number, one in enumerate(names):
            self.bindings[one] = {vector: {"index": slot + number}}
        variable = len(self.variables) - 1
        owned = {"variable": variable, "sampled": sampled, "clock": clock}
        self.ownerships.append(owned)
        return variable

    def waits(self, variable: int, *triggers: int, kind: str = "when") -> None:
        branches = [{"activation": {"kind": kind, "trigger": trigger}} for trigger in triggers]
        self.owners.append({"targets": [variable], "branches": branches})

    def expression(self, kind: str, **parts: Any) -> int:
        self.expressions.append({"operation": {"kind": kind, **parts}})
        return len(self.expressions) - 1

    def counter(self, name: str, slot: int, clock: int = 0, **options: Any) -> int:
        """A variable that waits for the condition of the same number as its clock."""
        variable = self.variable(name, slot, clock, **options)
        self.waits(variable, clock)
        return variable

    def read(self) -> Clocks:
        systems = {
            "clocks": {"ownerships": self.ownerships, "clocks": self.clocks},
            "conditions": {"conditions": self.conditions},
            "discrete_values": {"owners": self.owners},
            "discrete_real": {"residuals": self.residuals},
        }
        dae = {
            "systems": systems, "variables": self.variables, "expressions": self.expressions,
        }  # fmt: skip
        own = [100 + number for number in range(len(self.clocks))]
        solve = {
            "layout": {"bindings": self.bindings},
            "clocks": {"activation_parameter_indices": own},
        }
        files = {1: (Path("/lib/M.mo"), "\n".join([*self.lines, "end M;\n"]))}
        return read_clocks(Ir("M", solve, dae, {}, files, Path("/lib")), FIRST)

    def refusal(self) -> str:
        with pytest.raises(BuildError) as caught:
            self.read()
        return str(caught.value)


def times(found: Schedule) -> tuple[Expr, Expr]:
    return found.offset, found.interval


# Start and interval


@pytest.mark.parametrize(
    ("text", "start", "interval"),
    [
        ("sample(0, ts)", const(0.0), TS), ("sample(ts, 0.25)", TS, const(0.25)),
        ("sample(ts, ts)", TS, TS), ("sample(ts, t2)", TS, T2),
        ("sample(ts/2, ts)", apply("Div", TS, const(2.0)), TS),
        ("sample(2*ts, t2)", apply("Mul", const(2.0), TS), T2),
        ("sample(ts + t2, ts)", apply("Add", TS, T2), TS),
        ("sample(0, t2 - ts)", const(0.0), apply("Sub", T2, TS)),
        ("sample(-ts, ts)", apply("Neg", TS), TS),
        ("sample(ts - t2 - 1, ts)", apply("Sub", apply("Sub", TS, T2), const(1.0)), TS),
        ("sample(ts - (t2 - 1), ts)", apply("Sub", TS, apply("Sub", T2, const(1.0))), TS),
        ("sample(1e-3, ts*(1 + t2))", const(1e-3),
         apply("Mul", TS, apply("Add", const(1.0), T2))),
        ("sample  (  0 ,ts )", const(0.0), TS),
        ("sample(0, /* s, ms */ ts)", const(0.0), TS),
        ("sample(0, // in s, ms\n ts)", const(0.0), TS),
    ],
)  # fmt: skip
def test_start_and_interval_follow_parameters_as_they_are_written(
    text: str, start: Expr, interval: Expr
) -> None:
    model = Model(text, **SLOTS)
    model.counter("n", 7)
    (found,) = model.read().schedules
    assert times(found) == (start, interval)
    assert found.grid is None
    assert str(found.place) == "M.mo:3"


@pytest.mark.parametrize(
    ("phase", "period", "grid"),
    [("0", "1/1000", (0, 1, 1000)), ("1/4", "1/2", (1, 2, 4)), ("3", "2", (3, 2, 1))],
)
def test_numbers_are_whole_numbers_of_a_divisor(
    phase: str, period: str, grid: tuple[int, int, int]
) -> None:
    model = Model(**SLOTS)
    model.sample("sample(some, other)", phase=phase, period=period)
    model.counter("n", 7)
    (found,) = model.read().schedules
    assert found.grid == grid
    assert times(found) == (const(float(Fraction(phase))), const(float(Fraction(period))))


@pytest.mark.parametrize(
    "text",
    ["sample(0, sqrt(ts))", "sample(ts)", "sample(0, ts, 1)", "sample(0, ts^2)", "sample(0, +ts)",
     "sample(0, ts[1])", "sample(0, if ts > 1 then ts else 1)", "sample(0, ts",
     "clock(ts)", 'sample(0, "ts" + ts)', "sample(other, ts)"],
)  # fmt: skip
def test_any_other_time_that_names_a_parameter_is_refused_with_its_line(text: str) -> None:
    model = Model("sample(0, 1)", text, **SLOTS)
    model.counter("n", 7, 1)
    words = "start and interval must be numbers, parameters and + - * / of them"
    assert model.refusal() == f"M.mo:4: {text}: {words}"


@pytest.mark.parametrize(
    ("owner", "slots", "slot"),
    [
        ("n", {"ts": 5}, 5), ("a.n", {"ts": 5}, 5), ("a.n", {"a_ts": 6}, 6),
        ("a.b.n", {"a_b_ts": 7}, 7), ("a.b.n", {"a_ts": 6}, 6), ("a.b.n", {"ts": 5}, 5),
        # Not of another component, nor of one below
        ("a.n", {"a_ts": 6, "b_ts": 8}, 6), ("a.n", {"a_ts": 6, "a_b_ts": 8}, 6),
        ("n", {"ts": 5, "n_ts": 8}, 5), ("a.b.n", {"a_b_ts": 7, "b_ts": 8}, 7),
    ],
)  # fmt: skip
def test_a_name_is_looked_for_in_the_component_and_in_those_around_it(
    owner: str, slots: Mapping[str, int], slot: int
) -> None:
    model = Model("sample(0, ts)", **slots)
    model.counter(owner, 20)
    (found,) = model.read().schedules
    assert times(found) == (const(0.0), parameter(slot))


def test_a_name_of_a_part_and_one_that_could_mean_two_parameters() -> None:
    model = Model("sample(p.ts, 1)", a_p_ts=6)
    model.counter("a.n", 20)
    assert times(model.read().schedules[0]) == (parameter(6), const(1.0))
    for both in ({"a_ts": 6, "ts": 5}, {"a_b_ts": 6, "a_ts": 5}):
        model = Model("sample(0, ts)", **both)
        model.counter("a.b.n", 20)
        assert model.refusal().startswith("M.mo:3: sample(0, ts): start and interval must be")


# Which variable waits for which


def test_each_variable_waits_for_its_own_flag_and_equal_samples_have_one() -> None:
    model = Model("sample(0, ts)", "sample(0, t2)", "sample(0, ts)", **SLOTS)
    for number, name in enumerate(("n", "m", "k")):
        model.counter(name, 10 + number, number)
    model.counter("v", 20, 1, elements=3)
    found = model.read()
    assert [times(one) for one in found.schedules] == [(const(0.0), TS), (const(0.0), T2)]
    assert found.flags == [FIRST, FIRST + 1]
    elements = dict.fromkeys((20, 21, 22), FIRST + 1)
    assert found.of_slot == {10: FIRST, 11: FIRST + 1, 12: FIRST, **elements}
    assert found.of_clock == {0: FIRST, 1: FIRST + 1, 2: FIRST}
    assert found.aliases == {100: FIRST, 101: FIRST + 1, 102: FIRST}


def test_a_variable_that_is_no_slot_of_p_has_a_schedule_and_no_flag_of_its_own() -> None:
    model = Model("sample(0, ts)", **SLOTS)
    model.counter("x", 3, vector="Y")
    found = model.read()
    assert (len(found.schedules), found.of_slot, found.of_clock) == (1, {}, {0: FIRST})


def test_one_clock_with_other_parameters_in_two_components_is_two_schedules() -> None:
    """The compiler has one flag for both; it stands for neither."""
    model = Model("sample(ts, ts)", a_ts=5, b_ts=6)
    for name, slot in (("a.n", 10), ("b.n", 11)):
        model.waits(model.variable(name, slot), 0)
    found = model.read()
    assert [times(one) for one in found.schedules] == [(TS, TS), (T2, T2)]
    assert found.of_slot == {10: FIRST, 11: FIRST + 1}
    assert (found.of_clock, found.aliases) == ({}, {})


def test_a_sample_that_no_variable_waits_for_has_a_flag_too() -> None:
    model = Model("sample(0, ts)", "sample(0, t2)", **SLOTS)
    model.counter("n", 10, 1)
    model.condition("relation")
    found = model.read()
    assert [one.interval for one in found.schedules] == [T2, TS]
    assert found.of_clock == {0: FIRST + 1, 1: FIRST}
    assert found.of_slot == {10: FIRST}


@pytest.mark.parametrize("parts", [("lhs", "rhs"), ("condition",), ("rhs", "lhs")])
def test_a_sample_inside_a_condition_is_what_it_waits_for(parts: Sequence[str]) -> None:
    """On either side of `or`, behind `edge` or `not`, and inside of these."""
    model = Model("sample(0, ts)", **SLOTS)
    plain = model.condition("relation")
    trigger = 0
    for _ in range(2):
        rest = dict.fromkeys(parts[1:], plain)
        trigger = model.condition("any", **{parts[0]: trigger}, **rest)
    model.waits(model.variable("n", 10), trigger)
    assert model.read().of_slot == {10: FIRST}


def test_two_branches_that_wait_for_the_same_sample_are_one_and_for_others_are_refused() -> None:
    model = Model("sample(0, ts)", "sample(0, t2)", **SLOTS)
    again = model.sample("sample(0, ts)", clock=0)
    variable = model.variable("n", 10)
    model.waits(variable, 0, again)
    assert model.read().of_slot == {10: FIRST}
    model.waits(variable, 1)
    words = "n needs exactly one sample() that decides when it changes"
    assert model.refusal() == f"M.mo:6: {words}"


@pytest.mark.parametrize("kind", ["none", "always", "other"])
def test_a_variable_that_waits_for_no_sample_is_refused(kind: str) -> None:
    model = Model("sample(0, ts)", **SLOTS)
    variable, other = model.variable("n", 10), model.variable("m", 11)
    model.waits(other, 0)
    if kind == "always":
        model.waits(variable, 0, kind="always")
    elif kind == "other":
        model.waits(variable, model.condition("relation"))
    words = "n needs exactly one sample() that decides when it changes"
    assert model.refusal() == f"M.mo:4: {words}"


def test_a_variable_of_a_clock_that_is_no_sample_is_refused() -> None:
    model = Model("sample(0, ts)", **SLOTS)
    model.counter("k", 9)
    model.counter("n", 10, sampled=True)
    assert model.refusal() == "M.mo:5: n on a clock: only sample() is supported"


@pytest.mark.parametrize("changed", [{"kind": "event"}, {"anchor": "relative"}])
def test_a_clock_that_is_not_periodic_from_the_begin_is_refused(changed: dict[str, str]) -> None:
    model = Model("sample(0, ts)", "sample(0, t2)", **SLOTS)
    model.counter("n", 10)
    model.clocks[1]["operation"] |= changed
    assert model.refusal() == "M.mo:4: a clock that is not periodic is not supported"


# Equations of Real variables


@pytest.mark.parametrize("steps", [("lhs",), ("lhs", "base"), ("lhs", "base", "operand"), ()])
def test_a_real_variable_waits_for_the_sample_of_the_equation_on_whose_left_it_is(
    steps: Sequence[str],
) -> None:
    """Whole, or as an element of an array."""
    model = Model("sample(0, ts)", "sample(0, t2)", **SLOTS)
    for number, name in enumerate(("n", "m")):
        variable = model.variable(name, 10 + number, number)
        inner = model.expression("coordinate", coordinate={"id": variable})
        for step in reversed(steps):
            other = {"rhs": inner + 9} if step == "lhs" else {}
            inner = model.expression("any", **{step: inner}, **other)
        activation = {"kind": "when", "trigger": number}
        model.residuals.append({"residual": inner, "activation": activation})
    assert model.read().of_slot == {10: FIRST, 11: FIRST + 1}


@pytest.mark.parametrize("kind", ["number", "nobody", "always"])
def test_an_equation_without_a_variable_on_its_left_decides_nothing(kind: str) -> None:
    model = Model("sample(0, ts)", **SLOTS)
    variable = model.variable("n", 10)
    left = {
        "number": lambda: model.expression("constant"),
        "nobody": lambda: model.expression("coordinate", coordinate={}),
        "always": lambda: model.expression("coordinate", coordinate={"id": variable}),
    }[kind]()
    activation = {"kind": "always" if kind == "always" else "when", "trigger": 0}
    equation = model.expression("equation", lhs=left)
    model.residuals.append({"residual": equation, "activation": activation})
    assert "n needs exactly one sample()" in model.refusal()
