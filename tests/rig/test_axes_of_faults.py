"""Which axes and places a fault of a rig belongs to, by the word that its kind has for targets."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import pytest

from axisrig.bench.rig.reading.fault_targets import axes_of, is_target, place_of, targets
from axisrig.bench.rig.reading.faults import fault_kinds, read_faults
from axisrig.bench.rig.reading.file import RigFile, read_rig
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
TELEGRAM, SIGNAL, SENSOR, AXIS = ("telegram",), ("signal",), ("sensor",), ("axis",)
MIXED, OF_TERMINAL = "probe-xyz-mixed.toml", "plc-timestamp.toml"


@cache
def rig_of(name: str) -> RigFile:
    return read_rig(RIGS / name)[0]


def over(folder: Path, base: str, text: str) -> RigFile:
    path = folder / "rig.toml"
    path.write_text(f'base = "{(RIGS / base).as_posix()}"\n{text}\n', encoding="utf-8")
    return read_rig(path)[0]


@pytest.mark.parametrize(
    ("rig", "words", "target", "axes"),
    [
        ("probe-xyz.toml", TELEGRAM, "Y.TPDO1", ("Y",)),
        ("probe-xyz.toml", ("bus", "axis"), "Y", ("Y",)),
        ("probe-xyz.toml", ("bus", "axis"), "can2", ("Y",)),
        (MIXED, TELEGRAM, "can1.SYNC", ("X",)),
        (MIXED, ("line",), "ec1", ("Z",)),
        ("probe-xyz.toml", SIGNAL, "probe", ("X", "Y", "Z")),
        ("distance-xz.toml", SENSOR, "gap", ("Z",)),  # a second encoder
        ("distance-xz.toml", ("input",), "gap.offset", ("Z",)),
        ("distance-xz.toml", ("input",), "x.force", ("X",)),
        ("distance-xz.toml", ("input",), "z.force", ("Z",)),
        ("probe-xyz.toml", ("input",), "probe.switched_on", ("X", "Y", "Z")),
        ("probe-xyz.toml", ("plc",), "plc", ("X", "Y", "Z")),  # of no axis: of all
        (OF_TERMINAL, ("terminal",), "terminal", None),
        ("plc-io-node.toml", TELEGRAM, "terminal.TPDO1", None),
    ],
)
def test_a_fault_begins_at_moments_of_the_axes_that_it_touches(
    rig: str, words: Sequence[str], target: str, axes: tuple[str, ...] | None
) -> None:
    """In the order of the rig; None: all axes."""
    assert axes_of(target, words, rig_of(rig)) == (axes or tuple(rig_of(rig).axis))


def test_a_probe_of_one_drive_is_of_its_axis_alone(tmp_path: Path) -> None:
    """Each input counts, and a plant that no axis has anything of is of all."""
    keys = ("probe_2", "limit_negative", "limit_positive", "home_switch")
    for key in keys:
        text = f'[axis.Y]\n{key} = "own"\n[plant.own]\nfmu = "AxisRig.Sensors.TouchProbe"\n'
        rig = over(tmp_path, "probe-xyz.toml", text + 'wire = { y = "y" }')
        assert axes_of("own", SIGNAL, rig) == ("Y",), key
        assert axes_of("probe", SIGNAL, rig) == ("X", "Y", "Z")
        assert "own" in targets(SIGNAL, rig)
        assert axes_of("own.x", ("input",), rig) == ("Y",)
    alone = '[plant.own]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { y = "y" }'
    assert axes_of("own", SIGNAL, over(tmp_path, "probe-xyz.toml", alone)) == ("X", "Y", "Z")


def test_probes_of_the_terminal_come_after_those_of_the_drives_each_once(tmp_path: Path) -> None:
    found = targets(SIGNAL, rig_of(OF_TERMINAL))
    assert found == ["probe"]
    second = (
        '[plc.terminal]\ninput_2 = "other"\n[plant.other]\nfmu = "AxisRig.Sensors.TouchProbe"\n'
    )
    (axis, *_) = rig_of(OF_TERMINAL).axis
    text = f'{second}wire = {{ z = "z" }}\n[axis.{axis}]\nprobe_1 = "probe"'
    assert targets(SIGNAL, over(tmp_path, OF_TERMINAL, text)) == ["probe", "other"]


def test_the_load_is_no_sensor_and_a_sensor_is_named_once(tmp_path: Path) -> None:
    load = over(tmp_path, "distance-xz.toml", '[axis.X]\nencoder_2 = "load"')
    assert targets(SENSOR, load) == ["gap"]
    both = over(tmp_path, "distance-z-variable.toml", '[axis.Z]\nencoder_2 = "gap"')
    assert targets(SENSOR, both) == ["gap"]
    with pytest.raises(UserError) as caught:
        read_faults("sensor_drift", "load um_s=1", load)
    assert (caught.value.value, caught.value.allowed) == ("load", "gap")


@pytest.mark.parametrize("kind", ["probe_stick", "sensor_freeze", "reset", "drop", "plc_lost"])
def test_an_input_of_a_plant_is_a_target_of_that_kind_alone(kind: str) -> None:
    rig = rig_of("distance-xz.toml")
    assert is_target("gap.offset", fault_kinds()["plant_input"].targets, rig)
    assert not is_target("gap.offset", fault_kinds()[kind].targets, rig)
    assert not is_target("gap", ("input",), rig)
    assert not is_target("gap.", ("input",), rig)
    assert not is_target("nothing.offset", ("input",), rig)
    assert place_of("gap.offset", ("input",), rig) == ("", "", "")


@pytest.mark.parametrize(
    ("rig", "found"), [(OF_TERMINAL, True), ("plc-io-node.toml", False), ("probe-xyz.toml", False)]
)
def test_only_a_terminal_of_its_own_has_a_clock_of_its_own(rig: str, found: bool) -> None:
    """A node is sampled at the SYNC; one on a line has the clock of the line."""
    assert targets(("terminal",), rig_of(rig)) == ["terminal"] * found
    line = targets(("terminal",), rig_of("plc-timestamp-line.toml"))
    assert line == []


@pytest.mark.parametrize(
    ("target", "first", "last"),
    [
        ("Z.TPDO7", "Z.TPDO1", "Z.HEARTBEAT"),
        ("can2.TPDO1", "can2.SYNC", "can2.NMT"),
        ("Z.", "Z.TPDO1", "Z.HEARTBEAT"),
        ("W.TPDO1", "X.TPDO1", "can3.NMT"),  # no place of the rig: all there are
        ("TPDO1", "X.TPDO1", "can3.NMT"),
    ],
)
def test_a_telegram_that_there_is_not_is_shown_those_of_its_place(
    target: str, first: str, last: str
) -> None:
    with pytest.raises(UserError) as caught:
        read_faults("drop", target, rig_of("probe-xyz.toml"))
    allowed = str(caught.value.allowed).split(", ")
    assert caught.value.value == target
    assert (allowed[0], allowed[-1]) == (first, last)
    place = first.partition(".")[0]
    assert (last.partition(".")[0] == place) is all(
        name.startswith(f"{place}.") for name in allowed
    )


@pytest.mark.parametrize(
    ("rig", "has"),
    [
        ("plc-io-node.toml", True),
        ("plc-timestamp-line.toml", False),
        (OF_TERMINAL, False),
        ("plc-drive-input.toml", False),
        ("probe-xyz.toml", False),
    ],
)
def test_only_a_node_on_can_sends_telegrams_of_a_terminal(rig: str, has: bool) -> None:
    """One on a line is part of its frame, one of its own is on the fieldbus of the PLC."""
    found = [name for name in targets(TELEGRAM, rig_of(rig)) if name.startswith("terminal.")]
    assert bool(found) is has
    assert axes_of("can1.SYNC", TELEGRAM, rig_of("plc-io-node.toml")) == tuple(
        name for name, axis in rig_of("plc-io-node.toml").axis.items() if axis.segment == "can1"
    )


@pytest.mark.parametrize(
    ("rig", "kind", "words", "hint"),
    [
        ("probe-xyz.toml", "drop", "no such telegram", None),
        ("probe-xyz.toml", "reset", "no such place of a fault", None),
        ("probe-xyz.toml", "probe_stick", "no such place of a fault", None),
        ("probe-xyz.toml", "plc_lost", "no such place of a fault: the rig has no plc", "plc_lost"),
        (
            "probe-xyz.toml",
            "line_lost",
            "no such place of a fault: the rig has no line",
            "line_lost",
        ),
        (
            "probe-xyz.toml",
            "sensor_full",
            "no such place of a fault: the rig has no sensor",
            "sensor_full",
        ),
    ],
)
def test_a_place_that_there_is_not_is_named_by_what_the_kind_acts_on(
    rig: str, kind: str, words: str, hint: str | None
) -> None:
    with pytest.raises(UserError) as caught:
        read_faults(kind, "nowhere", rig_of(rig))
    assert caught.value.message == words
    assert caught.value.hint == (None if hint is None else f"axisrig faults {hint}")
    assert bool(caught.value.allowed) is (hint is None)
