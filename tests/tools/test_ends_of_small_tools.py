"""Small tools at their ends: readings of a law, guesses of words, rotary lists, numbers."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.distance import readings
from axisrig.bench.tools.distance.readings import LIST, Shown, _asked, _at_rest, _digits, _line
from axisrig.bench.tools.listings.alarms import _alike, alarm_listing
from axisrig.bench.tools.params.effective import difference_text
from axisrig.bench.tools.probe_feed import Question, probe_feed_text
from axisrig.bench.tools.rig_export import package, parts
from axisrig.kernel.errors import UserError, catalogue, reaction_classes
from axisrig.kernel.time.clock import MS

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"

# Readings of the law: 0.3 x 0.1 mm are 30 um, of a mean of 20 values a 20th in the first cycle


@pytest.mark.parametrize("period_ms", [1, 2, 4])
def test_what_a_step_of_the_sensor_and_of_the_set_distance_ask_for(period_ms: int) -> None:
    """With the derivative 0.01 s in a cycle of T: 1 + 0.01/T; counted in cycles 1.01."""
    per_second = 1 + 0.01 / (period_ms * 1e-3)
    found = list(_at_rest(period_ms * MS))
    assert [(one.step, one.choice) for one in found] == [
        ("sensor", 'derivative = "per_second"'),
        ("sensor", 'derivative = "per_cycle"'),
        ("SET_DIST", 'derivative_of = "feedback"'),
        ("SET_DIST", 'derivative_of = "error"'),
        ("SET_DIST", 'derivative_of = "error", per cycle'),
    ]
    assert [one.first_um for one in found] == pytest.approx(
        [1.5 * per_second, 1.5 * 1.01, 30.0, 30.0 * per_second, 30.0 * 1.01]
    )
    assert [one.later_um for one in found] == pytest.approx([30.0] * 5)


@pytest.mark.parametrize("count", [2, 5, 20])
@pytest.mark.parametrize("sensor", [True, False])
def test_the_later_number_is_that_of_a_full_filter(count: int, sensor: bool) -> None:
    """Behind as many cycles as it has values: the derivative of the sensor has ended then."""
    control = replace(LIST, count=count)
    first, later = _asked(control, MS, sensor=sensor)
    assert later == pytest.approx(30.0)
    assert first == pytest.approx(30.0 * 11 / count if sensor else 30.0)


@pytest.mark.parametrize(
    ("um", "text"),
    [(30.0, "30.0"), (330.0, "330.0"), (1.515, "1.515"), (16.5, "16.5"), (5.25, "5.25"),
     (1000.0, "1000.0"), (0.0, "0.0"), (1234.0, "1234.0")],
)  # fmt: skip
def test_a_number_without_a_fraction_has_a_place_of_it(um: float, text: str) -> None:
    assert _digits(um) == text
    line = _line(Shown("sensor", "choice", um, 30.0))
    assert f" {text} um in the first cycle, 30.0 from cycle 20 on" in line
    assert line.startswith("   sensor steps by 0.1 mm")


@pytest.mark.parametrize(("um", "text"), [(115.0, "0.115"), (480.0, "0.48"), (0.0, "0")])
def test_past_a_step_of_the_surface_there_is_one_number(um: float, text: str) -> None:
    line = _line(Shown("surface", "choice", um))
    assert line.startswith("   surface steps by 2.8 mm")
    assert line.endswith(f"goes past it by {text} mm")


def controlled(monkeypatch: pytest.MonkeyPatch, axes: list[str], has_channel: bool) -> Any:
    """A rig with these controls; of each a fresh sensor and one that is 3 cycles old."""
    sensors = [SimpleNamespace(age=0), SimpleNamespace(age=3)]
    monkeypatch.setattr(readings, "released_axes", lambda _: axes)
    monkeypatch.setattr(readings, "is_released", lambda _: has_channel)
    monkeypatch.setattr(readings, "sensors_of", lambda *_: sensors)
    monkeypatch.setattr(readings, "listed_for", lambda *_: None)
    monkeypatch.setattr(
        readings,
        "dead_cycles",
        lambda _, sensor: SimpleNamespace(reaction=1, way=1 + sensor.age, dead=2 + sensor.age),
    )
    monkeypatch.setattr(readings, "_past", lambda _, rig: [rig])
    rig = SimpleNamespace(cycle=SimpleNamespace(period_us=1000))
    return SimpleNamespace(rig=rig, files=[Path("rig.toml")])


@pytest.mark.parametrize(
    ("axes", "has_channel", "owners"),
    [
        (["Z"], False, ["axis Z"]),
        (["Z", "X"], False, ["axis Z", "axis X"]),
        ([], True, ["3D control"]),
        (["Z"], True, ["axis Z", "3D control"]),
    ],
)
def test_each_control_of_a_rig_is_shown_with_each_of_its_sensors(
    monkeypatch: pytest.MonkeyPatch, axes: list[str], has_channel: bool, owners: list[str]
) -> None:
    """The dead cycles are those of reaction and way together, and grow by the age of a sensor."""
    rest, *found = readings.readings(controlled(monkeypatch, axes, has_channel))
    assert rest[0] == ""
    assert [owner for owner, _ in found] == [
        f"{owner}, n = {dead}" for owner in owners for dead in (2, 5)
    ]
    rigs: Any = [rig for _, shown in found for rig in shown]
    got = [(rig.reaction_cycles, rig.way_cycles, rig.skew_cycles) for rig in rigs]
    assert got == [(1, 1, 0), (1, 1, 3)] * len(owners)  # the age is part of the way


# Alarms


@pytest.mark.parametrize("number", [0, -1, 99])
def test_a_class_that_no_alarm_has_lists_none(number: int) -> None:
    """A class of 0 is asked for as any other: only what is not given asks for all."""
    with pytest.raises(UserError, match="no alarm fits") as caught:
        alarm_listing(reaction_class=number)
    assert caught.value.value == number


def test_each_class_lists_its_alarms() -> None:
    entries = list(catalogue().values())
    numbers = {entry.reaction_class for entry in entries}
    assert numbers <= {*reaction_classes()}
    for number in numbers:
        count = sum(entry.reaction_class == number for entry in entries)
        assert f"; {count} of {len(entries)}. " in alarm_listing(reaction_class=number)


@pytest.mark.parametrize(
    ("word", "words", "found"),
    [
        ("abcd", ["abce"], ["abce"]),  # 2 x 3 of 8 letters: three quarters
        ("abcde", ["abcdx"], ["abcdx"]),
        ("abcde", ["abcxy"], []),  # 2 x 3 of 10
        ("ABCD", ["abce"], ["abce"]),
        ("abcdefg", ["abcdexy"], []),  # 2 x 5 of 14
        ("abc", ["abd"], []),  # a short one is like many
        ("abcd", ["(abce)."], ["abce"]),
        ("probe", ["probes", "strobe", "drive"], ["probes"]),
    ],
)
def test_words_that_differ_by_up_to_a_quarter_are_guessed(
    word: str, words: list[str], found: list[str]
) -> None:
    assert list(_alike(word, words)) == found


# Lists


def rotary(folder: Path, name: str, window: int, is_rotary: bool) -> Path:
    path = folder / f"{name}.lst"
    kind = "kenngr.achs_typ 2\n" if is_rotary else ""
    path.write_text(f"kopf.achs_nr 1\nkopf.log_achs_name C\n{kind}getriebe[0].window {window}\n")
    return path


@pytest.mark.parametrize(("is_rotary", "unit"), [(True, "deg"), (False, "mm")])
def test_what_lists_of_a_rotary_axis_differ_in_is_in_degrees(
    tmp_path: Path, is_rotary: bool, unit: str
) -> None:
    pair = [rotary(tmp_path, str(window), window, is_rotary) for window in (250, 300)]
    text, differs = difference_text(pair[0], pair[1])
    assert differs
    (line,) = text.splitlines()[2:]
    assert line.startswith("C: getriebe[0].window: 250 ")
    assert line.count(f" {unit}") == (4 if is_rotary else 2)  # 0.1 um = 0.025 mm


@pytest.mark.parametrize("part", ["channel", "axis.Z"])
def test_where_the_list_of_a_part_is_makes_no_difference(tmp_path: Path, part: str) -> None:
    """What it says does: a list with other words of the same values is the same."""
    base = RIGS / "probe-z.toml"
    text = base.read_text(encoding="utf-8")
    name = "channel.lst" if part == "channel" else "axis-z-fine.lst"
    words = (RIGS / "lists" / name).read_text(encoding="utf-8")
    (tmp_path / "moved.lst").write_text(words + "\n", encoding="utf-8")
    moved = tmp_path / "probe-z.toml"
    text = text.replace(f'"lists/{name}"', '"moved.lst"').replace('"lists/', f'"{RIGS}/lists/')
    moved.write_text(text, encoding="utf-8")
    assert '"moved.lst"' in text
    assert difference_text(base, moved) == ("no difference", False)


# Feeds of a probe


@pytest.mark.parametrize("name", ["stroke_mm", "decel_m_s2", "kv_m_min_mm", "cycle_ms", "delay_ms",
                                  "ramp_ms"])  # fmt: skip
@pytest.mark.parametrize("value", [math.inf, math.nan, -math.inf, -1.0])
def test_no_machine_has_what_is_not_finite(name: str, value: float) -> None:
    """Infinity is above 0 and still no number of a machine."""
    given: dict[str, float] = {"stroke_mm": 5.0, "cycle_ms": 8.0, "decel_m_s2": 1.0,
                               "kv_m_min_mm": 1.0, name: value}  # fmt: skip
    with pytest.raises(UserError, match="no machine has that") as caught:
        Question(**given)
    option = {"stroke_mm": "--stroke", "decel_m_s2": "--decel", "kv_m_min_mm": "--kv"}.get(
        name, f"--{name.removesuffix('_ms')}"
    )
    assert str(caught.value).count(f"{option}:") == 1


@pytest.mark.parametrize("name", ["cycle_ms", "delay_ms", "ramp_ms"])
def test_a_time_of_nothing_is_one_a_length_of_nothing_is_none(name: str) -> None:
    Question(**{"stroke_mm": 5.0, "cycle_ms": 8.0, "decel_m_s2": 1.0, "kv_m_min_mm": 1.0, name: 0})
    with pytest.raises(UserError, match="--stroke"):
        Question(0.0, 8.0, 1.0, 1.0)


@pytest.mark.parametrize("feed", [math.inf, math.nan, 0.0, -5.0])
def test_no_feed_is_refused(feed: float) -> None:
    with pytest.raises(UserError, match="--feed: no feed"):
        probe_feed_text(Question(5.0, 8.0, 1.0, 1.0), feed)


# Plants of a package


@pytest.mark.parametrize(
    ("variables", "is_rotary"),
    [
        ([("position", "rad"), ("velocity", "rad/s")], True),
        ([("position", "m"), ("angle", "rad")], False),  # a motor that turns before a screw
        ([("angle", "rad")], False),
        ([("position", None)], False),
        ([("angle", "m"), ("position", "rad")], True),
    ],
)
def test_an_own_model_is_rotary_by_the_unit_of_its_position(
    monkeypatch: pytest.MonkeyPatch, variables: list[tuple[str, str | None]], is_rotary: bool
) -> None:
    described = SimpleNamespace(
        modelVariables=[
            SimpleNamespace(name=name, unit=unit, declaredType=None) for name, unit in variables
        ]
    )
    monkeypatch.setattr(parts, "_described", lambda _: described)
    own: Any = SimpleNamespace(fmu="own/Axis.mo")
    assert parts._is_rotary(own) is is_rotary
    library: Any = SimpleNamespace(fmu="AxisRig.Drives.ServoAxis")
    assert not parts._is_rotary(library)


@pytest.mark.parametrize(("count", "words"), [(1, "1 FMU"), (2, "2 FMUs"), (0, "0 FMUs")])
def test_a_package_says_how_many_it_has(
    monkeypatch: pytest.MonkeyPatch, count: int, words: str
) -> None:
    monkeypatch.setattr(package, "simulated_plants", lambda _: {})
    made: Any = [
        SimpleNamespace(name=f"p{n}", model=None if n else "Own", plants=("a", "b"))
        for n in range(count)
    ]
    settings, target = SimpleNamespace(), "rig.ssp"
    lines = package._in_words(settings, made, target)  # type: ignore[arg-type]
    assert lines[0] == f"rig.ssp: {words}"
    assert lines[1:-1] == ["p0: Own", "p1: joined from a, b"][:count]
