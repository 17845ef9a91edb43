"""What the control's end of a drive knows, for each family: each value from its own key or list.

Every key has another value than its default, so that a value from a neighbour shows. Units are
those of the lists (docs/parameters.md): P-AXIS-00212 um/s, P-AXIS-00099 0.01/s.
"""

from collections.abc import Callable
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from tests.machine import made_rigs
from tests.machine.made_rigs import above

from axisrig.bench.bus.ethercat.segment import Link
from axisrig.bench.machine.canopen.links import build_links
from axisrig.bench.machine.cyclic.profidrive_drive import profidrive_settings
from axisrig.bench.machine.cyclic.speed_drive import speed_drive_settings
from axisrig.bench.machine.ethercat import cia402_slave, line, sercos_slave
from axisrig.bench.machine.ethercat.cia402_slave import slave_settings
from axisrig.bench.machine.ethercat.sercos_slave import sercos_settings
from axisrig.bench.rig.ethercat.keys import SegmentTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.ethercat.link import make_data
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.drives.sercos.data import TelegramData
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.time.clock import MS, S
from axisrig.kernel.time.scheduler import new_scheduler


class Network:
    """A segment on which nothing is sent."""

    def subscribe(self, *_: Any) -> None:
        pass


def settings_of(folder: Path, base: str, text: str, *changes: str) -> Settings:
    return made_rigs.settings_of(above(folder, base, text), *changes)


def can_links(settings: Settings) -> dict[str, Any]:
    networks = {name: Network() for name in settings.segment}
    return dict(build_links(settings, networks, new_scheduler()))


def of_can(settings: Settings, name: str) -> Any:
    link: Drive = can_links(settings)[name]
    return link.settings


Read = Callable[[Settings, str], Any]
FAMILIES: dict[str, tuple[str, Read]] = {
    "can": ("probe-z.toml", of_can),
    "ethercat": ("probe-z-ethercat.toml", slave_settings),
    "sercos": ("probe-z-sercos.toml", sercos_settings),
    "profidrive": ("probe-z-profidrive.toml", profidrive_settings),
    "conventional": ("probe-z-conventional.toml", speed_drive_settings),
    "encoder_terminal": ("probe-z-encoder-terminal.toml", speed_drive_settings),
    "lightbus": ("probe-z-lightbus.toml", speed_drive_settings),
}
LISTED = (
    "set:Z.getriebe[0].dynamik.vb_max=400000",
    "set:Z.getriebe[0].dynamik.a_max=3000",
    "set:Z.antr.nbr_delay_cycles=5",
)
OF_DRIVE = ("jump_factor=3", "lag_limit_mm=1.5", "fault_reset=true", "missing_cycles=7")


@pytest.mark.parametrize("family", FAMILIES)
def test_limits_of_a_drive_are_those_of_its_keys_and_its_list(family: str, tmp_path: Path) -> None:
    """A way between two SYNCs of at most 3 x 400 mm/s x 1 ms = 1.2 mm."""
    base, read = FAMILIES[family]
    keys = [f"drive:servo.{key}" for key in OF_DRIVE]
    found = read(settings_of(tmp_path, base, "", *LISTED, *keys), "Z")
    assert found.axis == "Z"
    assert found.jump_mm == pytest.approx(1.2)
    assert (found.lag_limit_mm, found.fault_reset, found.missing_cycles) == (1.5, True, 7)
    assert (found.lag_delay_cycles, found.acceleration_mm_s2) == (5, 3000.0)
    assert (found.edge, found.sensor_age_limit_ms) == ("POS", None)
    plain = settings_of(tmp_path, base, "", "drive:servo.jump_factor=0")
    known = read(plain, "Z")
    assert (known.jump_mm, known.lag_limit_mm, known.fault_reset) == (inf, inf, False)
    # P-AXIS-00003 is larger: an axis that stops by itself
    stopping = settings_of(tmp_path, base, "", "set:Z.getriebe[0].dynamik.a_emergency=9000")
    assert read(stopping, "Z").acceleration_mm_s2 == 9000.0


@pytest.mark.parametrize("family", FAMILIES)
def test_a_way_between_two_syncs_is_longer_in_a_longer_cycle(family: str, tmp_path: Path) -> None:
    base, read = FAMILIES[family]
    text = "[cycle]\nperiod_us = 2000\ncycle_offset_us = 1200"
    found = read(settings_of(tmp_path, base, text, *LISTED), "Z")
    assert found.jump_mm == pytest.approx(2 * 0.4 * 2.0)  # the usual factor is 2
    if family not in ("can", "ethercat", "sercos"):
        assert found.period_s == pytest.approx(2e-3)


PER_MM = {
    # 2000 a turn of 5 mm, or lines of the encoder counted four times, or with 2^p1042 parts each
    "can": ("encoder_increments=2000", 400.0),
    "ethercat": ("encoder_increments=2000", 400.0),
    "sercos": ("encoder_increments=1048576", (1 << 20) / 5.0),
    "profidrive": ("lines=500", 500 * 2**11 / 5.0),
    "conventional": ("lines=500", 4 * 500 / 5.0),
    "encoder_terminal": ("lines=500", 4 * 500 / 5.0),
    "lightbus": ("rpm_at_full=1500", (1 << 20) / 5.0),
}


@pytest.mark.parametrize("family", FAMILIES)
def test_increments_belong_to_the_lead_of_the_screw(family: str, tmp_path: Path) -> None:
    base, read = FAMILIES[family]
    key, per_mm = PER_MM[family]
    changes = ["drive:servo.lead_mm=5", f"drive:servo.{key}"]
    settings = settings_of(tmp_path, base, "", *changes)
    found = read(settings, "Z")
    assert found.increments_per_mm == pytest.approx(per_mm)
    if family == "sercos":
        assert found.lead_mm == 5.0


@pytest.mark.parametrize(
    ("family", "rpm", "counts"),
    [
        ("conventional", "rpm_at_10v=1500", 32767 / (1500 / 60 * 10)),
        ("encoder_terminal", "rpm_at_10v=1500", 32767 / (1500 / 60 * 10)),
        ("lightbus", "rpm_at_full=6000", 32767 / (6000 / 60 * 10)),
    ],
)
def test_a_speed_is_a_share_of_the_full_output(
    family: str, rpm: str, counts: float, tmp_path: Path
) -> None:
    """32767 at so many turns of 10 mm; the loop has Kv of P-AXIS-00099 and the feed-forward."""
    base, read = FAMILIES[family]
    forward = ("set:Z.vorsteuer.vorsteuerung=1", "set:Z.vorsteuer.default_active=1",
               "set:Z.vorsteuer.vs_v_faktor=3", "set:Z.vorsteuer.vs_v_nenner=4")  # fmt: skip
    settings = settings_of(
        tmp_path, base, "", f"drive:servo.{rpm}", "set:Z.getriebe[0].kv=2500", *forward
    )
    found = read(settings, "Z")
    assert found.speed_counts == pytest.approx(counts)
    assert (found.loop.kv_per_s, found.loop.period_s, found.loop.feed_forward) == (25.0, 1e-3, 0.75)


def test_a_speed_of_profidrive_is_a_share_of_the_base_value(tmp_path: Path) -> None:
    """NSOLL_B has 2^30 at P0880, which P-AXIS-00379 repeats: 3000 rpm of 5 mm are 250 mm/s."""
    settings = settings_of(
        tmp_path, "probe-z-profidrive.toml", "",
        "drive:servo.lead_mm=5", "set:Z.antr.profibus.drive_velocity_base_value=3000",
        "drive:servo.position_check=false", "set:Z.vorsteuer.vorsteuerung=1",
        "set:Z.vorsteuer.default_active=1", "set:Z.vorsteuer.vs_v_faktor=1",
        "set:Z.vorsteuer.vs_v_nenner=2",
    )  # fmt: skip
    found = profidrive_settings(settings, "Z")
    assert found.speed_counts == pytest.approx(2**30 / 250.0)
    assert (found.proves_places, found.feed_forward, found.period_s) == (False, 0.5, 1e-3)
    assert found.telegram.number == 5


@pytest.mark.parametrize(
    ("input_us", "output_us", "cycles"), [(0, 0, 2), (200, 500, 2), (200, 900, 3), (0, 900, 2)]
)
@pytest.mark.parametrize("family", ["profidrive", "conventional", "lightbus"])
def test_an_image_shows_what_was_sent_after_the_cycles_of_its_segment(
    family: str, input_us: int, output_us: int, cycles: int, tmp_path: Path
) -> None:
    """Sent with swap k + 1, taken at k + 1 + T_O; in the sample of k + 2 - T_I if that is later."""
    base, read = FAMILIES[family]
    plain = settings_of(tmp_path, base, "")
    segment = plain.rig.axis["Z"].segment
    text = f"[segment.{segment}]\ninput_us = {input_us}\noutput_us = {output_us}"
    assert read(settings_of(tmp_path, base, text), "Z").echo_cycles == cycles


def test_a_slave_has_to_show_the_identity_of_its_keys(tmp_path: Path) -> None:
    """1018: sub-index 1 is the vendor, 4 the serial number."""
    text = "[drive.servo]\nidentity = { vendor = 7, serial = 9 }"
    found = slave_settings(settings_of(tmp_path, "probe-z-ethercat.toml", text), "Z")
    assert found.identity == {1: 7, 4: 9}
    assert slave_settings(settings_of(tmp_path, "probe-z-ethercat.toml", ""), "Z").identity == {}


@pytest.mark.parametrize(
    ("family", "base"), [("can", "probe-xyz"), ("ethercat", "probe-xyz-ethercat")]
)
def test_each_axis_has_the_values_of_its_own_drive_and_list(
    family: str, base: str, tmp_path: Path
) -> None:
    """Y has another drive than X and Z, measures with input 2 and the falling edge."""
    text = (
        "[drive.other]\nencoder_increments = 4000\nlead_mm = 4.0\nmissing_cycles = 9\n"
        "lag_limit_mm = 0.5\nhoming_limit_s = 12.5\nfault_reset = true\njump_factor = 4.0\n"
        "latch_check = false\nposition_check = false\n"
        '[axis.Y]\ndrive = "other"\nsensor_age_limit_ms = 40'
    )
    listed = (
        "set:Y.kenngr.measure.input=2", "set:Y.kenngr.measure.edge=NEG",
        "set:Y.antr.canopen.probing_trigger_source=DRIVE_DEFINED",
        "set:Y.getriebe[0].dynamik.vb_max=100000", "set:Y.getriebe[0].dynamik.a_max=7000",
    )  # fmt: skip
    settings = settings_of(tmp_path, f"{base}.toml", text, *listed)
    read = FAMILIES[family][1]
    x, y, z = (read(settings, name) for name in "XYZ")
    assert [one.node_id for one in (x, y, z)] == [1, 2, 3]
    assert (y.increments_per_mm, x.increments_per_mm) == (1000.0, z.increments_per_mm)
    assert z.increments_per_mm == pytest.approx((1 << 20) / 10)
    assert (y.probe_input, y.edge, y.trigger_source) == (2, "NEG", "DRIVE_DEFINED")
    assert [(one.probe_input, one.edge) for one in (x, z)] == [(1, "POS")] * 2
    assert (y.missing_cycles, y.lag_limit_mm, y.homing_limit_ns) == (9, 0.5, 12.5 * S)
    assert (y.fault_reset, y.jump_mm, y.acceleration_mm_s2) == (True, pytest.approx(0.4), 7000.0)
    assert (x.fault_reset, x.lag_limit_mm, x.acceleration_mm_s2) == (False, inf, 1000.0)
    assert (y.sensor_age_limit_ms, x.sensor_age_limit_ms) == (40, None)
    assert x.homing_limit_ns == z.homing_limit_ns == 300 * S  # docs/rigs.md


def test_a_latch_is_proved_where_its_own_drive_has_it_so(tmp_path: Path) -> None:
    """What proves a latch, or a place, is the SDO client of the same drive."""

    def proved(text: str) -> dict[str, tuple[bool, bool]]:
        links = can_links(settings_of(tmp_path, "probe-xyz.toml", text))
        return {
            name: (link._checked_by is link.sdo, link.place_check is not None)
            for name, link in links.items()
        }

    assert proved("") == dict.fromkeys("XYZ", (True, True))
    text = "[drive.other]\nlatch_check = false\n[drive.third]\nposition_check = false\n"
    found = proved(f'{text}[axis.X]\ndrive = "other"\n[axis.Y]\ndrive = "third"')
    assert found == {"X": (False, True), "Y": (True, False), "Z": (True, True)}


ONE, TWO = 1 << 6, 1 << 7
"""Real-time bits 1 and 2 of the words, FCT-C4 6.1."""
PROBE = "set:Z.antr.sercos.probe_{}_realtime_bits"
BITS: dict[tuple[str, ...], tuple[int, int, int, int]] = {
    ("set:Z.kenngr.echtzeit_bit_nr=1",): (ONE, ONE, TWO, 0),
    ("set:Z.kenngr.echtzeit_bit_nr=2",): (TWO, TWO, ONE, 0),
    (f"{PROBE.format(1)}.start_probing.bit_nr=3",): (8, ONE, TWO, 0),
    (f"{PROBE.format(1)}.value_latched.bit_nr=4",): (ONE, 16, TWO, 0),
    (f"{PROBE.format(1)}.probe_actuated.bit_nr=0",): (ONE, ONE, 1, 0),
    ("set:Z.antr.sercos.probing_command_start.bit_nr=2",): (ONE, ONE, TWO, 4),
    # The start bit is that of the probe which measures
    (f"{PROBE.format(2)}.start_probing.bit_nr=3",): (ONE, ONE, TWO, 0),
}


@pytest.mark.parametrize("changes", BITS)
def test_real_time_bits_are_those_of_the_list(changes: tuple[str, ...], tmp_path: Path) -> None:
    settings = settings_of(tmp_path, "probe-z-sercos.toml", "", *changes)
    bits = sercos_settings(settings, "Z").bits
    assert (bits.enable, bits.latched, bits.actuated, bits.command) == BITS[changes]


def test_probe_2_has_a_start_bit_of_its_own_and_the_other_bits_of_probe_1(tmp_path: Path) -> None:
    """P-AXIS-00675 to 00680 are of probe 1, 00681 and 00682 the start bit of probe 2."""
    bits = {"start_probing": 3, "value_latched": 4, "probe_actuated": 5}
    changes = [f"{PROBE.format(1)}.{name}.bit_nr={bit}" for name, bit in bits.items()]
    changes += [f"{PROBE.format(2)}.start_probing.bit_nr=2"]
    for probe, enable in ((1, 1 << 3), (2, 1 << 2)):
        probing = f"set:Z.kenngr.measure.input={probe}"
        settings = settings_of(tmp_path, "probe-z-sercos.toml", "", probing, *changes)
        found = sercos_settings(settings, "Z")
        assert found.probe_input == probe
        assert (found.bits.enable, found.bits.latched, found.bits.actuated) == (
            enable, 1 << 4, 1 << 5
        )  # fmt: skip


def test_a_slave_takes_its_time_both_ways(tmp_path: Path) -> None:
    """slave_ns is that of each way, and wire_ns of the wire before it."""
    keys = ("bus:ec1.wire_ns=X=10 Z=40", "bus:ec1.slave_ns=X=100 Y=900")
    table = settings_of(tmp_path, "probe-xyz-ethercat.toml", "", *keys).segment["ec1"]
    assert isinstance(table, SegmentTable)
    assert [line._link(table, axis) for axis in "XYZ"] == [
        Link(10, 100, 100), Link(50, 900, 900), Link(40, 300, 300)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("change", "field", "value"),
    [
        ("drive:servo.latch_check=false", "proves_latches", False),
        ("drive:servo.position_check=false", "proves_places", False),
        ("drive:servo.probing=none", "starts_probing", False),
        ("set:Z.antr.sercos.evaluate_drive_follows_cmd=1", "needs_following", True),
        ("set:Z.kenngr.messachse=0", "measures", False),
    ],
)
def test_each_key_of_a_sercos_drive_changes_one_flag(
    change: str, field: str, value: bool, tmp_path: Path
) -> None:
    flags = ("proves_latches", "proves_places", "starts_probing", "needs_following", "measures")
    plain = sercos_settings(settings_of(tmp_path, "probe-z-sercos.toml", ""), "Z")
    found = sercos_settings(settings_of(tmp_path, "probe-z-sercos.toml", "", change), "Z")
    assert getattr(found, field) is value
    differing = [name for name in flags if getattr(found, name) is not getattr(plain, name)]
    assert differing == [field]


def test_stamps_of_a_line_count_from_the_instant_of_its_clocks(tmp_path: Path) -> None:
    """System time in ns, latched at SYNC0: `shift_us` after the begin of a cycle; else none."""
    for key, expected in (
        ("shift_us=250", StampClock(1, 0, 250_000)), ("shift_us=0", StampClock(1, 0, 0)),
        ("shift_us=40.5", StampClock(1, 0, 40_500)), ("dc=false", None),
    ):  # fmt: skip
        settings = settings_of(tmp_path, "probe-z-ethercat-stamps.toml", "", f"bus:ec1.{key}")
        assert slave_settings(settings, "Z").stamps == expected, key


@pytest.mark.interpreted
@pytest.mark.parametrize(("timeout_ms", "attempts"), [(70, 5), (1500, 1)])
def test_a_mailbox_waits_and_asks_as_the_keys_of_its_drive_say(
    timeout_ms: int, attempts: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SDO: sdo_timeout_ms and sdo_attempts; the service channel: soe_timeout_ms."""
    made: list[tuple[Any, ...]] = []

    def mailbox(*words: Any) -> Any:
        made.append(words)
        return SimpleNamespace(port="port", channel=SimpleNamespace(read=None))

    monkeypatch.setattr(cia402_slave, "Mailbox", mailbox)
    monkeypatch.setattr(sercos_slave, "ServiceMailbox", mailbox)
    transactions, clock = cast("Any", "transactions"), new_scheduler()
    keys = (f"sdo_timeout_ms={timeout_ms}", f"sdo_attempts={attempts}")
    for base, kind, of_drive, given in (
        ("probe-z-ethercat.toml", cia402_slave.Cia402Ends, keys, (timeout_ms * MS, attempts)),
        ("probe-z-sercos.toml", sercos_slave.SercosEnds, (f"soe_timeout_ms={timeout_ms}",),
         (timeout_ms * MS,)),
    ):  # fmt: skip
        settings = settings_of(tmp_path, base, "", *(f"drive:servo.{key}" for key in of_drive))
        ends: Any = kind.__new__(kind)
        ends._settings, ends._table = settings, settings.rig.drive["servo"]
        if kind is cia402_slave.Cia402Ends:
            ends.settings = slave_settings(settings, "Z")
            ends.data = make_data(ends.settings)
        else:
            ends.settings = sercos_settings(settings, "Z")
            ends.data = TelegramData(ends.settings, 130)
        assert ends.connect(transactions, clock).port == "port"
        assert made.pop() == ("transactions", clock, 1001, *given)


@pytest.mark.parametrize(
    ("offset_us", "missing", "is_proved", "waits"),
    [(600, 1, True, False), (546, 2, True, True), (546, 1, False, False)],
)
def test_nothing_is_proved_where_the_bus_has_no_room_for_it(
    tmp_path: Path, offset_us: int, missing: int, is_proved: bool, waits: bool
) -> None:
    """In each cycle, at standstill alone, or never: the instants of `tests/rig`, at 800 kbit/s."""
    text = f"[cycle]\ncycle_offset_us = {offset_us}\n[drive.servo]\nmissing_cycles = {missing}\n"
    text += '[segment.can1]\nbitrate = 800_000\noverload = "run"'
    link = can_links(settings_of(tmp_path, "probe-z.toml", text))["Z"]
    assert (link._checked_by is link.sdo, link.place_check is not None) == (is_proved,) * 2
    assert (link._room is not None) is waits
