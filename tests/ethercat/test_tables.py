"""The tables of EtherCAT agree with the enumerations and with themselves."""

from itertools import pairwise

from axisrig.kernel.profiles.ethercat import layouts, tables


def test_commands_and_states_are_those_of_their_tables() -> None:
    assert tables.al_states() == {state.value: state.name for state in tables.AlState}
    assert {c: r.name for c, r in tables.commands().items()} == {
        c.value: c.name for c in tables.Command
    }


def test_registers_do_not_overlap() -> None:
    rows = sorted(tables.registers().values(), key=lambda row: row.address)
    for before, after in pairwise(rows):
        assert before.address + before.size <= after.address, after.name
    assert rows[-1].address + rows[-1].size == 0x1000


def test_layouts_have_the_sizes_of_their_registers() -> None:
    assert (layouts.FMMU.size, layouts.SYNC_MANAGER.size) == (16, 8)
    assert (layouts.DATAGRAM.size, layouts.FIRST_DATAGRAM) == (10, 16)
    assert (layouts.MAILBOX.size, layouts.SDO.size, layouts.SDO_INFORMATION.size) == (6, 4, 4)
    assert tables.address_of("AL_STATUS_CODE") == 0x0134
    assert tables.al_status_codes()["WATCHDOG"] == 0x001B
    assert tables.al_status_text(0x0035).startswith("0x0035, cycle of DC")
    assert tables.al_status_text(0x7FFF) == "0x7FFF, a code of the manufacturer"
    assert tables.sii_categories()["RXPDO"] == 51


def test_an_al_status_has_a_state_an_error_bit_and_others() -> None:
    """0130: bits 3..0 the state, bit 4 error, bit 5 that an identification is in 0134."""
    for state in tables.AlState:
        assert tables.state_name(state) == state.name
        assert tables.state_name(state | 0x20) == state.name
        assert tables.state_name(state | 0x10) == f"{state.name} with error"
        assert tables.state_name(state | 0x30) == f"{state.name} with error"
    assert (tables.state_name(0x05), tables.state_name(0x15)) == ("0x5", "0x5 with error")


def test_what_a_command_does_is_in_its_name() -> None:
    """RD reads, WR writes, RW does both; MW is read of one slave and writes all others."""
    for row in tables.commands().values():
        kind = row.name[-2:]
        assert row.reads is (kind in ("RD", "RW", "MW")), row.name
        assert row.writes is (kind in ("WR", "RW", "MW")), row.name
