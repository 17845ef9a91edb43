"""A relation with the time at its very instant, and which states have a start value to be set."""

import pytest
from fmpy.fmi1 import FMICallException

RELATIONS = (">=", ">", "<=", "<")


@pytest.mark.parametrize("at", [0.0, 0.25, 3.0])
def test_a_relation_with_the_time_holds_at_its_instant_as_it_is_written(plant, at):
    """At t itself `time >= t` and `time <= t` are true, `>` and `<` are not, on either side."""
    declaration = "".join(f" Boolean r{n}; Boolean s{n};" for n in range(4))
    declaration += " parameter Real t = 0.5; Real ramp(start=0, fixed=true);"
    equation = "der(ramp) = if time >= t then 1 else 0;"
    for n, relation in enumerate(RELATIONS):
        equation += f" r{n} = time {relation} t; s{n} = t {relation} time;"
    fmu = plant(equation, declaration, t=at)
    instants = [at, at + 0.125] if at == 0.0 else [at - 0.125, at, at + 0.125]
    for instant in instants:
        if instant > fmu.time:
            fmu.step_to(instant)
        now = [getattr(fmu, f"r{n}") for n in range(4)]
        turned = [getattr(fmu, f"s{n}") for n in range(4)]
        assert now == [instant >= at, instant > at, instant <= at, instant < at], instant
        assert turned == [at >= instant, at > instant, at <= instant, at < instant], instant
    assert fmu.ramp == pytest.approx(0.125, abs=1e-15)


@pytest.mark.parametrize("at", [0.1, 0.3, 0.7])
def test_what_begins_at_an_instant_has_begun_there_though_it_is_no_exact_double(plant, at):
    fmu = plant(
        "der(x) = 0; y = if time >= t then 1 else 0; when time >= t then n = 7; end when;",
        "parameter Real t = 0.5;",
        t=at,
    )
    assert (fmu.y, fmu.n) == (0.0, 0)
    fmu.step_to(at)
    assert (fmu.y, fmu.n) == (1.0, 7)


@pytest.mark.parametrize("relation", [">=", ">"])
def test_a_clause_has_run_at_the_end_of_the_step_that_ends_at_its_instant(plant, relation):
    fmu = plant(f"when time {relation} 0.25 then n = pre(n) + 1; end when;")
    fmu.step_to(0.25)
    assert fmu.n == (1 if relation == ">=" else 0)
    fmu.step_to(0.5)
    assert fmu.n == 1


def test_only_a_state_that_is_fixed_has_a_start_value_to_be_set(plant, load):
    """What an initial equation decides cannot be given besides; a guess is no value."""
    declaration = "Real a(start=3); Real b(start=5, fixed=true); Real c; Real d(start=4);"
    equation = "der(d) = 0; der(a) = -1; der(b) = -1; der(c) = -1; x = 0; y = 0; n = 0;"
    path = plant.build(f"{equation} initial equation a = 2*b; c = b + 1;", declaration)
    fmu = load(path)
    words = {v.name: (v.initial, v.start) for v in fmu.description.modelVariables}
    assert words["b"] == ("exact", "5.0")
    assert {words["a"], words["c"], words["d"]} == {("calculated", None)}
    assert (fmu.a, fmu.b, fmu.c) == (10.0, 5.0, 6.0)
    fmu.restart(b=7.0)
    assert (fmu.a, fmu.b, fmu.c) == (14.0, 7.0, 8.0)
    assert fmu.d == 4.0
    for name in ("a", "c", "d"):
        with pytest.raises(FMICallException):
            load(path, **{name: 1.0})
