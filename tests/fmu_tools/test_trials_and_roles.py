"""One instance on trial, and what an FMU could be in a rig: with stand-ins for the instance."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.fmu import roles, stepped_instance
from axisrig.bench.tools.fmu.stepped_instance import Trial, readable_outputs
from axisrig.kernel.cosim.fmi.fmu import EndedError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS


def variable(name: str, number: int = 0, **given: Any) -> Any:
    known = {"type": "Float64", "causality": "output", "start": "0", "clocks": [], "shape": None,
             "min": None, "max": None}  # fmt: skip
    return SimpleNamespace(name=name, valueReference=number, **{**known, **given})


class Library:
    """Functions of an FMU: getters give the reference, for arrays so many of it; sets are noted."""

    def __init__(self) -> None:
        self.sets: list[tuple[str, list[int], list[Any]]] = []

    def __getattr__(self, name: str) -> Any:
        def get(references: list[int], **count: int) -> list[str]:
            return [f"{name[3:]}{references[0]}"] * count.get("nValues", 1)

        def put(references: list[int], values: list[Any]) -> None:
            self.sets.append((name, references, values))

        return get if name.startswith("get") else put


class Slave:
    def __init__(self, variables: list[Any], prefix: str = "fmi3", ends_ns: int = 10**12) -> None:
        self.PREFIX, self.time_ns, self._ends_ns = prefix, -1, ends_ns
        self.description: Any = SimpleNamespace(modelVariables=variables)
        self.fmpy = Library()
        self.closed = False

    def initialize(self, time_ns: int) -> None:
        self.time_ns = time_ns

    def step_to(self, time_ns: int) -> None:
        if time_ns > self._ends_ns:
            raise EndedError("trial", self.time_ns, "it ended")
        self.time_ns = time_ns

    def close(self) -> None:
        self.closed = True


def on_trial(patch: pytest.MonkeyPatch, slave: Slave, **given: Any) -> Trial:
    patch.setattr(stepped_instance, "load_fmu", lambda path, name: slave)
    made = Trial(Path("a.fmu"), **given)
    made.start()
    return made


OUTPUTS = [variable("x", 1), variable("n", 2, type="Enumeration"), variable("a", 3, shape=(2, 3)),
           variable("tick", 4, type="Clock"), variable("c", 5, clocks=["tick"]),
           variable("u", 6, causality="input")]  # fmt: skip


def test_all_outputs_that_have_a_value_are_read_by_their_type(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert [one.name for one in readable_outputs(SimpleNamespace(modelVariables=OUTPUTS))] == [  # type: ignore[arg-type]
        "x", "n", "a",
    ]  # fmt: skip
    for prefix, kind in (("fmi2", "Integer2"), ("fmi3", "Int642")):
        found = on_trial(monkeypatch, Slave(OUTPUTS, prefix)).read()
        assert found.values == (("Float641",), (kind,), ("Float643",) * 6)
        assert found.time_ns == 0


def test_a_trial_goes_on_step_by_step_until_the_fmu_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    made = on_trial(monkeypatch, Slave(OUTPUTS, ends_ns=5 * MS))
    assert [one.time_ns for one in made.run([MS, 2 * MS])] == [MS, 3 * MS]
    assert made.count == 2
    assert [one.time_ns for one in made.run([MS, MS, MS])] == [4 * MS, 5 * MS]
    made.start()
    assert (made.count, made.slave.time_ns) == (0, 0)
    made.close()
    assert made.slave.closed  # type: ignore[attr-defined]


def test_inputs_move_only_where_that_is_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    still = Slave(OUTPUTS)
    on_trial(monkeypatch, still).run([MS] * 3)
    assert still.fmpy.sets == []
    moving = Slave(OUTPUTS)
    on_trial(monkeypatch, moving, moves=True).run([MS] * 3)
    assert moving.fmpy.sets == [("setFloat64", [6], [1e-3 * k]) for k in (0.0, 1.0, 2.0)]


def test_in_a_course_inputs_move_at_whole_milliseconds_for_steps_of_any_length(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for step_ns, each in ((MS, 1), (250_000, 4)):
        slave = Slave(OUTPUTS)
        readings = on_trial(monkeypatch, slave, moves=True).course(step_ns, 3 * MS)
        assert [one.time_ns for one in readings] == list(range(0, 3 * MS + 1, step_ns))
        values = [values[0] for _, _, values in slave.fmpy.sets]
        assert values == [1e-3 * k for k in (0.0, 1.0, 2.0) for _ in range(each)]
    ended = on_trial(monkeypatch, Slave(OUTPUTS, ends_ns=2 * MS)).course(MS, 5 * MS)
    assert [one.time_ns for one in ended] == [0, MS, 2 * MS]


# What it could be


def role(need: str = "required", group: str = "plain", **given: Any) -> Any:
    known = {"causality": "output", "type": "number", "unit": "m", **given}
    return SimpleNamespace(need=need, group=group, **known)


class Kinds:
    """Kinds of plants; `fits`: those that an FMU has all for, with the notes of each."""

    def __init__(self, patch: pytest.MonkeyPatch, **fits: list[str]) -> None:
        self.roles: dict[str, dict[str, Any]] = {"axis": {}, "probe": {"none": role()}}
        self.coordinates: dict[str, list[str]] = {"axis": [], "probe": ["x", "z"]}
        patch.setattr(roles, "KINDS", ("axis", "probe"))
        patch.setattr(roles, "coordinates_of", lambda _, kind: self.coordinates[kind])
        patch.setattr(roles, "roles_of", lambda kind, _: self.roles[kind])

        def map_roles(_slave: object, kind: str, *_: object) -> Any:
            if kind not in fits:
                raise UserError("a role is missing")
            return SimpleNamespace(notes=fits[kind])

        patch.setattr(roles, "map_roles", map_roles)


def found(slave: Any) -> list[tuple[str, str]]:
    return [(one.level, one.text) for one in roles.role_findings(slave)]


def test_a_kind_that_fits_by_its_own_names_is_named_with_its_notes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Kinds(monkeypatch, axis=["no kv", "no force"], probe=[])
    assert found(None) == [
        ("ok", "kind axis: has all it needs by its own names"),
        ("warn", "axis: no kv"), ("warn", "axis: no force"),
        ("ok", "kind probe that reads x, z: has all it needs by its own names"),
    ]  # fmt: skip


def test_what_fits_nothing_may_fit_with_a_map_the_plainest_way_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """`bind` takes what the table below says; each variable counts once, with its plainest mark."""
    kinds = Kinds(monkeypatch)
    variables = [variable("a"), variable("b"), variable("c"), variable("d", causality="input"),
                 variable("flag", type="Boolean"), variable("e"), variable("f")]  # fmt: skip
    slave: Any = SimpleNamespace(description=SimpleNamespace(modelVariables=variables))
    good: set[tuple[str, str, str]] = set()

    def bind(_slave: object, name: str, role: Any, source: Any) -> None:
        how = "lead" if source.lead_m else "unit" if source.unit else "plain"
        if (name, source.variable, how) not in good:
            raise UserError("no")

    monkeypatch.setattr(roles, "bind", bind)
    kinds.roles["axis"] = {"position": role(), "signal": role(type="flag"),
                           "force": role("optional"), "one": role("one of", "contact")}  # fmt: skip
    assert found(slave) == [("ok", "nothing in it can be an axis or a sensor of a rig")]
    good |= {("position", "a", "unit"), ("position", "b", "lead"), ("position", "e", "lead"),
             ("signal", "flag", "plain"), ("signal", "c", "plain"),
             ("position", "d", "plain")}  # fmt: skip
    words = "kind axis with a map (docs/rigs.md): "
    assert found(slave) == [("ok", words + "position = b (lead_mm) or e (lead_mm); signal = flag")]
    good |= {("position", name, "plain") for name in "abcef"}
    good -= {("signal", "flag", "plain")}
    assert found(slave) == [
        ("ok", words + "position = a or b or c or 2 more; signal = c (threshold)")
    ]
    good -= {("position", "f", "plain")}
    assert found(slave) == [
        ("ok", words + "position = a or b or c or 1 more; signal = c (threshold)")
    ]
    good -= {("position", "e", "plain")}
    assert found(slave) == [("ok", words + "position = a or b or c; signal = c (threshold)")]
    good -= {("signal", "c", "plain")}
    assert found(slave) == [("ok", "nothing in it can be an axis or a sensor of a rig")]


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ("position", ""),
        ("position demand", "position = position; demand = demand"),
        ("demand ramp", ""),
        ("position demand ramp", "position = position; demand = demand"),
    ],
)
def test_of_groups_that_need_one_another_the_plain_one_is_asked_for(
    names: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of an axis: the ramp of the demand, or the demand alone (roles.csv)."""
    kinds = Kinds(monkeypatch)
    kinds.roles["axis"] = {
        "position": role(), "ramp": role("demand", "ramp"), "demand": role("demand"),
        "force": role("optional"),
    }  # fmt: skip

    def bind(_slave: object, name: str, _role: Any, source: Any) -> None:
        if source.variable != name:
            raise UserError("no")

    monkeypatch.setattr(roles, "bind", bind)
    variables = [variable(name) for name in names.split()]
    slave: Any = SimpleNamespace(description=SimpleNamespace(modelVariables=variables))
    ((_, text),) = found(slave)
    head = "kind axis with a map (docs/rigs.md): "
    assert text == (head + words if words else "nothing in it can be an axis or a sensor of a rig")


def test_with_a_kind_that_fits_no_map_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    kinds = Kinds(monkeypatch, probe=[])
    kinds.roles["axis"] = {}
    assert found(SimpleNamespace(description=SimpleNamespace(modelVariables=[]))) == [
        ("ok", "kind probe that reads x, z: has all it needs by its own names")
    ]
