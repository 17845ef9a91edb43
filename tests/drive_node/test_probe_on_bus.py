"""The touch probe through a drive's bus: each of its objects acts, or follows what happened.

The axis moves at 1 m/s, so that one microsecond is one micrometre, and 1 um is one increment.
"""

from collections.abc import Callable
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.profiles import named_profile, profile_names
from axisrig.kernel.drives.cia402.words import counter_object, latch_object

Make = Callable[..., Any]
MS, US = 1_000_000, 1_000
UM = DriveProfile(encoder_increments=10_000, input_delay_ns=0)  # 1 um on 10 mm
EDGES_1 = [30_100 * US, 30_300 * US]
EDGES_2 = [30_500 * US, 30_700 * US]
POSITIONS = {0x60BA: 30_100, 0x60BB: 30_300, 0x60BC: 30_500, 0x60BD: 30_700}
STAMPS = {0x60D1: 30_100_000, 0x60D2: 30_300_000, 0x60D3: 30_500_000, 0x60D4: 30_700_000}


@pytest.fixture
def moving(drive_bench: Make, fake_axis: Any) -> Make:
    def make(profile: DriveProfile = UM, second_m: float | None = None) -> Any:
        axis = fake_axis(motion=lambda time_s: time_s)
        axis.encoder_2_m = second_m
        return drive_bench(axis=axis, inputs=(EDGES_1, EDGES_2), profile=profile)

    return make


def after_both_pulses(bench: Any, word: int, *sources: int) -> Callable[[int], int]:
    """Write 60D0 and then 60B8 by SDO, wait for both pulses; return the reader of objects."""
    for sub, source in enumerate(sources, 1):
        bench.remote.sdo[0x60D0][sub].raw = source
    bench.remote.sdo[0x60B8].raw = word
    bench.run_to_ms(31)

    def read(index: int) -> int:
        value: int = bench.remote.sdo[index].raw
        return value

    return read


def test_everything_of_both_probes_at_once(moving: Make) -> None:
    read = after_both_pulses(moving(), 0x3131)
    assert read(0x60B9) == 0x0707
    for index, value in (POSITIONS | STAMPS).items():
        assert read(index) == value
    assert [read(index) for index in range(0x60D5, 0x60D9)] == [1, 1, 1, 1]


def test_60b8_decides_what_is_latched(moving: Make) -> None:
    for word, latched in (
        (0x0000, []), (0x0011, [0x60BA]), (0x0021, [0x60BB]), (0x1100, [0x60BC]),
        (0x2100, [0x60BD]), (0x2111, [0x60BA, 0x60BD]),
    ):  # fmt: skip
        read = after_both_pulses(moving(), word)
        for index, value in POSITIONS.items():
            assert read(index) == (value if index in latched else 0)


@pytest.mark.parametrize(("probe", "word"), [(1, 0x0019), (2, 0x1900)])
@pytest.mark.parametrize(("source", "position"), [(1, 30_100), (2, 30_500)])
def test_60d0_decides_which_input_it_is(
    moving: Make, probe: int, word: int, source: int, position: int
) -> None:
    sources = (source, 2) if probe == 1 else (1, source)
    read = after_both_pulses(moving(), word, *sources)
    assert read(latch_object(probe, "POS")) == position


@pytest.mark.parametrize("source", [5, 6])
def test_60d0_takes_the_zero_pulse(moving: Make, source: int) -> None:
    """The mark at 90 degrees and the zero of the position, every 10 mm = 10 ms."""
    bench = moving(DriveProfile(encoder_increments=10_000, index_angle_deg=90.0))
    read = after_both_pulses(bench, 0x0019, source, 2)
    (first,) = [p for p in (2_500, 10_000, 12_500) if p == read(0x60BA)]
    assert first == (2_500 if source == 5 else 10_000)


@pytest.mark.parametrize("value", [0, 3, 4, 7, -1, -32768, 32767])
def test_60d0_refuses_sources_that_the_drive_lacks(moving: Make, value: int) -> None:
    bench = moving()
    with pytest.raises(SdoAbortedError) as caught:
        bench.remote.sdo[0x60D0][1].raw = value
    assert caught.value.code == 0x06090030
    assert bench.remote.sdo[0x60D0][1].raw == 1


@pytest.mark.parametrize("name", profile_names())
def test_objects_that_a_profile_lacks_are_not_there(drive_bench: Make, name: str) -> None:
    """By SDO: abort 0602 0000 (object) or 0609 0011 (sub-index); others can be read."""
    bench = drive_bench(profile=named_profile(name))
    keys = [key for key in variables() if 0x60B8 <= key[0] <= 0x60D8]
    present = [(index, bench.node.profile.has_object(index, sub)) for index, sub in keys]
    for index, sub in keys:
        if bench.node.profile.has_object(index, sub):
            bench.remote.sdo.upload(index, sub)
            continue
        with pytest.raises(SdoAbortedError) as caught:
            bench.remote.sdo.upload(index, sub)
        whole = any(other == index and has for other, has in present)
        assert caught.value.code == (0x06090011 if whole else 0x06020000)


def test_power_on_sources_are_those_of_the_profile(drive_bench: Make) -> None:
    bench = drive_bench(profile=named_profile("ax8000-like"))
    bench.run_to_ms(5)
    assert [bench.remote.sdo[0x60D0][sub].raw for sub in (1, 2)] == [3, 3]
    assert bench.remote.sdo[0x60B8].raw == 0x3838  # sources and edges, nothing enabled
    assert bench.remote.sdo[0x60B9].raw == 0


@pytest.mark.parametrize(("latch_encoder", "word", "offset_um"), [
    ("motor", 0x0011, 0), ("second", 0x0011, 70), ("function_bit", 0x0011, 0),
    ("function_bit", 0x0051, 70),
])  # fmt: skip
def test_the_encoder_that_is_latched(
    moving: Make, latch_encoder: Any, word: int, offset_um: int
) -> None:
    profile = DriveProfile(encoder_increments=10_000, input_delay_ns=0, latch_encoder=latch_encoder)
    read = after_both_pulses(moving(profile, 70e-6), word)
    assert read(0x60BA) == 30_100 + offset_um


def test_bit_6_without_a_second_encoder_is_refused(moving: Make) -> None:
    bench = moving(DriveProfile(latch_encoder="function_bit"))
    with pytest.raises(SdoAbortedError) as caught:
        bench.remote.sdo[0x60B8].raw = 0x0051
    assert caught.value.code == 0x06090030


@pytest.mark.parametrize("probe", [1, 2])
@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_time_stamp_and_counter_travel_with_the_latch_in_one_telegram(
    moving: Make, probe: int, edge: str
) -> None:
    """60BA 32 bit and 60D1 32 bit, or 60BA and 60D5 16 bit: what a measuring axis wants."""
    bench = moving()
    latch, counter = latch_object(probe, edge), counter_object(probe, edge)
    stamp = counter - 0x60D5 + 0x60D1
    remote = bench.remote
    for number, entries in (
        (1, (latch << 16 | 32, stamp << 16 | 32)),
        (2, (latch << 16 | 32, counter << 16 | 16)),
    ):
        remote.sdo[0x1800 + number][1].raw = 0x80000000 | (0x183 + 0x100 * number)
        remote.sdo[0x1A00 + number][0].raw = 0
        for sub, entry in enumerate(entries, 1):
            remote.sdo[0x1A00 + number][sub].raw = entry
        remote.sdo[0x1A00 + number][0].raw = 2
        remote.sdo[0x1800 + number][2].raw = 1
        remote.sdo[0x1800 + number][1].raw = 0x183 + 0x100 * number
    remote.sdo[0x60B8].raw = 0x3131
    bench.operational(28)
    bench.sync_at_ms(32)
    first, second = bench.frames(0x283)[-1], bench.frames(0x383)[-1]
    assert int.from_bytes(first[:4], "little", signed=True) == POSITIONS[latch]
    assert int.from_bytes(first[4:], "little") == STAMPS[stamp]
    assert second == first[:4] + b"\x01\x00"
