"""Lines of `axisrig check` on axes, sensors and carriers, and names that axes may have."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.rig.canopen import family as canopen
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.cyclic.family import FAMILY as CYCLIC
from axisrig.bench.rig.describe import describe_axes, unproved_place
from axisrig.bench.rig.families import family_of, family_on, rig_families
from axisrig.bench.rig.sercos.keys import DriveTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Make = Callable[..., Settings]


@pytest.fixture
def make(tmp_path: Path, rig_above: Make) -> Make:
    """Return `make(base, TOML above it, *assignments)`, with a list `own.lst` beside the rig."""
    (tmp_path / "own.lst").write_text("getriebe[0].window 100\n", encoding="utf-8")
    return rig_above


def test_each_axis_is_reported_with_what_belongs_to_it(make: Make) -> None:
    text = '[axis.Y]\nencoder_2 = "load"'
    lines = describe_axes(make("probe-xyz-mixed.toml", text))
    wired = "probe_1 = probe, probe_2 = probe"
    assert lines[:3] == [
        f"axis X: node 1 on can1, drive servo (profile generic), plant x, {wired}",
        f"axis Y: node 2 on can2, drive servo (profile generic), plant y, {wired},"
        " encoder_2 = load",
        f"axis Z: on ec1, drive servo (profile generic), plant z, {wired}",
    ]
    assert len(lines) == 3
    assert any(line.endswith("no probe wired") for line in describe_axes(make("gantry-x.toml")))


@pytest.mark.parametrize(
    ("base", "text", "unread"),
    [
        ("probe-z.toml", "", []),
        ("probe-z.toml", '[plant.other]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { z = "z" }',
         ["other"]),
        ("distance-z-variable.toml", "", []),  # the PLC reads it
        ("plc-timestamp.toml", "", []),  # its terminal does
        ("plc-radio.toml", "", []),  # its task switches it
    ],
)  # fmt: skip
def test_a_sensor_that_nobody_reads_is_warned_of(
    make: Make, base: str, text: str, unread: list[str]
) -> None:
    lines = [line for line in describe_axes(make(base, text)) if "nobody reads" in line]
    assert lines == [
        f"warning: {name} is wired to no input of a drive: nobody reads it" for name in unread
    ]


OTHER = '[plant.{0}]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = {{ z = "z" }}\n'


@pytest.mark.parametrize(
    ("base", "reader"),
    [
        ("probe-z.toml", '[axis.Z]\nprobe_1 = "{0}"'),
        ("probe-z.toml", '[axis.Z]\nprobe_2 = "{0}"'),
        ("probe-z.toml", '[axis.Z]\nencoder_2 = "{0}"'),
        ("probe-z.toml", '[axis.Z]\nhome_switch = "{0}"'),
        ("plc-radio.toml", '[plc]\nswitches = "{0}"'),  # in place of the one that the drive has
        ("plc-signal.toml", '[plc.terminal]\ninput_1 = "{0}"'),
        ("plc-signal.toml", '[plc.terminal]\ninput_2 = "{0}"'),
        ("plc-io-node.toml", '[plc.terminal]\ninput_2 = "{0}"'),
        ("probe-z.toml", '[plc]\n"V.E.OWN" = {{ sensor = "{0}" }}'),
    ],
)
def test_each_reader_of_a_sensor_counts_alone(make: Make, base: str, reader: str) -> None:
    """Of two sensors it reads the one that it names, and the other one is warned of."""
    sensors = OTHER.format("one") + OTHER.format("two")
    for name, other in (("one", "two"), ("two", "one")):
        lines = describe_axes(make(base, f"{reader.format(name)}\n{sensors}"))
        unread = [line.split()[1] for line in lines if "nobody reads" in line]
        assert other in unread
        assert name not in unread
        assert lines[-len(unread) :] == [
            f"warning: {each} is wired to no input of a drive: nobody reads it" for each in unread
        ]


def test_unread_sensors_are_named_in_the_order_of_the_rig(make: Make) -> None:
    names = ("b", "a", "c")
    lines = describe_axes(make("probe-z.toml", "".join(OTHER.format(name) for name in names)))
    assert [line.split()[1] for line in lines if "nobody reads" in line] == [*names]


@pytest.mark.parametrize(
    ("base", "offset_us", "words"),
    [
        ("plc-timestamp.toml", 300, "terminal: input 1 = probe;"),
        ("plc-io-node.toml", 550, "terminal: node 20 on can1, input 1 = probe;"),
        ("plc-timestamp-line.toml", 300, "terminal: last slave on ec1, input 1 = probe;"),
    ],
)
def test_the_task_of_a_plc_is_reported_with_its_terminal(
    make: Make, base: str, offset_us: int, words: str
) -> None:
    """An edge waits for one cycle of 2 ms of the task, and before that for a cycle of the terminal,
    2 ms too, or for two SYNCs of 1 ms.
    """
    (line,) = [line for line in describe_axes(make(base)) if line.startswith("PLC task: ")]
    assert line.startswith(f"PLC task: every 2000 us from {offset_us} us on, program ")
    assert words in line
    assert line.endswith(" is in its outputs 4 ms later at most")


def test_an_unproved_place_has_its_reason(make: Make) -> None:
    settings = make("probe-z.toml")
    assert unproved_place(settings, "Z").endswith("position_check of drive servo is false")
    assert unproved_place(settings, "Z", "the bus is full").endswith(": the bus is full")


@pytest.mark.parametrize("base", ["probe-z-ethercat.toml", "probe-z-sercos.toml", "probe-z.toml"])
@pytest.mark.parametrize("position", [True, False])
@pytest.mark.parametrize("latch", [True, False])
def test_places_and_latches_without_a_proof_are_warned_of_each_by_its_own_key(
    make: Make, base: str, position: bool, latch: bool
) -> None:
    """position_check proves the place from which an axis is led, latch_check its latches."""
    keys = {"position_check": position, "latch_check": latch}
    changes = [f"drive:servo.{key}={str(value).lower()}" for key, value in keys.items()]
    settings = make(base, "", *changes)
    lines = family_of(settings, "Z").describe(settings)
    unproved = [line for line in lines if "position from which its drive is led" in line]
    assert unproved == ([] if position else [unproved_place(settings, "Z")])
    said = [line for line in lines if "latch_check" in line or "nothing proves it" in line]
    assert len(said) == (0 if latch else 1)
    proved = [line for line in lines if "SDO proves" in line or "channel proves it" in line]
    assert len(proved) == (1 if latch else 0)


@pytest.mark.parametrize(
    ("name", "is_good"),
    [
        *((name, True) for name in ("A", "X2", "C123", "X2_Table", "Q", "W1", "U_a")),
        *((name, False) for name in ("D", "F", "G1", "M", "N", "S", "T", "X1234", "XA", "x", "E")),
    ],
)
def test_an_axis_has_a_name_that_programs_can_call(make: Make, name: str, is_good: bool) -> None:
    """The letters of addresses of axes, alone, with up to three digits, or with a name behind _."""
    assert ("needs a name of its own" in _refusal(make, name)) is not is_good


def _refusal(make: Make, *names: str) -> str:
    """Return the refusal of further axes of these names, "" where they are taken."""
    text = "".join(
        f'[axis.{name}]\nlist = "own.lst"\nsegment = "can1"\nnode = {node}\ndrive = "servo"\n'
        f'plant = "p{node}"\n[plant.p{node}]\nfmu = "AxisRig.Drives.ServoAxis"\n'
        for node, name in enumerate(names, 9)
    )
    try:
        check_rig(make("probe-z.toml", f'{text}[segment.can1]\noverload = "run"'))
    except UserError as error:
        return " ".join([error.message, *(one.message for one in error.further)])
    return ""


@pytest.mark.long
def test_two_spellings_of_one_name_are_refused(make: Make) -> None:
    assert "needs a name of its own" in _refusal(make, "X2_Table", "X2_TABLE")
    assert _refusal(make, "X2_Table", "X2_Tail") == ""


# --- carriers


def test_each_carrier_has_one_family_in_the_order_of_the_registry(make: Make) -> None:
    settings = make("probe-xyz-mixed.toml")
    can, line = family_of(settings, "X"), family_of(settings, "Z")
    assert (family_of(settings, "Y"), family_on(settings, "ec1")) == (can, line)
    assert can is not line
    assert rig_families() == [can, line, CYCLIC]
    assert [one.fault_rooms[0] for one in rig_families()] == ["frames", "lines", "images"]
    assert [one.has_objects for one in rig_families()] == [True, True, False]


def test_a_cyclic_segment_says_its_instants_and_when_values_are_seen(make: Make) -> None:
    """What the NC cycle at 600 us computes is swapped at 1200 and acts at 1900 us; the next sample
    is at 2875, swapped at 3200 us and read at 3600 us, 3 cycles later.
    """
    changes = ("input_us=125", "bus_us=200", "output_us=900")
    settings = make("probe-z-profidrive.toml", "", *(f"bus:bus.{one}" for one in changes))
    last = CYCLIC.describe(settings)[-1]
    assert last.startswith(
        "axis Z: positions sampled 125 us before a cycle, images swapped at 200 us, set values"
        " taken at 900 us; what an NC cycle sends is seen 3 cycles later"
    )
    assert CYCLIC.late_cycles(settings, "Z") == 1


@pytest.mark.parametrize(
    ("telegram", "words", "every"),
    [
        ({"transmission": 1}, "with every SYNC", 1),
        ({"transmission": 4}, "with every 4. SYNC", 4),
        ({"transmission": 254}, "when it changes", 1),
        ({"transmission": 254, "event_ms": 20}, "when it changes, every 20 ms at least", 1),
        # No earlier than 2.5 ms after the one before, in cycles of 1 ms
        ({"transmission": 255, "inhibit_100us": 25}, "when it changes", 3),
    ],
)
def test_a_telegram_comes_with_its_sync_or_when_it_changes(
    telegram: dict[str, int], words: str, every: int
) -> None:
    given = {"event_ms": 0, "inhibit_100us": 0, **telegram}
    one: Any = SimpleNamespace(is_cyclic=given["transmission"] <= 240, **given)
    assert (canopen._comes(one), canopen._every(one, 1000)) == (words, every)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("", "the lead is NOT compared with the drive"),
        ("scaling_check = false", "NOT compared with the drive"),
        ("position_unit_um = 0.5", "compared with the drive at its start"),
    ],
)
def test_a_real_drive_is_reported_with_what_nobody_checks(
    make: Make, keys: str, words: str
) -> None:
    text = f"[drive.servo]\nencoder_increments = 4096\nlead_mm = 5.0\n{keys}\n"
    text += '[segment.can1]\ninterface = "socketcan"\nchannel = "can7"'
    found = canopen.FAMILY.outside(make("probe-z.toml", text), "Z")
    per_mm = "2000" if "unit" in keys else "819.2"
    assert found.startswith("drive with node 3 on socketcan can7;")
    assert "encoder 4096 increments per revolution, lead 5 mm" in found
    assert found.endswith(f"{per_mm} position units per mm ({words})")


@pytest.mark.parametrize(
    ("key", "where"), [("channel = 0", "pcan 0"), ('channel = "0"', "pcan 0"), ("", "pcan")]
)
def test_a_real_bus_is_reported_with_its_channel_if_it_has_one(
    make: Make, key: str, where: str
) -> None:
    """Some interfaces count their channels from 0 on."""
    text = f'[segment.can1]\ninterface = "pcan"\n{key}'
    found = canopen.FAMILY.outside(make("probe-z.toml", text), "Z")
    assert found.startswith(f"drive with node 3 on {where};")


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({}, "2^20 increments a turn"),
        ({"resolution": 1}, "2^0 increments a turn"),
        ({"resolution": 1 << 30}, "2^30 increments a turn"),
        ({"resolution": 1_000_000}, "1000000 increments a turn"),
        ({"resolution": 3_600_000, "scaling": "linear"}, "0.1 um"),
    ],
)
def test_positions_of_a_sercos_drive_are_in_increments_or_in_tenths_of_um(
    keys: dict[str, Any], words: str
) -> None:
    """A power of two is written as one; S-0-0076 linear counts in 0.1 um whatever it is."""
    drive = DriveTable.model_validate({"family": "sercos", **keys})
    assert drive.in_words.endswith(f", positions in {words}")
