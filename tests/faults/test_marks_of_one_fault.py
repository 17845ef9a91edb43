"""What the record of a fault says: in its marks, and in a line."""

import pytest

from axisrig.bench.machine.faults.acts import Injected, drawn
from axisrig.bench.rig.reading.faults import Fault
from axisrig.kernel.time.clock import MS, US


def test_a_fault_without_frames_has_a_begin_and_an_end() -> None:
    record = Injected("probe_stick probe", "")
    assert record.marks() == []
    assert record.in_words() == "fault probe_stick probe: its moment has not come"
    record.begin_ns = 2500 * US
    assert record.marks() == [(2500 * US, "probe_stick probe begins")]
    assert record.in_words() == "fault probe_stick probe: from 2.5 ms"
    record.end_ns = 4 * MS
    assert record.marks() == [
        (2500 * US, "probe_stick probe begins"), (4 * MS, "probe_stick probe ends")
    ]  # fmt: skip


def test_a_fault_of_frames_marks_the_last_that_it_has_hit() -> None:
    """One that has hit none says so in its line, and has no mark of it."""
    record = Injected("drop Z.TPDO1", "Z", hits=0, begin_ns=0)
    assert record.marks() == [(0, "drop Z.TPDO1 begins")]
    assert record.in_words() == "fault drop Z.TPDO1: from 0 ms, frames hit: 0"
    for number, words in ((1, "1 frame hit"), (2, "2 frames hit, the last"),
                          (3, "3 frames hit, the last")):  # fmt: skip
        record.count(number * MS)
        assert record.marks()[1:] == [(number * MS, f"drop Z.TPDO1: {words}")]
        assert record.in_words().endswith(f"from 0 ms, frames hit: {number}")
    record.end_ns = 9 * MS
    assert [at_ns for at_ns, _ in record.marks()] == [0, 3 * MS, 9 * MS]


def test_a_record_without_a_count_counts_from_its_first_frame() -> None:
    record = Injected("drop Z.TPDO1", "Z")
    record.count(7)
    assert (record.hits, record.last_hit_ns) == (1, 7)


def _numbers(seed: int, *faults: tuple[str, str]) -> list[float]:
    """The first number that each of these faults draws."""
    given = [Fault(kind, target, "", "", "", {}) for kind, target in faults]
    return [numbers.random() for _, numbers in drawn(seed, given)]


def test_what_a_fault_draws_hangs_on_seed_kind_target_and_place_among_its_like() -> None:
    """A further fault changes nothing about the others."""
    both = _numbers(1, ("drop", "Z.TPDO1"), ("drop", "Z.TPDO1"))
    assert _numbers(1, ("drop", "Z.TPDO1")) == both[:1]
    assert both[0] != both[1]
    others = (("alter", "Z.TPDO1"), ("drop", "X.TPDO1"), ("drop", "Z.TPDO2"))
    more = _numbers(1, ("drop", "Z.TPDO1"), *others, ("drop", "Z.TPDO1"))
    assert [more[0], more[-1]] == both
    assert len({*more}) == len(more)
    assert not {*more} & {*_numbers(2, ("drop", "Z.TPDO1"), *others, ("drop", "Z.TPDO1"))}


@pytest.mark.parametrize("seed", [0, 7])
def test_the_same_seed_draws_the_same(seed: int) -> None:
    faults = (("drop", "Z.TPDO1"), ("alter", "Z.TPDO1"))
    assert _numbers(seed, *faults) == _numbers(seed, *faults)
