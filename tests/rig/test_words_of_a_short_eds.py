"""What a file of a few objects says against its rig: device, modes, bit rates, identity, mends.

Each file has only what its test is about; `test_eds_words.py` has whole files and whole checks.
"""

from collections.abc import Callable, Sequence

import pytest

from axisrig.bench.rig.canopen.eds_words import eds_warnings
from axisrig.bench.rig.canopen.schedule import fixed_frames
from axisrig.bench.rig.settings import Settings

WithEds = Callable[..., Settings]
RATES = (10, 20, 50, 125, 250, 500, 800, 1000)
PERIOD = """
[1006]
ParameterName=Period
DataType=7
AccessType=rw
"""
"""An object that gives the drive the period; without one it is warned of."""


def number(index: int, value: str, sub: str = "") -> str:
    return f"""
[{index:X}{sub}]
ParameterName=Some
DataType=7
AccessType=ro
DefaultValue={value}
"""


def words(with_eds: WithEds, text: str, keys: str = "", *changes: tuple[str, str]) -> list[str]:
    """The warnings, without axis and drive."""
    settings = with_eds("[DeviceInfo]\n" + text + PERIOD, keys, *changes)
    found = eds_warnings(settings)
    assert all(each.startswith("axis Z, drive servo: ") for each in found)
    return [each.removeprefix("axis Z, drive servo: ") for each in found]


# Bit rates


def rates(allowed: Sequence[int]) -> str:
    return "\n".join(f"BaudRate_{rate}={int(rate in allowed)}" for rate in RATES)


@pytest.mark.parametrize(
    ("allowed", "bitrate", "known"),
    [
        ((), "1_000_000", None),  # it says nothing
        ((1000,), "1_000_000", None), (RATES, "500_000", None), ((10, 125), "125_000", None),
        ((1000,), "500_000", "1000 kbit/s"),
        ((10, 20, 50, 125, 250, 500, 800), "1_000_000",
         "10 kbit/s, 20 kbit/s, 50 kbit/s, 125 kbit/s, 250 kbit/s, 500 kbit/s, 800 kbit/s"),
        ((800, 50, 1000), "250_000", "50 kbit/s, 800 kbit/s, 1000 kbit/s"),
    ],
)  # fmt: skip
def test_a_bit_rate_that_the_file_lacks_is_named_with_those_that_it_has(
    with_eds: WithEds, allowed: Sequence[int], bitrate: str, known: str | None
) -> None:
    """From the slowest to the fastest, whatever their order in the file."""
    found = words(with_eds, rates(allowed), "", ("1_000_000", bitrate))
    kbit = int(bitrate) // 1000
    text = f"by its EDS it has no {kbit} kbit/s, the bit rate of segment can1 (it has {known})"
    assert found == ([] if known is None else [text])


# Device and modes


@pytest.mark.parametrize(
    ("device", "keys", "profile", "wanted"),
    [
        ("0x20192", "", None, 402), ("0x30191", "", 401, 402), ("0x192", "", None, 402),
        ("0x30191", "device_type = 401", None, 401), ("0x30191", "device_type = false", None, 0),
        ("0x20192", "device_type = 401", 402, 401), ("0", "", None, 402),
        ("0x20000", "", None, 402), ("0x20192", "device_type = 0", 402, 0),
    ],
)  # fmt: skip
def test_the_profile_of_1000_is_compared_where_both_have_one(
    with_eds: WithEds, device: str, keys: str, profile: int | None, wanted: int
) -> None:
    """Its low word; 0: the file leaves it open. `false`: the rig does not look at it."""
    found = words(with_eds, number(0x1000, device), keys)
    text = f"its EDS is of profile {profile} (object 1000), the rig wants {wanted}:"
    assert [each.startswith(text) for each in found] == [True] * (profile is not None)


@pytest.mark.parametrize(
    ("modes", "mode", "lacks"),
    [
        ("0x80", 8, False), ("0x100", 9, False), ("0x80", 9, True), ("0x100", 8, True),
        ("0x40", 8, True), ("0x1A5", 9, False), ("0", 8, False), ("0x1", -1, False),
    ],
)  # fmt: skip
def test_a_mode_is_the_bit_before_its_number(
    with_eds: WithEds, modes: str, mode: int, lacks: bool
) -> None:
    """6502 of CiA 402-2: bit 0 is mode 1, bit 7 csp, bit 8 csv."""
    found = words(with_eds, number(0x6502, modes), f"mode = {mode}")
    text = f"by its EDS it has no mode {mode} (csp is bit 7 of object 6502, which is {modes})"
    assert found == [text] * lacks


# Identity


IDENTITY = "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=5\n" + "".join(
    number(0x1018, value, f"sub{sub}")
    for sub, value in enumerate(("4", "0x11", "0x22", "0", "0x44"))
)


@pytest.mark.parametrize(
    ("wanted", "differ"),
    [
        ({"vendor": 0x11, "product": 0x22, "revision": 3, "serial": 0x44}, []),
        ({"vendor": 0x12, "product": 0x22, "serial": 0x45}, ["vendor", "serial"]),
        ({"product": 0x11, "revision": 9}, ["product"]),
        ({"serial": 0x11, "vendor": 0x44}, ["serial", "vendor"]),
        ({}, []),
    ],
)
def test_each_part_of_the_identity_is_compared_with_its_own(
    with_eds: WithEds, wanted: dict[str, int], differ: list[str]
) -> None:
    """In the order of the rig; a revision of 0 is one that the file leaves open."""
    places = {"vendor": (1, 0x11), "product": (2, 0x22), "serial": (4, 0x44)}
    keys = f"identity = {{ {', '.join(f'{key} = {value}' for key, value in wanted.items())} }}"
    found = words(with_eds, IDENTITY, keys)
    assert [each.partition(":")[0] for each in found] == [
        f"its EDS has the {name} 0x{places[name][1]:X} (1018" for name in differ
    ]
    for name, each in zip(differ, found, strict=True):
        assert f"(1018:{places[name][0]}), the rig wants 0x{wanted[name]:X}" in each


# A TPDO that cannot be switched off


@pytest.mark.parametrize(
    ("transmission", "when"),
    [("1", "with SYNC"), ("240", "with SYNC"), ("241", "by event"), ("255", "by event")],
)
@pytest.mark.parametrize("pdo", [5, 64])
def test_a_fixed_tpdo_is_named_with_what_sends_it(
    with_eds: WithEds, transmission: str, when: str, pdo: int
) -> None:
    index = 0x1800 + pdo - 1
    record = f"[{index:X}]\nParameterName=TPDO\nObjectType=9\nSubNumber=3\n"
    parts = [number(index, "2", "sub0"), number(index, "$NODEID+0x480", "sub1")]
    (found,) = words(with_eds, record + "".join(parts) + number(index, transmission, "sub2"))
    assert found.startswith(f"TPDO{pdo} is on by its EDS, comes {when} and cannot be switched off")


@pytest.mark.parametrize(
    ("entries", "length"),
    [
        (["0x60410010"], 2), (["0x60410010", "0x60610008"], 3), (["0x20000001"], 1),
        (["0x60410010", "0x20000001"], 3), (["0x60640020", "0x606C0020"], 8),
        (["0x60640020", "0x606C0020", "0x60410010"], 8), ([], 0),
    ],
)  # fmt: skip
def test_a_fixed_tpdo_is_as_long_as_its_default_mapping(
    with_eds: WithEds, entries: list[str], length: int
) -> None:
    """Bits are in the low byte of an entry (CiA 301); a part of a byte is one, 8 are the most."""
    record = "[{0:X}]\nParameterName=TPDO\nObjectType=9\nSubNumber={1}\n"
    text = record.format(0x1804, 3) + number(0x1804, "2", "sub0")
    text += number(0x1804, "0x40000485", "sub1") + number(0x1804, "1", "sub2")
    text += record.format(0x1A04, len(entries) + 1) + number(0x1A04, str(len(entries)), "sub0")
    text += "".join(number(0x1A04, each, f"sub{sub}") for sub, each in enumerate(entries, 1))
    settings = with_eds("[DeviceInfo]\n" + text + PERIOD)
    ((kind, frame),) = fixed_frames(settings, "Z")
    assert (kind, frame.name, frame.can_id) == ("TPDO", "Z.TPDO5 (not mapped)", 0x485)
    assert frame.data_bytes == length


# Mends


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_places_of_one_mend_are_named_together_three_of_them_at_most(
    with_eds: WithEds, count: int
) -> None:
    """By line, section and key; beyond three their number."""
    text = "".join(
        number(0x2000 + each, "1").replace("ParameterName=Some\n", "") for each in range(count)
    )
    (found,) = words(with_eds, text)
    # [DeviceInfo], an empty line, then 5 lines for each object: its section is the first one
    places = [f"line {3 + 5 * each} [{0x2000 + each:X}] ParameterName" for each in range(count)]
    more = f" and {count - 3} more" if count > 3 else ""
    assert found == f"its EDS, {', '.join(places[:3])}{more}: is missing"


def test_each_kind_of_mend_has_its_own_words(with_eds: WithEds) -> None:
    text = number(0x2000, "1").replace("ParameterName=Some\n", "")
    found = words(with_eds, text + number(0x2001, "one") + "no key\n")
    assert [each.rpartition(": ")[2] for each in sorted(found)] == [
        "is no number and is left out", "is missing",
        "line 13 is neither section nor key and is left out",
    ]  # fmt: skip
