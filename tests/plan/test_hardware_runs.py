"""Runs with a real bus: interface and segment, permission to move, Ctrl-C, one process."""

import signal
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import OTHER, RIG, case_of

from axisrig.bench.campaign import (
    hardware_runs,
    single_program,
)
from axisrig.bench.campaign.hardware_runs import Outside, allow, real_cases, refuse_processes
from axisrig.bench.rig.reading.families import read_segment
from axisrig.kernel.errors import UserError


def outside(said: list[str], **options: Any) -> Outside:
    return Outside(lambda: None, options.pop("may_move", False), said.append, **options)  # type: ignore[arg-type, return-value]


def test_an_interface_goes_onto_the_segment_that_is_meant() -> None:
    buses = {name: read_segment({}) for name in "ab"}
    assert outside([]).changes(buses, RIG) == []
    assert not outside([], segment="a").says_anything
    one = {"a": buses["a"]}
    words = {"interface": "slcan", "channel": "/dev/x", "bitrate": 500_000,
             "options": ["a=1", "b=2"]}  # fmt: skip
    found = [f"{item.column}={item.value}" for item in outside([], **words).changes(one, RIG)]
    assert found == ["bus:a.interface=slcan", "bus:a.channel=/dev/x", "bus:a.bitrate=500000",
                     "bus:a.options=a=1 b=2"]  # fmt: skip
    named = outside([], interface="slcan", segment="b").changes(buses, RIG)
    assert [item.column for item in named] == ["bus:b.interface"]
    for options, segments, message in (
        ({"interface": "slcan"}, buses, "the rig has several segments"),
        ({"interface": "slcan"}, {}, "the rig has several segments"),
        ({"interface": "slcan", "segment": "c"}, buses, "the rig has no such segment"),
    ):
        with pytest.raises(UserError, match=message):
            outside([], **options).changes(segments, RIG)
    for name, value in words.items():
        assert outside([], **{name: value}).says_anything


def test_rigs_of_a_plan_name_their_segment_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    segments = {RIG: ["a"], OTHER: ["b"], Path("third.toml"): ["a"]}
    buses = {rig: {name: read_segment({}) for name in names} for rig, names in segments.items()}
    monkeypatch.setattr(
        hardware_runs, "read_rig", lambda rig: (SimpleNamespace(segment=buses[rig]), [])
    )
    on = outside([], interface="slcan")
    alike: Any = SimpleNamespace(cases=[case_of("a"), case_of("b", Path("third.toml"))])
    assert [item.column for item in on.changes_of(alike)] == ["bus:a.interface"]
    mixed: Any = SimpleNamespace(cases=[case_of("a"), case_of("b", OTHER)], path=Path("p.csv"))
    with pytest.raises(UserError, match="name their segments differently"):
        on.changes_of(mixed)
    assert outside([]).changes_of(mixed) == []


def rig_with(axes: str, *, is_allowed: bool, foreign: str = "") -> Any:
    return SimpleNamespace(rig=SimpleNamespace(hardware=is_allowed), axes=axes, foreign=foreign)


@pytest.mark.parametrize(
    ("rigs", "may_move", "is_allowed"),
    [
        ([rig_with("Z", is_allowed=False)], False, False),
        ([rig_with("Z", is_allowed=False)], True, True),
        ([rig_with("Z", is_allowed=True)], False, True),
        ([rig_with("Z", is_allowed=True), rig_with("X", is_allowed=False)], False, False),
        ([rig_with("Z", is_allowed=True), rig_with("", is_allowed=False)], False, True),
        ([rig_with("", is_allowed=False)], False, True),
        ([], False, True),
    ],
)
def test_nothing_real_moves_unless_operator_or_every_rig_allows_it(
    rigs: list[Any], may_move: bool, is_allowed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hardware_runs, "outside_axes", lambda rig: frozenset(rig.axes))
    monkeypatch.setattr(hardware_runs, "simulated_plants", lambda rig: [*rig.foreign])
    monkeypatch.setattr(hardware_runs, "foreign_plants", lambda plants: plants)
    family = SimpleNamespace(outside=lambda _rig, name: f"drive of {name}")
    monkeypatch.setattr(hardware_runs, "family_of", lambda _rig, _name: family)
    said: list[str] = []
    if is_allowed:
        allow(rigs, outside(said, may_move=may_move))
    else:
        with pytest.raises(UserError, match="only when the operator allows it"):
            allow(rigs, outside(said, may_move=may_move))
    names = [name for rig in rigs for name in rig.axes]
    assert [line for line in said if line.startswith("  ")] == [
        f"  axis {name}: drive of {name}" for name in names
    ]
    assert ("Ctrl-C brakes them and powers the drives down" in said) is bool(is_allowed and names)


def test_a_foreign_model_beside_real_axes_is_warned_of_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(hardware_runs, "outside_axes", lambda rig: frozenset(rig.axes))
    monkeypatch.setattr(hardware_runs, "simulated_plants", lambda rig: [*rig.foreign])
    monkeypatch.setattr(hardware_runs, "foreign_plants", lambda plants: plants)
    family = SimpleNamespace(outside=lambda _rig, _name: "a drive")
    monkeypatch.setattr(hardware_runs, "family_of", lambda _rig, _name: family)
    said: list[str] = []
    rig = rig_with("ZZ", is_allowed=True, foreign="m")
    allow([rig, rig], outside(said))
    assert sum(line.startswith("plant m is a foreign FMU") for line in said) == 1
    assert sum(line.startswith("  axis Z") for line in said) == 1


def test_cases_with_a_real_bus_count_once_for_each_rig_and_its_words(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What a case says of its drives belongs to what is real, and does not make it real."""
    asked: list[Any] = []

    def settings(rig: Path, words: Any) -> Any:
        asked.append((rig.name, words))
        if rig.name == "broken.toml":
            raise UserError("no rig")
        return SimpleNamespace(rig=rig.name, words=words)

    monkeypatch.setattr(hardware_runs, "_settings", settings)
    monkeypatch.setattr(
        hardware_runs, "is_paced", lambda s: any("interface" in column for column, _ in s.words)
    )
    real = {"bus:can1.interface": "slcan"}
    cases = [
        case_of("a", inputs={**real, "plc:V.E.A": "1"}),
        case_of("b", inputs={**real, "plc:V.E.A": "2"}),
        case_of("c", inputs={**real, "drive:servo.heartbeat_ms": "20"}),
        case_of("d", inputs={"drive:servo.interface": "slcan"}),
        case_of("e", Path("broken.toml"), inputs=real),
    ]
    found = real_cases(cases)
    assert [(one.rig, dict(one.words)) for one in found] == [  # type: ignore[attr-defined]
        ("rig.toml", real), ("rig.toml", {**real, "drive:servo.heartbeat_ms": "20"}),
    ]  # fmt: skip


def test_a_real_bus_has_one_process() -> None:
    refuse_processes(1, False)
    for jobs, is_apart in ((2, False), (1, True)):
        with pytest.raises(UserError, match="driven from this process"):
            refuse_processes(jobs, is_apart)


def test_the_first_signal_stops_and_the_second_breaks_off() -> None:
    said: list[str] = []
    before = signal.getsignal(signal.SIGINT)
    real_time: Any = object()
    with hardware_runs.stoppable(real_time, said.append) as on:
        assert not on.stop()
        signal.raise_signal(signal.SIGTERM)
        assert on.stop()
        assert said == ["stopping; once more to break off"]
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.parametrize("is_real", [True, False])
def test_a_program_goes_to_real_axes_only_with_all_checks(
    is_real: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    news: list[Any] = []
    table = SimpleNamespace(axis={"Z": None}, segment={"can1": read_segment({})})
    monkeypatch.setattr(single_program, "read_rig", lambda _: (table, []))
    monkeypatch.setattr(single_program, "read_settings", lambda *given: ("settings", len(given[2])))
    monkeypatch.setattr(single_program, "is_paced", lambda _: is_real)
    monkeypatch.setattr(single_program, "refuse_processes", lambda *given: news.append(given))
    monkeypatch.setattr(single_program, "read_program", lambda *given: news.append(given))
    monkeypatch.setattr(single_program, "check_plant", lambda _: news.append("plant"))
    monkeypatch.setattr(single_program, "allow", lambda *_: news.append("allowed"))
    monkeypatch.setattr(single_program, "run_program", lambda *given: given)
    on = outside([], interface="slcan")
    object.__setattr__(on, "open_hardware", lambda: nullcontext("hardware"))
    found = single_program.run_outside(
        on, Path("a.nc"), RIG, ["plc:V.E.A=1"], [Path("x.blf")], print, is_apart=False
    )
    if not is_real:
        assert (found, news) == (None, [])
        return
    assert news == [(1, False), (Path("a.nc"), ("Z",)), "plant", "allowed"]
    changes = ["plc:V.E.A=1", "bus:can1.interface=slcan"]
    assert found == (Path("a.nc"), RIG, changes, [Path("x.blf")], print, "hardware")


def test_a_segment_is_asked_for_by_the_names_that_there_are() -> None:
    """An interface is for CAN alone: a segment of another carrier is none to choose from."""
    segments = {name: read_segment({}) for name in "ab"}
    on = outside([], interface="slcan")
    with pytest.raises(UserError, match="the rig has several segments") as caught:
        on.changes(segments, RIG)
    assert (caught.value.file, caught.value.allowed) == (str(RIG), "a, b")
    assert str(caught.value.hint).startswith("--segment NAME")
    with pytest.raises(UserError, match="the rig has no such segment") as missing:
        outside([], interface="slcan", segment="c").changes(segments, RIG)
    assert (missing.value.value, missing.value.allowed) == ("c", "a, b")
    other: Any = type("Line", (), {"model_fields": {}})()
    mixed = {"line": other, "a": segments["a"]}
    assert [item.column for item in on.changes(mixed, RIG)] == ["bus:a.interface"]
    for segment, table in (("line", mixed), (None, {"line": other})):
        with pytest.raises(UserError) as refused:
            outside([], interface="slcan", segment=segment).changes(table, RIG)
        assert refused.value.file == str(RIG)
        assert "line" in str(refused.value)


@pytest.mark.parametrize(("options", "wrong"), [(["a"], "a"), (["a=1", "b"], "b"), (["=1"], "=1")])
def test_an_option_of_a_bus_without_key_or_value_is_refused(options: list[str], wrong: str) -> None:
    with pytest.raises(UserError, match="an option is key=value") as caught:
        outside([], options=options).changes({"a": read_segment({})}, RIG)
    assert caught.value.value == wrong
