"""The start-up of a SERCOS drive with idents written by hand: what is written, compared, run."""

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.settings import Pdo
from axisrig.kernel.drives.ethercat.steps import Call, Pause
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.drives.sercos.settings import RealTimeBits, SercosSettings, real_time_bits
from axisrig.kernel.drives.sercos.startup import SercosSteps
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.sercos.service import Attribute, Element, Kind, pack_list

IDLE, DONE, INTERRUPTED, RUNNING, FAILED = 0x0, 0x3, 0x5, 0x7, 0xF
"""Data states of a procedure command."""
LEAD_MM = 10.0
MS = 1_000_000


class Far:
    """A drive that has some idents: numbers, or bytes; states: of commands, in turn."""

    def __init__(self, **idents: Any) -> None:
        self.idents: dict[int, int] = {int(name[1:]): value for name, value in idents.items()}
        self.attributes: dict[int, Attribute] = {}
        self.lists: dict[int, bytes] = {}
        self.states: dict[int, list[int]] = {}
        self.written: list[tuple[int, bytes]] = []
        self.paused_ns = 0
        self.warned: list[Alarm] = []
        self.probe: tuple[int, str] = (1, "POS")

    def read(self, _drive: int, ident: int, elements: Element, done: Any) -> None:
        attribute = self.attributes.get(ident, Attribute(Kind.UNSIGNED, 4))
        if elements is Element.ATTRIBUTE:
            done(attribute.pack())
        elif elements is Element.DATA_STATE and ident in self.states:
            states = self.states[ident]
            done((states.pop(0) if len(states) > 1 else states[0]).to_bytes(2, "little"))
        elif elements is Element.VALUE and ident in self.lists:
            done(self.lists[ident])
        elif elements is Element.VALUE and ident in self.idents:
            number = self.idents[ident]
            done(number.to_bytes(attribute.width, "little", signed=number < 0))
        else:
            done(SoeError(ident, 0x1001))

    def write(self, _drive: int, ident: int, value: bytes, done: Any) -> None:
        self.written.append((ident, value))
        done(b"")

    def steps(self, **settings: Any) -> SercosSteps:
        drive: Any = SimpleNamespace(
            channel=self, drive_number=0, name="Z", warn=self.warned.append, knows_level=False
        )
        drive.probe_input, drive.edge = self.probe
        self.drive = drive
        made = SercosSettings(
            **{
                **{"axis": "Z", "increments_per_mm": 1000.0, "node_id": 1},
                **{"lead_mm": LEAD_MM, "period_us": 2000},
                **settings,
            }
        )
        return SercosSteps(made, drive)

    def run(self, steps: Any) -> None:
        found: list[Any] = [None]
        try:
            while True:
                step = steps.send(found.pop())
                if isinstance(step, Pause):
                    self.paused_ns += step.time_ns
                    found.append(None)
                else:
                    assert isinstance(step, Call)
                    step.begin(found.append)
        except StopIteration:
            return


def alarm_of(far: Far, steps: Any) -> Alarm:
    with pytest.raises(Alarm) as caught:
        far.run(steps)
    return caught.value


# Numbers


@pytest.mark.parametrize(
    ("kind", "width", "number", "data"),
    [
        (Kind.UNSIGNED, 2, 65_535, "ffff"),
        (Kind.UNSIGNED, 4, 65_536, "00000100"),
        (Kind.SIGNED, 2, -32_768, "0080"),
        (Kind.SIGNED, 2, 32_767, "ff7f"),
        (Kind.SIGNED, 4, -1, "ffffffff"),
        (Kind.HEXADECIMAL, 2, 0x8000, "0080"),
        (Kind.UNSIGNED, 2, 65_536, None),
        (Kind.UNSIGNED, 2, -1, None),
        (Kind.SIGNED, 2, 32_768, None),
        (Kind.SIGNED, 2, -32_769, None),
        (Kind.HEXADECIMAL, 2, -1, None),
    ],
)
def test_a_number_is_written_as_long_and_with_the_sign_that_its_ident_has(
    kind: Kind, width: int, number: int, data: str | None
) -> None:
    far = Far()
    far.attributes[57] = Attribute(kind, width)
    steps = far.steps(writes=[(57, number)]).in_preop()
    alarm = alarm_of(far, steps)
    if data is None:
        assert (alarm.id, far.written) == (900743, [])
        assert alarm.values["step"] == f"S-0-0057 = {number}"
        assert alarm.values["answer"] == f"it does not fit into {width} bytes"
    else:
        assert alarm.values["step"] == "the reading of S-0-0076"  # nothing more is there
        assert far.written[0] == (57, bytes.fromhex(data))


def test_what_every_drive_gets_in_phase_2() -> None:
    """S-0-0001 and 2: cycle, us; S-0-0032 = 11: position; S-0-0015 = 7: telegrams of the lists."""
    far = Far(i76=1)
    far.run(far.steps(increments_per_mm=10_000.0).in_preop())
    numbers = {ident: int.from_bytes(data, "little") for ident, data in far.written[:4]}
    assert numbers == {1: 2000, 2: 2000, 32: 11, 15: 7}
    assert [ident for ident, _ in far.written[4:]] == [16, 24]


@pytest.mark.parametrize(("inputs", "outputs"), [((51,), (47,)), ((51, 53, 130), (47,)), ((), ())])
def test_telegrams_are_listed_without_their_words(
    inputs: tuple[int, ...], outputs: tuple[int, ...]
) -> None:
    """S-0-0016 has the AT, S-0-0024 the MDT: present and largest length in bytes, then idents.

    S-0-0135 and S-0-0134 are in each of them, and in no list.
    """
    far = Far(i76=1)
    pdos = {
        name: (Pdo(0, tuple(MappedObject(each, 0, 16, False, "") for each in (word, *idents))),)
        for name, word, idents in (("inputs", 135, inputs), ("outputs", 134, outputs))
    }
    far.run(far.steps(increments_per_mm=10_000.0, **pdos).in_preop())
    for (ident, data), number, idents in zip(
        far.written[4:], (16, 24), (inputs, outputs), strict=True
    ):
        length = (2 * len(idents)).to_bytes(2, "little")
        assert (ident, data) == (
            number, length * 2 + b"".join(each.to_bytes(2, "little") for each in idents),
        )  # fmt: skip


# Scaling of positions, S-0-0076 to S-0-0079


@pytest.mark.parametrize(
    ("idents", "per_mm"),
    [
        ({"i76": 0x01}, Fraction(10**4)),  # preferred: 1e-7 m
        ({"i76": 0x09, "i77": 1, "i78": -6}, Fraction(1000)),  # 1 um
        ({"i76": 0x09, "i77": 25, "i78": -8}, Fraction(10**5, 25)),
        ({"i76": 0x02}, Fraction(3_600_000) / 10),  # preferred: 1e-4 degrees
        ({"i76": 0x0A, "i79": 1 << 20}, Fraction(1 << 20) / 10),
        ({"i76": 0x4A, "i79": 1 << 20}, Fraction(1 << 20) / 10),  # bit 6: at the load
        ({"i76": 0x41}, Fraction(10**4)),
        ({"i76": 0x42}, Fraction(3_600_000) / 10),
    ],
)
def test_a_position_unit_is_that_of_the_manual(idents: dict[str, int], per_mm: Fraction) -> None:
    """S-0-0076: bits 2..0 kind, bit 3 by parameters; S-0-0077 10^S-0-0078 m, S-0-0079 per turn."""
    far = Far(**idents)
    far.attributes[78] = Attribute(Kind.SIGNED, 2)
    far.run(far.steps(increments_per_mm=float(per_mm)).in_preop())
    alarm = alarm_of(far, far.steps(increments_per_mm=float(per_mm) + 1.0).in_preop())
    assert (alarm.id, alarm.values["found"]) == (900745, f"{float(per_mm):.12g}")


@pytest.mark.parametrize(
    ("idents", "settings", "found", "expected"),
    [
        # Less than an increment in a millimetre: 1e-4 of the way would be missing
        ({"i76": 0x0A, "i79": 1 << 20}, {"increments_per_mm": 104857.5}, 104857.6, 104857.5),
        ({"i76": 0x0A, "i79": 1 << 20}, {"increments_per_mm": 104858.0}, 104857.6, 104858.0),
        ({"i76": 0x0A, "i79": 1048575}, {"increments_per_mm": 104857.6}, 104857.5, 104857.6),
        ({"i76": 0x02}, {"increments_per_mm": 36e4, "lead_mm": 10.00001}, 359999.64, 36e4),
        ({"i76": 0x09, "i77": 3, "i78": -6}, {"increments_per_mm": 333.0}, 1000 / 3, 333.0),
        ({"i76": 0x09, "i77": 25, "i78": -7}, {"increments_per_mm": 400.4}, 400.0, 400.4),
        # A power of ten, and the other kind
        ({"i76": 0x01}, {"increments_per_mm": 1e3}, 1e4, 1e3),
        ({"i76": 0x09, "i77": 1, "i78": -6}, {"increments_per_mm": 1e4}, 1e3, 1e4),
        ({"i76": 0x02}, {"increments_per_mm": 1e4}, 36e4, 1e4),
        # By parameters, and not by them
        ({"i76": 0x01, "i77": 1, "i78": -6}, {"increments_per_mm": 1e3}, 1e4, 1e3),
        ({"i76": 0x02, "i79": 1 << 20}, {"increments_per_mm": 104857.6}, 36e4, 104857.6),
    ],
)
def test_a_position_unit_that_differs_at_all_is_refused(
    idents: dict[str, int], settings: dict[str, float], found: float, expected: float
) -> None:
    """Each way would be wrong by the quotient of both, however near to 1 it is."""
    far = Far(**idents)
    far.attributes[78] = Attribute(Kind.SIGNED, 2)
    alarm = alarm_of(far, far.steps(**settings).in_preop())
    assert alarm.id == 900745
    assert alarm.values == {
        "axis": "Z", "kind": f"0x{idents['i76']:02X}",
        "found": f"{found:.12g}", "expected": f"{expected:.12g}",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("idents", "lead_mm", "per_mm"),
    [
        ({"i76": 0x02}, 5.0, 720_000.0),
        ({"i76": 0x02}, 6.0, 600_000.0),
        ({"i76": 0x0A, "i79": 1000}, 7.0, 1000 / 7),
        ({"i76": 0x09, "i77": 3, "i78": -6}, 10.0, 1000 / 3),
        ({"i76": 0x09, "i77": 1, "i78": 0}, 10.0, 1e-3),  # a metre
        ({"i76": 0x09, "i77": 2, "i78": 1}, 10.0, 5e-5),  # 20 m
        ({"i76": 0x01}, 3.0, 10_000.0),  # no lead in a linear unit
    ],
)
def test_a_unit_of_a_turn_counts_by_the_lead_and_one_of_a_way_does_not(
    idents: dict[str, int], lead_mm: float, per_mm: float
) -> None:
    far = Far(**idents)
    far.attributes[78] = Attribute(Kind.SIGNED, 2)
    far.run(far.steps(increments_per_mm=per_mm, lead_mm=lead_mm).in_preop())


@pytest.mark.parametrize("kind", [0, 3, 4, 7, 8, 0x40])
def test_a_drive_without_a_position_unit_is_refused(kind: int) -> None:
    """S-0-0076, bits 2..0: 0 none, 1 translational, 2 rotational; there is no other."""
    far = Far(i76=kind)
    alarm = alarm_of(far, far.steps().in_preop())
    assert (alarm.id, alarm.values["found"]) == (900745, "no position unit")
    assert alarm.values["kind"] == f"0x{kind:02X}"


@pytest.mark.parametrize(
    ("idents", "missing"),
    [
        ({}, 76),
        ({"i76": 0x09, "i78": -6}, 77),
        ({"i76": 0x09, "i77": 1}, 78),
        ({"i76": 0x0A}, 79),
    ],
)
def test_an_ident_of_the_unit_that_the_drive_does_not_have_is_named(
    idents: dict[str, int], missing: int
) -> None:
    far = Far(**idents)
    far.attributes[78] = Attribute(Kind.SIGNED, 2)
    alarm = alarm_of(far, far.steps().in_preop())
    assert (alarm.id, alarm.values["axis"]) == (900743, "Z")
    assert alarm.values["step"] == f"the reading of S-0-{missing:04}"
    assert alarm.values["answer"] == str(SoeError(missing, 0x1001))


# Real-time bits

PROBES = [(1, "POS"), (1, "NEG"), (2, "POS"), (2, "NEG")]


@pytest.mark.parametrize("at", range(4))
@pytest.mark.parametrize("number", [0, 1, 2])
def test_the_idents_of_a_probe_have_to_be_at_its_real_time_bits(at: int, number: int) -> None:
    """301, 303: real-time control bits 1 and 2; 305, 307: status bits. 405, 401: by probe; 409 on:
    by probe and edge; S-0-0169: a bit for each.
    """
    bits = real_time_bits(number, 0)
    place = {0x40: 0, 0x80: 1}
    enable, latched = 301 + 2 * place[bits.enable], 305 + 2 * place[bits.latched]
    level = 305 + 2 * place[bits.actuated]
    probe_input, edge = PROBES[at]
    right = {enable: 404 + probe_input, latched: 409 + at, level: 400 + probe_input, 169: 1 << at}

    def checked(**changes: int) -> Far:
        far = Far(i76=1)
        far.probe = probe_input, edge
        far.idents |= right | {int(name[1:]): value for name, value in changes.items()}
        far.run(far.steps(increments_per_mm=1e4, bits=bits, measures=True).in_preop())
        return far

    assert checked().drive.knows_level
    assert not checked(**{f"i{level}": 0}).drive.knows_level
    assert not checked(**{f"i{level}": 403 - probe_input}).drive.knows_level  # the other probe
    for more in (0xF, 0x100 | 1 << at):  # other edges, and bit 8: it begins by itself
        assert checked(i169=more).drive.knows_level
    others = {enable: 407 - probe_input, latched: 409 + (at ^ 1), 169: 0xF & ~(1 << at)}
    for ident, wrong in others.items():
        with pytest.raises(Alarm) as caught:
            checked(**{f"i{ident}": wrong})
        assert caught.value.id == 900744
        assert caught.value.values["ident"] == f"S-0-{ident:04}"


# Commands


@pytest.mark.parametrize(
    ("phase", "command", "invalid", "warning"), [(3, 127, 21, 140038), (4, 128, 22, 140040)]
)
def test_a_phase_that_is_refused_names_what_is_invalid(
    phase: int, command: int, invalid: int, warning: int
) -> None:
    def checked(*states: int, listed: list[int] | None = None) -> Far:
        far = Far()
        far.states[command] = list(states)
        if listed is not None:
            far.lists[invalid] = pack_list(listed, 2, 8)
        steps = far.steps()
        far.run(steps.before_safeop() if phase == 3 else steps.before_op())
        # It is cancelled whatever has become of it
        assert far.written == [(command, b"\3\0"), (command, b"\0\0")]
        return far

    far = checked(RUNNING, RUNNING, DONE)
    assert (far.warned, far.paused_ns) == ([], 2 * 2 * MS)
    for ended in (FAILED, INTERRUPTED):
        far = checked(RUNNING, ended, listed=[1, 2])
        assert far.paused_ns == 2 * MS  # it has ended, whatever came of it
        found = [(each.id, each.values["ident"], each.values["state"]) for each in far.warned]
        assert found == [(warning, name, f"0x{ended:X}") for name in ("S-0-0001", "S-0-0002")]
        for listed in ([], None):
            (alone,) = checked(ended, listed=listed).warned
            assert alone.values["ident"] == f"S-0-{command:04}"
    far = checked(RUNNING)  # for ever
    assert (far.paused_ns, far.warned[0].values["state"]) == (500 * 2 * MS, "0x7")


@pytest.mark.parametrize(
    ("states", "is_begun", "alarm"),
    [
        ([RUNNING], False, None),  # the drive has begun by itself
        ([IDLE, RUNNING], True, None),
        ([IDLE, FAILED], True, 900746),
    ],
)
def test_the_probing_cycle_is_begun_where_it_does_not_run(
    states: list[int], is_begun: bool, alarm: int | None
) -> None:
    far = Far()
    far.attributes[170] = Attribute(Kind.BINARY, 2, is_command=True)
    far.states[170] = states
    steps = far.steps(measures=True).in_op()
    if alarm is None:
        far.run(steps)
    else:
        assert alarm_of(far, steps).id == alarm
    assert far.written == ([(170, b"\3\0")] if is_begun else [])


@pytest.mark.parametrize(
    "settings",
    [
        {"measures": False},
        {"measures": True, "starts_probing": False},
        {"measures": True, "bits": RealTimeBits(0x40, 0x40, 0x80, 0x80)},
    ],
)
def test_the_probing_cycle_is_not_begun_where_another_does(settings: dict[str, Any]) -> None:
    """No axis that measures; the rig says so; a real-time bit does it (P-AXIS-00700)."""
    far = Far()
    far.states[170] = [IDLE]
    far.run(far.steps(**settings).in_op())
    assert far.written == []
