"""#IDENT in a running channel: the same way to the drive as #DRIVE, with idents of SERCOS."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.nc import canon

Make = Callable[..., Any]
SDO_REQUEST = 0x601
TORQUE, WINDOW = "S-0-0092", "S-0-0159"


def _bench(channel_bench: Make, words: Any, *, window: int = 1048575) -> Any:
    start_up = StartUpSettings(writes=[(0x6072, 0, 65535), (0x6065, 0, window)])
    return channel_bench(words.axis("Z"), start_up=start_up, functions={})


def _write(words: Any, number: int, ident: str, value: float, length: int) -> canon.DriveWrite:
    return canon.DriveWrite(words.end(number).block, "Z", ident, value, True, length)


def _read(words: Any, number: int, ident: str, length: int) -> canon.DriveRead:
    return canon.DriveRead(words.end(number).block, "Z", ident, length)


def test_torque_limited_and_watch_off_as_printed(channel_bench: Make, words: Any) -> None:
    """FCT-C4 7.3.1, N080 and N100: 6072 = 100, 6065 = 0xFFFFFFFF, by expedited downloads."""
    bench = _bench(channel_bench, words)
    bench.run([_write(words, 8, TORQUE, 100, 2), _write(words, 10, WINDOW, 0, 4), words.end()])
    assert bench.alarm_ids == []
    start_ns = bench.channel.start_ns
    frames = [d for t, can_id, d in bench.frames if can_id == SDO_REQUEST and t > start_ns]
    assert frames == [bytes.fromhex("2b72600064000000"), bytes.fromhex("23656000ffffffff")]
    assert bench.nodes["Z"].image.max_torque == 100


@pytest.mark.parametrize("window", [1, 1048575, 0xFFFFFFFE, 0xFFFFFFFF])
def test_what_was_read_is_restored_to_the_last_increment(
    channel_bench: Make, words: Any, window: int
) -> None:
    bench = _bench(channel_bench, words, window=window)
    bench.prepare([])
    channel = bench.channel

    def program() -> Any:
        yield _read(words, 1, WINDOW, 4)
        yield canon.Wait(words.end(1).block)
        yield _write(words, 2, WINDOW, 12345, 4)
        yield _write(words, 3, WINDOW, channel.drive_value("Z", WINDOW), 4)
        yield words.end()

    channel.load(program())
    bench.finish()
    assert bench.alarm_ids == []
    assert bench.nodes["Z"].image.following_window == window


@pytest.mark.provokes(900255, 2, axis="Z", ident="S-0-0104", known="S-0-0092, S-0-0159")
def test_900255_lists_the_idents_that_there_are(channel_bench: Make, words: Any) -> None:
    bench = _bench(channel_bench, words)
    bench.run([_write(words, 7, "S-0-0104", 1, 2), words.end()])
    (alarm,) = bench.channel.alarms
    assert alarm.id == 900255
    assert "N70" in str(alarm)
    assert "S-0-0092, S-0-0159" in str(alarm)


@pytest.mark.provokes(900256, 2, keyword="TYP", value="2", allowed="4 for S-0-0159")
def test_900256_for_a_length_that_the_ident_does_not_have(channel_bench: Make, words: Any) -> None:
    bench = _bench(channel_bench, words)
    bench.run([_read(words, 7, WINDOW, 2), words.end()])
    assert bench.alarm_ids == [900256]


@pytest.mark.provokes(900257, 4, axis="Z", object="0x6065:0", ident=WINDOW, off=0)
def test_900257_for_a_window_that_no_ident_can_tell(channel_bench: Make, words: Any) -> None:
    bench = _bench(channel_bench, words, window=0)
    bench.run([_read(words, 7, WINDOW, 4), words.end()])
    (alarm,) = bench.channel.alarms
    assert alarm.id == 900257
    assert "N70" in str(alarm)
