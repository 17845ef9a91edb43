"""Remote frames among transfers, registers of no name, errors of captures, words that do not act.

Frames are written by CiA 301 and ETG.1000.4, captures by the IETF draft of pcapng.
"""

import logging
from pathlib import Path

import pytest
from tests.tools.captures import interface, packet, section
from tests.tools.test_words_of_lines import FPRD, frame, names_of

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.bus_log.canopen.bus_words import Names
from axisrig.bench.tools.bus_log.reading.files import messages_of
from axisrig.bench.tools.listings.alarms import alarm_listing
from axisrig.bench.tools.listings.language import language_listing
from axisrig.kernel.errors import UserError, catalogue
from axisrig.kernel.nc.text.words import commands, variables, words

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"


# Logs


def names_and_words(names: Names, *frames: Frame) -> list[tuple[str, str]]:
    found = []
    for one in frames:
        described = names.describe("can1", one, names.follow("can1", one, dissect(one)))
        found.append((described.name, described.text))
    return found


def remote(can_id: int) -> Frame:
    return Frame(can_id, b"", False, True, 8)


@pytest.mark.parametrize("can_id", [0x603, 0x583])
@pytest.mark.parametrize("place", [1, 2, 3, 4])
def test_a_remote_frame_is_no_part_of_a_transfer_and_ends_none(can_id: int, place: int) -> None:
    """A download of 9 bytes in a block of two segments: 01 .. 07, then 08 and 09."""
    frames = [
        data_frame(number, bytes.fromhex(text))
        for number, text in (
            (0x603, "C600200109000000"), (0x583, "A400200102000000"), (0x603, "0101020304050607"),
            (0x603, "8208090000000000"), (0x583, "A202020000000000"),
        )
    ]  # fmt: skip
    plain = names_and_words(Names(None), *frames)
    found = names_and_words(Names(None), *frames[:place], remote(can_id), *frames[place:])
    name = "3.SDO request" if can_id == 0x603 else "3.SDO answer"
    assert found.pop(place) == (name, "remote frame")
    assert found == plain


@pytest.mark.parametrize(("can_id", "name"), [(0x183, "Z.TPDO1"), (0x283, "Z.TPDO2")])
def test_who_asks_for_a_pdo_sends_no_values(can_id: int, name: str) -> None:
    names = Names(settings_of(RIGS / "probe-z.toml", []))
    assert names_and_words(names, remote(can_id)) == [(name, "remote frame")]


@pytest.mark.parametrize("register", [0x000F, 0x011F, 0x0121, 0x0131, 0x090F, 0x0911, 0x0FFF])
def test_a_register_that_has_no_name_is_none_of_its_neighbours(register: int) -> None:
    """ETG.1000.4: AL control 0x0120, AL status 0x0130, system time 0x0910."""
    names = names_of("probe-xyz-ethercat")
    (one,) = names.describe("ec1", frame((FPRD, 1001, register, b"\x08\0", 1)))
    assert one.text == f"WKC 1  0x{register:04X} 08 00"
    assert f"0x{register:04x}" in one.tags


@pytest.mark.parametrize("link", [1, 105, 228])
def test_a_capture_of_another_link_is_refused_with_its_file_and_what_is_allowed(
    link: int, tmp_path: Path
) -> None:
    """SocketCAN is 227 (tcpdump.org, link-layer header types)."""
    path = tmp_path / "some.pcapng"
    path.write_bytes(section() + interface(link) + packet(1000, bytes(16)))
    with pytest.raises(UserError, match="another link type") as caught:
        list(messages_of([path]))
    found = caught.value
    assert (found.file, found.value, found.allowed) == (str(path), link, "227 (SocketCAN)")


CANDUMP = "(0.001000) can0 081#0102030405060708\n"


@pytest.mark.parametrize("is_cut", [False, True])
def test_who_reads_a_log_leaves_the_warnings_of_other_readers_as_they_were(
    is_cut: bool, tmp_path: Path
) -> None:
    """A frame that a reader leaves out is an error here alone, also where the log is damaged."""
    path = tmp_path / "a.log"
    path.write_text(CANDUMP + "(0.002000) can0 08" * is_cut, encoding="utf-8")
    reader = logging.getLogger("can.io")
    before = list(reader.handlers)
    if is_cut:
        with pytest.raises(UserError, match="the last line is cut") as refused:
            list(messages_of([path]))
        assert refused.value.line == 2
    else:
        assert [message.arbitration_id for message in messages_of([path])] == [0x81]
    assert reader.handlers == before


# Listings


@pytest.mark.parametrize(
    ("word", "program", "page"),
    [
        ("$REPEAT", "$REPEAT|P1 = P1 + 1|$UNTIL P1 >= 5", "nc-program.md#control-structures"),
        ("G159", "N10 G159 = 7|N20 G0 X0 Y0", "coordinates.md"),
        ("#ENDVAR", "#VAR|V.P.COUNT : UNS32 = 5|V.P.TABLE[2][3] = [1,2,3,4,5,6]|#ENDVAR",
         "nc-program.md#variables"),
    ],
)  # fmt: skip
def test_an_example_of_several_lines_is_shown_whole_and_in_its_order(
    word: str, program: str, page: str
) -> None:
    """Each line begins where that of the first one does."""
    first, *others = program.split("|")
    lines = language_listing(word).splitlines()
    expected = [f"    example: {first}", *(f"{'':<13}{line}" for line in others)]
    assert lines[-len(expected) - 1 :] == [*expected, f"    see docs/{page}"]


def test_each_word_that_does_not_act_is_marked_in_the_list_and_alone() -> None:
    """G41, G42 and M19 are read and not done."""
    lines = set(language_listing().splitlines())
    rows = [(w.word, w.acts, w.meaning) for kind in ("G", "M") for w in words(kind).values()]
    rows += [(v.name, v.acts, v.meaning) for v in variables()]
    rows += [(f"#{name}", table[""].acts, table[""].meaning) for name, table in commands().items()
             if name[0].isupper() and not name.startswith("L ")]  # fmt: skip
    marked = set()
    for name, acts, meaning in rows:
        assert f"{name:<32} {'' if acts else '(-) '}{meaning}" in lines, name
        if not acts:
            marked.add(name)
    assert {"G41", "G42", "M19"} <= marked
    for name in ("G41", "M19"):
        assert language_listing(name).startswith(f"{name:<32} (-) ")
    assert "(-)" not in language_listing("G40").splitlines()[0]


def test_an_area_that_is_like_none_is_refused_with_each_area_once() -> None:
    with pytest.raises(UserError, match="no area of alarms") as caught:
        alarm_listing(area="0000000")
    assert caught.value.value == "0000000"
    areas = sorted({one.area for one in catalogue().values()})
    assert caught.value.allowed == ", ".join(areas)
