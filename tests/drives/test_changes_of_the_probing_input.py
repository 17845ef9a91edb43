"""Another probing input and back again: what each input has had before still counts for it."""

from pathlib import Path

import pytest
from tests.drives.test_link_by_hand import Wire, _link

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.errors import Alarm

HEAD = (
    "pdo,transmission,inhibit_100us,index,sub,bits,signed,field\n"
    "RPDO1,1,0,0x6040,0,16,no,controlword\nRPDO1,1,0,0x607A,0,32,yes,target\n"
    "RPDO1,1,0,0x60B8,0,16,no,probe_function\nTPDO1,1,0,0x6041,0,16,no,statusword\n"
    "TPDO1,1,0,0x6064,0,32,yes,actual\nTPDO1,1,0,0x60B9,0,16,no,probe_status\n"
)
POSITIONS = "TPDO2,1,0,0x60BA,0,32,yes,latch\nTPDO3,1,0,0x60BC,0,32,yes,\n"
COUNTED = (
    "TPDO2,1,0,0x60BA,0,32,yes,latch\nTPDO2,1,0,0x60D5,0,16,no,latch_count\n"
    "TPDO3,1,0,0x60BC,0,32,yes,\nTPDO3,1,0,0x60D7,0,16,no,\n"
)
ENABLED, STORED = {1: 0x1, 2: 0x100}, {1: 0x3, 2: 0x300}


class Inputs:
    """A link whose drive keeps a latch of each input; counts: None without counters."""

    def __init__(self, folder: Path, rows: str, counts: dict[int, int] | None = None) -> None:
        table = folder / "map.csv"
        table.write_text(HEAD + rows, encoding="utf-8")
        made: tuple[AxisLink, Wire] = _link(pdo_map=str(table))
        self.link, self.wire = made
        self.latches, self.counts = {1: 100, 2: 200}, counts

    def cycle(self, status: int, **late: int) -> None:
        """One SYNC; late: what comes for the latch or the count of input 1 instead."""
        self.wire._bring(
            0x183, b"\x37\x12" + (1000).to_bytes(4, "little") + status.to_bytes(2, "little")
        )
        for can_id, probe in ((0x283, 1), (0x383, 2)):
            latch = late.get("latch", self.latches[1]) if probe == 1 else self.latches[2]
            data = latch.to_bytes(4, "little")
            if self.counts is not None:
                count = late.get("count", self.counts[1]) if probe == 1 else self.counts[2]
                data += count.to_bytes(2, "little")
            self.wire._bring(can_id, data)
        self.link.take()

    def run(self, probe: int, latched: int, cycles: int = 8) -> float | None:
        """Measure with an input whose latch comes at a place; return the latched position."""
        self.cycle(0)
        self.link.arm()
        self.cycle(ENABLED[probe])
        self.latches[probe] = latched
        if self.counts is not None:
            self.counts[probe] += 1
        for _ in range(cycles):
            self.cycle(STORED[probe])
        found = self.link.latched_mm
        self.link.disarm()
        self.cycle(0)
        return found


@pytest.mark.parametrize("others", [(), (2,), (2, 1, 2)])
def test_a_latch_of_an_earlier_run_of_the_same_input_is_old_after_other_inputs_too(
    tmp_path: Path, others: tuple[int, ...]
) -> None:
    """Two telegrams prove a position that was never reported, and eight one that was."""
    bench = Inputs(tmp_path, POSITIONS)
    assert [bench.run(1, place) for place in (1010, 1020)] == [1.01, 1.02]
    for other in (*others, 1):
        bench.link.choose_latch(other, "POS")
    bench.cycle(0)
    bench.link.arm()
    bench.cycle(ENABLED[1])
    for _ in range(7):
        bench.cycle(STORED[1], latch=1010)
        assert bench.link.latched_mm is None
    bench.cycle(STORED[1], latch=1010)
    assert bench.link.latched_mm == 1.01


def test_a_latch_of_the_other_input_is_new_to_this_one(tmp_path: Path) -> None:
    bench = Inputs(tmp_path, POSITIONS)
    assert bench.run(1, 1010) == 1.01
    bench.link.choose_latch(2, "POS")
    assert bench.run(2, 1010, cycles=2) == 1.01
    bench.link.choose_latch(1, "POS")
    assert bench.run(1, 1030, cycles=2) == 1.03


def test_a_counter_that_comes_late_is_late_after_another_input_too(tmp_path: Path) -> None:
    """60D5 was at 6 when input 2 was chosen: a telegram with 5 is one of before."""
    bench = Inputs(tmp_path, COUNTED, {1: 5, 2: 30})
    assert bench.run(1, 1010, cycles=1) == 1.01
    bench.link.choose_latch(2, "POS")
    assert bench.run(2, 1020, cycles=1) == 1.02
    bench.link.choose_latch(1, "POS")
    bench.link.arm()
    bench.cycle(ENABLED[1], count=5)
    bench.latches[1], bench.counts = 1030, {1: 7, 2: 31}
    bench.cycle(STORED[1])
    assert bench.link.latched_mm == 1.03


def test_each_input_goes_on_with_its_own_counter(tmp_path: Path) -> None:
    """One telegram proves each latch, there and back."""
    bench = Inputs(tmp_path, COUNTED, {1: 5, 2: 30})
    for turn, probe in enumerate((1, 2, 1, 1, 2, 1)):
        bench.link.choose_latch(probe, "POS")
        assert (bench.link.probe_input, bench.link.edge) == (probe, "POS")
        assert bench.run(probe, 1001 + turn, cycles=1) == (1001 + turn) / 1000.0


def test_after_a_restart_both_inputs_begin_anew(tmp_path: Path) -> None:
    """Counters begin at 0 again; without that they would be late for four cycles."""
    bench = Inputs(tmp_path, COUNTED, {1: 5, 2: 30})
    for probe in (1, 2):
        bench.link.choose_latch(probe, "POS")
        assert bench.run(probe, 1010, cycles=1) == 1.01
    bench.link.forget()
    bench.counts = {1: 0, 2: 0}
    for probe in (2, 1):
        bench.link.choose_latch(probe, "POS")
        assert bench.run(probe, 1020, cycles=1) == 1.02


def test_the_word_that_enables_and_the_bits_of_the_status_are_those_of_the_input(
    tmp_path: Path,
) -> None:
    """60B8: bits 0 and 4 of input 1, 8 and 12 of input 2 (CiA 402-2)."""
    bench = Inputs(tmp_path, POSITIONS)
    for probe, word in ((1, 0x11), (2, 0x1100), (1, 0x11)):
        bench.link.choose_latch(probe, "POS")
        bench.link.arm()
        bench.link.send(0.0)
        assert bench.wire.sent[0x203][6:8] == word.to_bytes(2, "little")
        for of_drive, is_armed in ((1, probe == 1), (2, probe == 2)):
            bench.cycle(ENABLED[of_drive])
            assert bench.link.is_armed is is_armed
        bench.link.disarm()
        bench.link.send(0.0)
        assert bench.wire.sent[0x203][6:8] == bytes(2)


@pytest.mark.provokes(900223, 4, axis="Z", object="0x60BB")
def test_a_choice_without_its_object_changes_nothing(tmp_path: Path) -> None:
    bench = Inputs(tmp_path, POSITIONS)
    bench.link.choose_latch(2, "POS")
    with pytest.raises(Alarm) as refused:
        bench.link.choose_latch(1, "NEG")
    assert (refused.value.values["input"], refused.value.values["edge"]) == (1, "NEG")
    assert (bench.link.probe_input, bench.link.edge) == (2, "POS")
    assert bench.run(2, 1010, cycles=2) == 1.01


INPUTS = HEAD + POSITIONS + "TPDO3,1,0,0x60FD,0,32,no,inputs\n"


@pytest.mark.parametrize(("probe", "bit"), [(1, 16), (2, 17)])
def test_whether_the_probe_is_actuated_is_the_bit_of_the_input_in_use(
    tmp_path: Path, probe: int, bit: int
) -> None:
    """60FD is None until it has come, and stays when a telegram is missing."""
    table = tmp_path / "map.csv"
    table.write_text(INPUTS, encoding="utf-8")
    link, wire = _link(pdo_map=str(table))
    assert link.is_actuated is None
    link.choose_latch(3 - probe, "POS")
    link.choose_latch(probe, "POS")
    for inputs, is_actuated in ((1 << bit, True), (0, False), (~(1 << bit) & 0xFFFFFFFF, False)):
        wire.status(0x1237, 0)
        wire.latch()
        wire._bring(0x383, bytes(4) + inputs.to_bytes(4, "little"))
        link.take()
        assert link.is_actuated is is_actuated
    link.take()
    assert link.is_actuated is False
