"""The touch probe unit alone: arming, edges, input circuit, stored positions.

The position at t ns is t units, so a latched value is the instant it was taken at.
"""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.drive.axis.input_circuit import InputCircuit
from axisrig.bench.drive.axis.latch_position import LatchPosition, PositionAt
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.touch_probe import Encoders, TouchProbe

POS_1, NEG_1, POS_2, NEG_2 = 0x0011, 0x0021, 0x1100, 0x2100
IDEAL = DriveProfile(input_delay_ns=0)


class Signal:
    def __init__(self, edges_ns: Sequence[int], start: bool = False) -> None:
        self.edges = [(t, start ^ (n % 2 == 0)) for n, t in enumerate(edges_ns)]
        self.level = start


def unit(
    first: Signal | None,
    second: Signal | None = None,
    profile: DriveProfile = IDEAL,
    position: PositionAt = lambda time_ns: time_ns,
) -> TouchProbe:
    encoders = Encoders(LatchPosition(profile, position))
    return TouchProbe((first, second), profile, encoders, ProcessImage())


def at(probe: TouchProbe, time_ns: int, function: int | None = None) -> int:
    """Bring the unit to an instant, then give it a function word; return the status."""
    probe.take_edges(time_ns)
    if function is not None:
        probe.set_function(function, time_ns)
    return probe.status


def test_positive_edge_is_stored_with_its_bit_and_counter() -> None:
    probe = unit(Signal([1500]))
    assert at(probe, 1000, POS_1) == 0x0001
    assert at(probe, 2000) == 0x0003
    latch = probe.probes[0].latches[True]
    assert (latch.units, latch.count) == (1500, 1)


def test_negative_edge_ignores_the_positive_one() -> None:
    probe = unit(Signal([1500, 1800]))
    at(probe, 1000, NEG_1)
    assert at(probe, 1700) == 0x0001
    assert at(probe, 2000) == 0x0005
    assert probe.probes[0].latches[False].units == 1800
    assert probe.probes[0].latches[True].count == 0


def test_both_edges_of_both_probes_at_once() -> None:
    probe = unit(Signal([1100, 1200]), Signal([1300, 1400]))
    at(probe, 1000, POS_1 | NEG_1 | POS_2 | NEG_2)
    assert at(probe, 2000) == 0x0707
    assert [p.latches[level].units for p in probe.probes for level in (True, False)] == [
        1100, 1200, 1300, 1400]  # fmt: skip


def test_each_latch_keeps_the_instant_of_its_last_position() -> None:
    """Continuous, 60B8 bits 1 and 9; a delay of the input is in instant and position alike."""
    probe = unit(Signal([1100, 1200, 1500, 1900, 2300]), Signal([1300, 1400]))
    at(probe, 1000, POS_1 | NEG_1 | POS_2 | NEG_2 | 0x0202)
    for time_ns, kept_ns in ((1250, [1100, 1200, 0, 0]), (1700, [1500, 1200, 1300, 1400])):
        at(probe, time_ns)
        latches = [p.latches[level] for p in probe.probes for level in (True, False)]
        assert [latch.instant_ns for latch in latches] == kept_ns
        assert [latch.units for latch in latches] == kept_ns
    late = unit(Signal([1500]), profile=DriveProfile(input_delay_ns=70))
    at(late, 1000, POS_1)
    at(late, 2000)
    assert late.probes[0].latches[True].instant_ns == late.probes[0].latches[True].units == 1570


def test_probes_do_not_disturb_each_other() -> None:
    probe = unit(Signal([1500]), Signal([1600]))
    at(probe, 1000, POS_2)
    assert at(probe, 2000) == 0x0300
    assert at(probe, 2000, POS_2 | POS_1) == 0x0301


def test_edges_before_arming_do_not_latch() -> None:
    probe = unit(Signal([900, 950, 1000]))
    at(probe, 1000, POS_1)
    assert at(probe, 2000) == 0x0001


def test_edge_before_arming_that_comes_through_later_does_not_latch() -> None:
    probe = unit(Signal([990]), profile=DriveProfile(input_delay_ns=100))
    at(probe, 1000, POS_1)
    assert at(probe, 2000) == 0x0001


def test_edge_at_the_instant_of_arming_comes_too_early() -> None:
    probe = unit(Signal([1000]), profile=DriveProfile(input_delay_ns=100))
    at(probe, 1000, POS_1)
    assert at(probe, 2000) == 0x0001


def test_edge_that_comes_through_after_disarming_does_not_latch() -> None:
    probe = unit(Signal([1950]), profile=DriveProfile(input_delay_ns=100))
    at(probe, 1000, POS_1)
    assert at(probe, 2000, 0) == 0
    assert at(probe, 3000, POS_1) == 0x0001
    assert at(probe, 4000) == 0x0001


def test_single_event_ignores_further_edges_until_the_enable_toggles() -> None:
    probe = unit(Signal([1100, 1200, 1300, 1400, 3100]))
    at(probe, 1000, POS_1)
    assert at(probe, 2000) == 0x0003
    assert probe.probes[0].latches[True].units == 1100
    assert at(probe, 2000, 0) == 0x0000
    assert probe.probes[0].latches[True].units == 1100  # kept: a trap for a careless master
    assert at(probe, 3000, POS_1) == 0x0001
    assert at(probe, 4000) == 0x0003
    assert (probe.probes[0].latches[True].units, probe.probes[0].latches[True].count) == (3100, 2)


def test_re_arming_by_the_edge_bit_keeps_the_probe_enabled() -> None:
    probe = unit(Signal([1100, 1200, 3100]))
    at(probe, 1000, POS_1 | NEG_1)
    assert at(probe, 2000, 0x0021) == 0x0005  # the positive bit alone is taken away
    assert at(probe, 2500, POS_1 | NEG_1) == 0x0005
    assert at(probe, 4000) == 0x0007
    assert probe.probes[0].latches[True].units == 3100


def test_the_same_word_again_does_not_re_arm() -> None:
    probe = unit(Signal([1100, 1200, 1300]))
    at(probe, 1000, POS_1)
    at(probe, 1150, POS_1)
    at(probe, 2000)
    assert probe.probes[0].latches[True].units == 1100


def test_continuous_overwrites_and_the_counter_tells() -> None:
    probe = unit(Signal([1100, 1200, 1300, 1400, 1500]))
    at(probe, 1000, POS_1 | 0x0002)
    assert at(probe, 2000) == 0x0003
    assert (probe.probes[0].latches[True].units, probe.probes[0].latches[True].count) == (1500, 3)


@pytest.mark.long
def test_counter_wraps_at_16_bit() -> None:
    probe = unit(Signal(range(1001, 1001 + 2 * 65537)))
    at(probe, 1000, POS_1 | 0x0002)
    at(probe, 200_000)
    assert probe.probes[0].latches[True].count == 1


def test_the_reserved_source_leaves_the_probe_off() -> None:
    probe = unit(Signal([1500]))
    assert at(probe, 1000, POS_1 | 0x000C) == 0
    assert at(probe, 2000) == 0
    assert not probe.supports(POS_1 | 0x000C)
    assert not probe.supports(POS_2 | 0x0C00)
    assert probe.supports(0x3737)
    assert probe.supports(0xFBFB)


def test_open_input_never_latches() -> None:
    probe = unit(None)
    at(probe, 1000, POS_1)
    assert at(probe, 10**9) == 0x0001
    assert probe.inputs == 0


def test_delay_and_filter_shift_the_latch() -> None:
    """Edge 1500, delay 40, filter 300: the latch is at 1840 and not before."""
    profile = DriveProfile(input_delay_ns=40, input_filter_ns=300)
    probe = unit(Signal([1500]), profile=profile)
    at(probe, 1000, POS_1)
    assert at(probe, 1839) == 0x0001
    assert at(probe, 1840) == 0x0003
    assert probe.probes[0].latches[True].units == 1840


def test_pulse_shorter_than_the_filter_gives_neither_latch_nor_level() -> None:
    profile = DriveProfile(input_delay_ns=0, input_filter_ns=300)
    probe = unit(Signal([1500, 1799]), profile=profile)
    at(probe, 1000, POS_1 | NEG_1)
    assert at(probe, 9000) == 0x0001
    assert probe.inputs == 0


def test_pulse_as_long_as_the_filter_counts() -> None:
    profile = DriveProfile(input_delay_ns=0, input_filter_ns=300)
    probe = unit(Signal([1500, 1800]), profile=profile)
    at(probe, 1000, POS_1 | NEG_1)
    assert at(probe, 9000) == 0x0007
    assert [probe.probes[0].latches[level].units for level in (True, False)] == [1800, 2100]


def test_bouncing_contact_latches_once_when_it_has_settled() -> None:
    profile = DriveProfile(input_delay_ns=0, input_filter_ns=100)
    probe = unit(Signal([1000, 1030, 1050, 1090, 1120]), profile=profile)
    at(probe, 500, POS_1 | 0x0002)
    at(probe, 9000)
    assert (probe.probes[0].latches[True].units, probe.probes[0].latches[True].count) == (1220, 1)


def test_sampled_drive_latches_its_last_encoder_sample() -> None:
    profile = DriveProfile(input_delay_ns=0, latch_mode="sampled", grid_ns=400)
    probe = unit(Signal([1500]), profile=profile)
    at(probe, 1000, POS_1)
    at(probe, 2000)
    assert probe.probes[0].latches[True].units == 1200


def test_level_at_the_start_is_no_edge_and_can_be_high() -> None:
    probe = unit(Signal([2500], start=True))
    at(probe, 1000, POS_1 | NEG_1)
    assert probe.inputs == 1
    assert at(probe, 2000) == 0x0001
    assert at(probe, 3000) == 0x0005
    assert probe.inputs == 0


def test_reset_forgets_everything_but_the_level() -> None:
    probe = unit(Signal([1500]))
    at(probe, 1000, POS_1)
    at(probe, 2000)
    probe.reset()
    assert (probe.status, probe.function, probe.inputs) == (0, 0, 1)
    assert probe.probes[0].latches[True].units == 0


def debounced(edges: Sequence[int], filter_ns: int, end_ns: int) -> list[tuple[int, bool]]:
    """Reference: one look per nanosecond; the output follows what stood for the filter time."""
    raw = output = False
    changed_ns = 0
    out = []
    for now_ns in range(end_ns + 1):
        if raw != output and now_ns - changed_ns >= filter_ns:
            output = raw
            out.append((now_ns, output))
        if now_ns in edges:
            raw, changed_ns = not raw, now_ns
            if raw != output and filter_ns == 0:
                output = raw
                out.append((now_ns, output))
    return out


@given(
    st.sets(st.integers(1, 80), max_size=12).map(sorted),
    st.integers(0, 12),
    st.lists(st.integers(0, 120), max_size=6).map(sorted),
)
@pytest.mark.long
def test_input_circuit_against_a_look_per_nanosecond(
    edges: list[int], filter_ns: int, looks_ns: list[int]
) -> None:
    """Whenever the drive looks, the edges that came through are those of the reference."""
    circuit = InputCircuit(Signal(edges), DriveProfile(input_delay_ns=0, input_filter_ns=filter_ns))
    come = [hit for look in [*looks_ns, 120] for hit in circuit.passed(look)]
    assert [(latch_ns, level) for _, latch_ns, level in come] == debounced(edges, filter_ns, 120)
    assert all(latch_ns == edge_ns + filter_ns for edge_ns, latch_ns, _ in come)


def test_position_is_asked_for_once_per_latch() -> None:
    """The look-up costs a Hermite evaluation in the plant; edges that do not latch cost none."""
    asked: list[int] = []

    def position(time_ns: int) -> int:
        asked.append(time_ns)
        return time_ns

    probe = unit(Signal([1100, 1200, 1300]), position=position)
    at(probe, 1000, POS_1)
    at(probe, 2000)
    assert asked == [1100]
