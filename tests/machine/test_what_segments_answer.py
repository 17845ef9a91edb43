"""What the segments of a machine answer about an axis, and what its record has of its sensors."""

from hashlib import sha256
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import facts
from axisrig.bench.machine.cyclic import family as cyclic
from axisrig.bench.machine.ethercat import family as ethercat
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.kernel.channel.distance.sensor import VariableSensor
from axisrig.kernel.drives.power import Power
from axisrig.kernel.time.clock import US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


def parts(**more: Any) -> Any:
    """Segments of a rig with X on a, Y and Z on b."""
    axes = {name: SimpleNamespace(segment="a" if name == "X" else "b") for name in "XYZ"}
    bench = SimpleNamespace(
        settings=SimpleNamespace(rig=SimpleNamespace(axis=axes)), scheduler="clock"
    )
    return SimpleNamespace(_bench=bench, **more)


# --- cyclic segments


def test_a_position_is_sampled_before_the_cycle_by_the_time_of_its_own_segment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """T_I of isochronous PROFIBUS."""
    input_ns = {"a": 125 * US, "b": 0}
    monkeypatch.setattr(
        cyclic, "instants_of", lambda _settings, name: SimpleNamespace(input_ns=input_ns[name])
    )
    found = [cyclic.CyclicSegments.sampled_ns(parts(), axis, 5_000_000) for axis in "XYZ"]
    assert found == [4_875_000, 5_000_000, 5_000_000]


@pytest.mark.parametrize("power", Power)
def test_a_drive_that_is_off_or_faulty_has_left_operation(power: Power) -> None:
    links = {axis: SimpleNamespace(power=Power.OPERATING) for axis in "XYZ"}
    links["Y"].power = power
    found = [cyclic.CyclicSegments.is_off(parts(links=links), axis) for axis in "XYZ"]
    assert found == [False, power in (Power.OFF, Power.FAULT), False]


def test_the_hash_of_cyclic_segments_is_of_all_of_them_in_their_order() -> None:
    digests = {"b": "22", "a": "11"}
    segments = {
        name: SimpleNamespace(hexdigest=lambda text=text: text) for name, text in digests.items()
    }
    found = cyclic.CyclicSegments.hexdigest(parts(segments=segments))
    assert found == sha256(b"2211").hexdigest()


@pytest.mark.parametrize(
    ("fault", "built_on"),
    [
        (("Y", ""), "b"), (("X", ""), "a"), (("", "a"), "a"), (("", "b"), "b"), (("Z", "a"), "a"),
        (("", "elsewhere"), None),
    ],
)  # fmt: skip
def test_a_fault_is_built_in_on_its_segment_or_that_of_its_axis(
    monkeypatch: pytest.MonkeyPatch, fault: tuple[str, str], built_on: str | None
) -> None:
    """None where another carrier has it."""
    given: Any = SimpleNamespace(kind="image_lost", axis=fault[0], segment=fault[1])
    monkeypatch.setattr(cyclic, "ON_IMAGES", {"image_lost": lambda on, *_: on.segment})
    segments = {"a": "a", "b": "b"}
    of_images = parts(segments=segments, nodes={})
    assert cyclic.CyclicSegments.build_fault(of_images, given, Random(1), None) == built_on  # type: ignore[arg-type]
    monkeypatch.setattr(ethercat, "ON_LINES", {"image_lost": lambda on, *_: on.line})
    lines = {name: SimpleNamespace(faults=name) for name in segments}
    of_lines = parts(lines=lines, nodes={})
    assert ethercat.EthercatLines.build_fault(of_lines, given, Random(1), None) == built_on  # type: ignore[arg-type]


# --- lines


def line(name: str, axes: list[str], *, reads: bool = True, limit_ns: int = 0) -> Any:
    settings = SimpleNamespace(clock_limit_ns=limit_ns, reads_differences=reads)
    return SimpleNamespace(
        axes=axes, start=f"start of {name}", carrier=f"carrier of {name}",
        master=SimpleNamespace(line=settings, clocks_off_ns=limit_ns // 2),
        watches={axis: lambda carrier, axis=axis: (axis, carrier) for axis in axes},
    )  # fmt: skip


@pytest.fixture
def lines() -> Any:
    """X alone on a line whose clocks are watched, Y and Z on one where they are not."""
    made = {"a": line("a", ["X"], limit_ns=700), "b": line("b", ["Y", "Z"], reads=False)}
    found: Any = object.__new__(ethercat.EthercatLines)
    found._bench, found.lines = parts()._bench, made
    return found


def test_each_axis_starts_with_its_own_line_at_its_own_place(
    monkeypatch: pytest.MonkeyPatch, lines: Any
) -> None:
    monkeypatch.setattr(ethercat, "SlaveStart", lambda *words: words)
    found = {axis: lines.start_up(axis) for axis in "XYZ"}
    assert found == {"X": ("start of a", 0), "Y": ("start of b", 0), "Z": ("start of b", 1)}
    assert [lines.watch(axis) for axis in "XYZ"] == [
        ("X", "carrier of a"), ("Y", "carrier of b"), ("Z", "carrier of b")
    ]  # fmt: skip


def test_clocks_have_a_limit_on_the_lines_where_they_are_watched(lines: Any) -> None:
    lines.lines["b"].master.line.clock_limit_ns = 900
    assert [lines.clock_limit_ns(axis) for axis in "XYZ"] == [700, None, None]
    lines.lines["b"].master.line.reads_differences = True
    assert [lines.clock_limit_ns(axis) for axis in "XYZ"] == [700, 900, 900]
    assert [lines.clocks_off_ns(axis) for axis in "XYZ"] == [350, 0, 0]


# --- sensors in the record


@pytest.mark.parametrize(
    ("name", "variable"), [("GAP", "V.E.GAP"), ("V.E.GAP", "V.E.GAP"), ("OTHER", "")]
)
@pytest.mark.parametrize("referenced", [set[str](), {"Z"}, {CHANNEL}, {"Z", CHANNEL}])
def test_a_sensor_of_the_plc_is_named_and_a_zero_is_that_of_its_own_control(
    name: str, variable: str, referenced: set[str]
) -> None:
    """A variable that no entry of `[plc]` gives is the program's own."""
    sensor = VariableSensor(name, {}, SimpleNamespace(ref_offset_mm=0.0))  # type: ignore[arg-type]
    log = SimpleNamespace(
        recorded=lambda axis: (f"changes of {axis}",), orders=lambda axis: (f"orders of {axis}",),
        dumps=lambda _channel: ("dump",), guides=("guide",),
    )  # fmt: skip
    distance = SimpleNamespace(
        axes={"Z": SimpleNamespace(sensor=sensor)}, channel=SimpleNamespace(sensor=sensor)
    )
    machine: Any = SimpleNamespace(
        settings=SimpleNamespace(rig=SimpleNamespace(plc={"V.E.GAP": None})),
        channel=SimpleNamespace(distance=distance), referenced=referenced, distance_log=log,
    )  # fmt: skip
    of_axis, of_channel = facts._distance(machine, "Z"), facts._distance_3d(machine)
    assert of_channel is not None
    assert (of_axis.variable, of_axis.is_referenced) == (variable, "Z" in referenced)
    assert (of_channel.variable, of_channel.is_referenced) == (variable, CHANNEL in referenced)
    assert (of_axis.changes, of_axis.orders) == (("changes of Z",), ("orders of Z",))
    assert of_channel.changes == (f"changes of {CHANNEL}",)
    assert (of_channel.diagnosis, of_channel.guides) == (("dump",), ("guide",))
    distance.channel = None
    assert facts._distance_3d(machine) is None
