"""Which lines of an EtherCAT log are shown: what is new, in a window, asked for by words."""

import struct
from pathlib import Path

import pytest
from tests.tools.test_words_of_lines import FPRD, FPWR, FRMW, frame

from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.ethercat.log import tell_lines
from axisrig.bench.tools.bus_log.reading.progress import Progress
from axisrig.kernel.time.clock import MS

COURSE = [(1, 2), (2, 2), (3, 4), (4, 4), (5, 8), (6, 2)]
"""ms, state of a slave: PREOP twice, SAFEOP twice, OP, PREOP again. Its time comes with each."""


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "run@ec1.pcapng"
    file = PcapngFile(path, ["ec1"])
    for at_ms, state in COURSE:
        time = (FRMW, 1001, 0x0910, bytes(8), 1)
        asked = (FPWR, 1001, 0x0120, struct.pack("<H", state), 1)
        file.add(at_ms * MS, 0, frame(time, asked, (FPRD, 1002, 0x0130, bytes([state, 0]), 1)))
    file.stop()
    return path


def shown(log: Path, **words: object) -> list[tuple[int, str]]:
    """Instant and name of each line."""
    selection = Selection(**words)  # type: ignore[arg-type]
    found = [text.split() for text in tell_lines([log], None, selection)]
    return [(int(float(words[0])), words[2]) for words in found]


ASKED, STATUS, TIME = "1001.FPWR", "1002.FPRD", "1001.FRMW"


def test_a_line_is_shown_when_it_says_something_new_of_its_own_name(log: Path) -> None:
    new_ms = [1, 3, 5, 6]
    assert shown(log) == [(at_ms, name) for at_ms in new_ms for name in (ASKED, STATUS)]
    whole = [(at_ms, name) for at_ms, _ in COURSE for name in (TIME, ASKED, STATUS)]
    assert shown(log, is_all=True) == whole


@pytest.mark.parametrize(
    ("from_ms", "to_ms", "new_ms"),
    [(1.0, 1.0, [1]), (1.001, 2.999, []), (3.0, 5.0, [3, 5]), (4.0, 6.0, [5, 6]), (2.0, 4.9, [3])],
)
def test_a_window_has_both_its_ends_and_what_came_before_it_is_not_new(
    from_ms: float, to_ms: float, new_ms: list[int], log: Path
) -> None:
    found = shown(log, from_ms=from_ms, to_ms=to_ms)
    assert [at_ms for at_ms, name in found if name == STATUS] == new_ms
    every = shown(log, from_ms=from_ms, to_ms=to_ms, is_all=True)
    inside = [at_ms for at_ms, _ in COURSE if from_ms <= at_ms <= to_ms]
    assert [at_ms for at_ms, name in every if name == TIME] == inside


@pytest.mark.parametrize(
    ("only", "names"),
    [
        (("AL_STATUS",), {STATUS}), ((" al_control ",), {ASKED}),
        (("fprd", "FPWR"), {ASKED, STATUS}), ((STATUS,), {STATUS}),
        (("frmw",), set()), (("sdo",), set()),
    ],
)  # fmt: skip
def test_words_ask_for_names_commands_and_registers(
    only: tuple[str, ...], names: set[str], log: Path
) -> None:
    found = shown(log, only=only)
    assert {name for _, name in found} == names
    assert len(found) == 4 * len(names)


def test_frames_are_counted_whether_they_are_shown_or_not(log: Path) -> None:
    progress = Progress()
    assert list(tell_lines([log, log], None, Selection(to_ms=0.0), progress)) == []
    assert progress.frames == 2 * len(COURSE)
