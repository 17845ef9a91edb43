"""What the elements of each ident say, what a drive has at power on, and how it is described."""

from dataclasses import replace
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.sercos.test_sercos_faults_by_hand import Hand

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.description import Entry
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.drive.sercos.description import describe
from axisrig.bench.drive.sercos.idents import rows_of
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.drive.sercos.profiles import SercosProfile, make_profile
from axisrig.bench.drive.sercos.service_channel import Ident, ServiceChannel
from axisrig.kernel.profiles.sercos.service import (
    ERROR_CODE,
    HEADER,
    Attribute,
    Element,
    Header,
    Kind,
    Operation,
    ident_number,
    pack_text,
    soe_errors,
)
from axisrig.kernel.time.scheduler import new_scheduler

NAMES = ("one_probe", "two_probes")


def answer(channel: ServiceChannel, operation: Operation, ident: int, element: Element,
           data: bytes = b"") -> bytes | str:  # fmt: skip
    (found,) = channel.serve(Header(operation, 0, element, ident).pack() + data)
    if not Header.read(found).is_error:
        return found[HEADER.size :]
    code = ERROR_CODE.unpack_from(found, HEADER.size)[0]
    return next(name for name, number in soe_errors().items() if number == code)


@pytest.mark.parametrize("profile", NAMES)
def test_each_ident_has_its_name_unit_and_limits(profile: str) -> None:
    """Elements 2, 4, 5 and 6; what an ident has not is refused by name."""
    hand = Hand(profile=profile)
    for row in rows_of(hand.drive.sercos):
        ident, width = ident_number(row["ident"]), int(row["bytes"])
        expected: dict[Element, bytes | str] = {
            Element.NAME: pack_text(row["name"]),
            Element.UNIT: pack_text(row["unit"]) if row["unit"] else "NO_UNIT",
        }
        for element, key in ((Element.MINIMUM, "minimum"), (Element.MAXIMUM, "maximum")):
            is_limit = row[key] and row["form"] not in ("list", "text")
            packed = int(row[key] or 0).to_bytes(width, "little", signed=row["kind"] == "signed") \
                if is_limit else f"NO_{element.name}"  # fmt: skip
            expected[element] = packed
        for element, wanted in expected.items():
            found = answer(hand.drive.channel, Operation.READ, ident, element)
            assert found == wanted, (row["ident"], element)


@pytest.mark.parametrize("number", [-32_768, -3, -2, -1, 0, 1, 7, 8, 32_767])
@pytest.mark.parametrize("limits", [(0, 7), (-2, 7), (-3, -1), (0, 0), (None, 7), (-2, None)])
def test_limits_of_a_signed_ident_belong_to_it(
    number: int, limits: tuple[int | None, int | None]
) -> None:
    low, high = limits
    ident = Ident(Attribute(Kind.SIGNED, 2), b"\0\0", minimum=low, maximum=high)
    channel = ServiceChannel([{1: ident}], lambda: 128, lambda: 4)
    data = number.to_bytes(2, "little", signed=True)
    expected: bytes | str = b""
    if low is not None and number < low:
        expected = "BELOW"
    elif high is not None and number > high:
        expected = "ABOVE"
    assert answer(channel, Operation.WRITE, 1, Element.VALUE, data) == expected
    assert ident.value == (b"\0\0" if expected else data)


SCALED: tuple[tuple[str, Any, int], ...] = (
    ("linear", {"linear_factor": 25, "linear_exponent": -6}, 4096),
    ("rotary", {"linear_factor": 3, "linear_exponent": -9}, 36_000),
    ("rotary", {}, 1 << 20),
    ("linear", {}, 1 << 24),
)


def _made(kind: Any, keys: dict[str, int], resolution: int) -> SercosProfile:
    return replace(make_profile("one_probe", DriveProfile(), kind, resolution), **keys)


@pytest.mark.parametrize(("kind", "keys", "resolution"), SCALED)
def test_the_scaling_at_power_on_is_that_of_the_drive(
    kind: str, keys: dict[str, int], resolution: int
) -> None:
    """S-0-0076 to 79; by the parameters, bit 3, whether linear (1) or rotary (2)."""
    made = _made(kind, keys, resolution)
    drive = SercosDrive("Z", new_scheduler(), FakeAxis(), (None, None), made)
    expected = [
        0x09 if kind == "linear" else 0x0A,
        keys.get("linear_factor", 1), keys.get("linear_exponent", -7), resolution,
    ]  # fmt: skip
    idents = [ident_number(f"S-0-00{number}") for number in (76, 77, 78, 79)]
    assert [drive.idents.number(ident) for ident in idents] == expected
    for ident, value in zip(idents, (0x02, 7, -3, 5), strict=True):
        drive.idents.put(ident, value)
    drive.idents.reset()
    assert [drive.idents.number(ident) for ident in idents] == expected


@pytest.mark.parametrize(("profile", "product"), [("one_probe", 5000), ("two_probes", 2000)])
@pytest.mark.parametrize(("serial", "mailbox"), [(1, 128), (77, 64)])
def test_a_drive_is_described_with_its_telegrams(
    profile: str, product: int, serial: int, mailbox: int
) -> None:
    """Each begins with its word, 16 bits, and has one position of 32 behind it.

    ETG.1000: UINT is type 6, DINT type 4; SyncManager 2 is of the outputs, 3 of the inputs.
    """
    made = make_profile(profile, DriveProfile(), "rotary", 1 << 20)
    found = describe(made, serial, mailbox)
    (mdt,), (at,) = found.rxpdos, found.txpdos
    assert (mdt.index, mdt.name, mdt.manager, mdt.size) == (0x18, "MDT", 2, 6)
    assert (at.index, at.name, at.manager, at.size) == (0x10, "AT", 3, 6)
    assert mdt.entries == (
        Entry(134, 1, 16, 6, "S-0-0134"), Entry(47, 1, 32, 4, "S-0-0047"),
    )  # fmt: skip
    assert at.entries == (Entry(135, 1, 16, 6, "S-0-0135"), Entry(51, 1, 32, 4, "S-0-0051"))
    assert [(one.kind, one.length) for one in found.managers] == [
        (1, mailbox), (2, mailbox), (3, 6), (4, 6),
    ]  # fmt: skip
    assert (found.serial, found.product, found.order) == (serial, product, f"SERCOS {product}")
    assert (found.is_sercos, found.coe) == (True, ())


@pytest.mark.parametrize(("serial", "mailbox"), [(3, 64), (9, 256)])
def test_a_drive_describes_itself_with_its_own_settings(serial: int, mailbox: int) -> None:
    made = make_profile("one_probe", DriveProfile(), "rotary", 1 << 20)
    settings = SlaveSettings(serial=serial, mailbox_bytes=mailbox)
    drive = SercosDrive("Z", new_scheduler(), FakeAxis(), (None, None), made, settings)
    assert drive.description == describe(made, serial, mailbox)
    assert drive.description.serial == serial


@pytest.mark.parametrize(
    ("profile", "probes", "select", "needs", "locks_control", "locks_select"),
    [("one_probe", 1, 0x0123, False, False, True), ("two_probes", 2, 0x000F, True, True, False)],
)
def test_what_two_drives_differ_in(
    profile: str, probes: int, select: int, needs: bool, locks_control: bool, locks_select: bool
) -> None:
    made = make_profile(profile, DriveProfile(), "linear", 4096)
    assert (made.probes, made.select, made.needs_input) == (probes, select, needs)
    assert (made.locks_control, made.locks_select) == (locks_control, locks_select)
    assert (made.scaling, made.resolution) == (0x09, 4096)
    if profile == "one_probe":
        assert (made.status_bits, made.control_bits) == (None, None)
    else:
        assert made.control_bits == {0, 405, 406}
        assert made.status_bits == {0, 336, 400, 403, 409, 410, 411, 412}
