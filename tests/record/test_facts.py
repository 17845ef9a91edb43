"""What a run leaves beside its series: written and read back equal, damaged ones in one message."""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from pathlib import Path
from types import UnionType
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.recordings import facts

from axisrig.bench.record import axes, blocks, bus, distance, edges, measuring
from axisrig.bench.record import facts as record
from axisrig.bench.record.axes import Value
from axisrig.bench.record.facts import READABLE, VERSION, Facts, RunFile, read_run, run_text
from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.errors import UserError

# Among the numbers those that JSON has no word for, and those that a text may lose
SIMPLE: dict[Any, st.SearchStrategy[Any]] = {
    float: st.floats() | st.sampled_from([math.inf, -math.inf, math.nan, -0.0, 5e-324, 0.1 + 0.2]),
    str: st.text(st.characters(codec="utf-8"), max_size=12),
    int: st.integers(-(2**63), 2**63 - 1),
    bool: st.booleans(),
    type(None): st.none(),
    Value: st.booleans() | st.integers(-99, 99) | st.floats(-1e9, 1e9) | st.text("ab1", max_size=3),
}


@cache
def any_of(hint: Any) -> st.SearchStrategy[Any]:
    """Values of a type as the classes of a recording write it; few of each, or none."""
    origin, parts = get_origin(hint), get_args(hint)
    if hint in SIMPLE:
        return SIMPLE[hint]
    if is_dataclass(hint):
        hints = get_type_hints(hint)
        return st.builds(hint, **{f.name: any_of(hints[f.name]) for f in fields(hint)})
    if origin is Literal:
        return st.sampled_from(parts)
    if origin is Mapping:
        return st.dictionaries(any_of(parts[0]), any_of(parts[1]), max_size=2)
    if origin is tuple:
        is_open = parts[1:] == (...,)
        several = st.lists(any_of(parts[0]), max_size=2).map(tuple)
        return several if is_open else st.tuples(*map(any_of, parts))
    assert origin is UnionType, hint
    return st.one_of(*map(any_of, parts))


def classes(*modules: Any) -> list[type[Frozen]]:
    """The classes of a recording."""
    found = [c for module in modules for c in vars(module).values() if isinstance(c, type)]
    return [c for c in dict.fromkeys(found) if issubclass(c, Frozen) and is_dataclass(c)]


CLASSES = classes(axes, blocks, bus, distance, edges, measuring, record)


def written(path: Path, file: RunFile) -> RunFile:
    path.write_text(run_text(file.facts, file.error, file.log), encoding="utf-8", newline="")
    return read_run(path)


def same(one: Any, other: Any) -> bool:
    """Whether two values are equal, and of one type; a number that is none equals another one."""
    if isinstance(one, float) and isinstance(other, float) and math.isnan(one):
        return math.isnan(other)
    if type(one) is not type(other):
        return False
    if is_dataclass(one):
        return all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, dict):
        pairs = [same(one[key], other.get(key)) for key in one]
        return list(one) == list(other) and all(pairs)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other) and repr(one) == repr(other)


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(left=any_of(Facts))
@pytest.mark.long
def test_facts_come_back_equal(left: Facts, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Each class of the recording, with whatever numbers and texts."""
    path = tmp_path_factory.mktemp("facts") / "run.json"
    assert same(written(path, RunFile(VERSION, left)).facts, left)


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_every_class_is_part_of_what_a_run_leaves(kind: type[Frozen]) -> None:
    """So the test before has made each of them."""
    known: set[Any] = set()
    ahead: list[Any] = [RunFile]
    while ahead:
        one = ahead.pop()
        if one in known:
            continue
        known.add(one)
        hints = [f.type for f in fields(one)] if is_dataclass(one) else one.__args__
        ahead += [hint for hint in hints if is_dataclass(hint) or hasattr(hint, "__args__")]
    assert kind in known


def test_whoever_leaves_nothing_says_why(tmp_path: Path) -> None:
    file = RunFile(VERSION, None, "the FMU ended the process", ("N10 G0 X120", "\x00 ü"))
    assert written(tmp_path / "run.json", file) == file


def test_equal_facts_give_equal_bytes() -> None:
    assert run_text(facts()) == run_text(facts())
    assert run_text(facts()).endswith("}\n")


def test_a_file_has_one_value_in_a_line() -> None:
    """So that a change of a run is a change of few lines, for whoever compares two of them."""
    lines = run_text(facts(end_ns=77, fine_ns=5)).splitlines()
    assert f' "version": {VERSION},' in lines
    assert '  "end_ns": 77,' in lines
    assert '  "fine_ns": 5,' in lines
    assert all(line.count(": ") <= 1 for line in lines)
    assert [lines[0], lines[-1]] == ["{", "}"]


def test_a_value_of_another_type_says_what_is_wrong_with_it(tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    path.write_text(edited(lambda content: content["facts"].update(end_ns="soon")), "utf-8")
    with pytest.raises(UserError) as caught:
        read_run(path)
    head = "the recording is damaged: facts.end_ns cannot be read: "
    assert caught.value.message.startswith(head)
    assert "integer" in caught.value.message.removeprefix(head)


def edited(change: Callable[[Any], None]) -> str:
    content = json.loads(run_text(facts(axes={"Z": axes.AxisRecord("can1", 3, 10_000.0)})))
    change(content)
    return json.dumps(content)


def wanting(content: Any) -> None:
    del content["facts"]["timing"]["period_ns"]


def foreign(content: Any) -> None:
    content["facts"]["axes"]["Z"]["colour"] = "red"


def wrong(content: Any) -> None:
    content["facts"]["axes"]["Z"]["node"] = "three"


def listed(content: Any) -> None:
    content["facts"]["axes"] = []


@pytest.mark.parametrize(
    ("text", "key", "what"),
    [
        (edited(wanting), "facts.timing.period_ns", "is missing"),
        (edited(foreign), "facts.axes.Z.colour", "is unknown"),
        (edited(wrong), "facts.axes.Z.node", "cannot be read"),
        (edited(listed), "facts.axes", "cannot be read"),
    ],
)
def test_a_damaged_recording_is_one_message_with_file_and_key(
    tmp_path: Path, text: str, key: str, what: str
) -> None:
    path = tmp_path / "plan-a.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_run(path)
    message = str(caught.value)
    assert f"the recording is damaged: {key} {what}" in message
    assert "plan-a.json" in message
    assert "run the case again" in message
    assert message.count("the recording is damaged") == 1


def test_of_several_damages_the_first_is_named(tmp_path: Path) -> None:
    path = tmp_path / "plan-a.json"

    def change(content: Any) -> None:
        for damage in (wrong, foreign, wanting):
            damage(content)

    path.write_text(edited(change), encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_run(path)
    message = str(caught.value)
    assert "the recording is damaged: facts.timing.period_ns is missing" in message
    assert "colour" not in message
    assert "node" not in message


@pytest.mark.parametrize("version", READABLE)
def test_a_damaged_recording_of_a_version_that_is_read_is_no_other_version(
    tmp_path: Path, version: int
) -> None:
    def change(content: Any) -> None:
        content["version"] = version
        wanting(content)

    path = tmp_path / "plan-a.json"
    path.write_text(edited(change), encoding="utf-8")
    with pytest.raises(UserError, match=r"is damaged: facts.timing.period_ns is missing"):
        read_run(path)


@pytest.mark.parametrize("text", ["", "[]", "7", "{", "null", '"a"', '{"version": 1}\n{}'])
def test_what_is_no_recording_at_all_is_named(tmp_path: Path, text: str) -> None:
    path = tmp_path / "plan-a.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match=r"plan-a.json: the recording is damaged: the whole"):
        read_run(path)


def test_bytes_that_are_no_text_are_named(tmp_path: Path) -> None:
    path = tmp_path / "plan-a.json"
    path.write_bytes(bytes(range(256)))
    with pytest.raises(UserError, match="the recording is damaged"):
        read_run(path)


@pytest.mark.parametrize("version", [0, VERSION + 1, "1", None])
def test_another_version_is_told_from_damage(tmp_path: Path, version: object) -> None:
    """Also that of older folders, which name none."""

    def change(content: Any) -> None:
        content["version"] = version
        content["facts"]["later"] = {}

    path = tmp_path / "plan-a.json"
    path.write_text(edited(change), encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_run(path)
    message = str(caught.value)
    assert "a recording of another version" in message
    assert "allowed: 1" in message
    path.write_text('{"events": [], "log": []}', encoding="utf-8")
    with pytest.raises(UserError, match="a recording of another version"):
        read_run(path)


@pytest.mark.parametrize("version", [1, 2, 3])
def test_an_older_recording_was_made_under_the_older_law(tmp_path: Path, version: int) -> None:
    """A derivative of the error per second, and a clamp; a newer one has what its rig chose."""
    chosen = distance.Controller(
        0.3, 0.0, 0.01, "MOVING_AVERAGE", 20, 0.7, 4, 25.0, 0.1, False,
        "feedback", "slope", "per_cycle",
    )  # fmt: skip
    change = distance.DistanceChange(0, "ACTIVE", "NC", "60E4", False, chosen)
    left = facts(distance={"Z": distance.DistanceRecord(changes=(change,))})
    path = tmp_path / "run.json"
    path.write_text(run_text(left), encoding="utf-8")
    assert read_run(path).facts == left
    content = json.loads(run_text(left))
    content["version"] = version
    controller = content["facts"]["distance"]["Z"]["changes"][0]["controller"]
    for name in ("derivative_of", "limiter", "derivative"):
        del controller[name]
    path.write_text(json.dumps(content), encoding="utf-8")
    found = read_run(path).facts
    assert found is not None
    control = found.distance["Z"].changes[0].controller.control
    assert (control.derivative_of, control.limiter) == ("error", "clamp")
    assert control.derivative == "per_second"
    assert control.kp == 0.3


@pytest.mark.parametrize("version", [1, 2, 3, 4])
def test_an_older_recording_has_no_edges(tmp_path: Path, version: int) -> None:
    """No table at all, where a run of today without an edge has an empty one."""
    path = tmp_path / "run.json"
    content = json.loads(run_text(facts(edges=())))
    assert content["facts"].pop("edges") == []
    content["version"] = version
    path.write_text(json.dumps(content), encoding="utf-8")
    found = read_run(path).facts
    assert found is not None
    assert found.edges is None


def test_a_file_that_cannot_be_read_is_no_damage(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"run\.json"):
        read_run(tmp_path / "run.json")


def test_what_is_recorded_stays() -> None:
    """A judge cannot change what it judges."""
    with pytest.raises(AttributeError):
        facts().end_ns = 0  # type: ignore[misc]
    assert replace(facts(), end_ns=0) != facts()


def test_a_closed_form_gets_every_parameter_of_a_control() -> None:
    """Each value is another one than its default, and than that of any other field."""
    choices = {"derivative_of": "feedback", "limiter": "slope", "derivative": "per_cycle"}
    numbers = {
        "kp": 0.1,
        "tn_s": 0.2,
        "tv_s": 0.3,
        "alpha": 0.4,
        "corner_hz": 50.0,
        "sigma_mm": 0.6,
    }
    counts = {"count": 7, "order": 8}
    given = {**numbers, **counts, **choices, "filter_type": "KALMAN"}
    control = distance.Controller(**given, both_encoders=True).control
    assert {name: getattr(control, name) for name in given} == given
