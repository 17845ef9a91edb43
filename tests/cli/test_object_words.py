"""Values of objects in words, beside the bits of CiA 301 and CiA 402-2 written out."""

import pytest

from axisrig.bench.tools.bus_log.canopen.object_words import bits_words
from axisrig.kernel.profiles.cia402.ds402 import ProbeFunction, ProbeStatus


@pytest.mark.parametrize(
    ("controlword", "words"),
    [
        (0x0000, "disable voltage"), (0x0002, "quick stop"), (0x0006, "shutdown"),
        (0x0007, "switch on"), (0x000F, "enable operation"), (0x0080, "fault reset"),
        (0x001F, "enable operation"), (0x010F, "enable operation, halt"),
    ],
)  # fmt: skip
def test_commands_of_the_controlword(controlword: int, words: str) -> None:
    assert bits_words(0x6040, controlword) == words


@pytest.mark.parametrize(
    ("masked", "free", "words"),
    [
        (0x00, 0x20, "not ready to switch on"), (0x40, 0x20, "switch on disabled"),
        (0x21, 0x00, "ready to switch on"), (0x23, 0x00, "switched on"),
        (0x27, 0x00, "operation enabled"), (0x07, 0x00, "quick stop active"),
        (0x0F, 0x20, "fault reaction active"), (0x08, 0x20, "fault"),
    ],
)  # fmt: skip
def test_states_of_the_statusword(masked: int, free: int, words: str) -> None:
    """CiA 402-2: bits 0 to 3, 5 and 6, of which some states leave bit 5 free; bit 4 is voltage."""
    for value in (masked, masked | 0x10, masked | free, masked | free | 0x10):
        assert bits_words(0x6041, value) == words


@pytest.mark.parametrize("value", [0x01, 0x02, 0x03, 0x06, 0x0B, 0x22, 0x24, 0x48, 0x61, 0x67])
def test_bits_that_are_no_state_are_so_in_words(value: int) -> None:
    assert bits_words(0x6041, value) == "no state"
    assert bits_words(0x6041, value | 0x80) == "no state, warning"


@pytest.mark.parametrize(
    ("index", "value", "words"),
    [
        (0x6041, 0x0237, "operation enabled"),
        (0x6041, 0x0AB7, "operation enabled, warning, internal limit"),
        (0x6041, 0x0218, "fault"),
        (0x60B8, 0x0000, "probes off"),
        (0x60B8, 0x0013, "probe 1 on, 1 every event, 1 positive edge"),
        (0x60B8, 0x0025, "probe 1 on, 1 zero pulse, 1 negative edge"),
        (0x60B8, 0x1900, "probe 2 on, 2 source of 60D0, 2 positive edge"),
        (0x60B8, 0x2700, "probe 2 on, 2 every event, 2 zero pulse, 2 negative edge"),
        (0x60B9, 0x0007, "probe 1 on, 1 positive stored, 1 negative stored"),
        (0x60B9, 0x0700, "probe 2 on, 2 positive stored, 2 negative stored"),
        (0x60FD, 0x00030007,
         "negative limit, positive limit, home switch, probe input 1, probe input 2"),
        (0x1001, 0x21, "generic, device profile"),
        (0x6061, 6, "homing"),
        (0x603F, 0x7305, "incremental encoder 1"),
        (0x6064, 5, ""),
    ],
)  # fmt: skip
def test_bits_and_numbers(index: int, value: int, words: str) -> None:
    assert bits_words(index, value) == words


@pytest.mark.parametrize(("index", "bits"), [(0x60B8, ProbeFunction), (0x60B9, ProbeStatus)])
def test_every_probe_bit_of_the_drive_has_words(
    index: int, bits: type[ProbeFunction] | type[ProbeStatus]
) -> None:
    assert all(bits_words(index, bit).replace("probes off", "") for bit in bits)
