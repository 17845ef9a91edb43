"""Frames of a stored log as a table: instants in nanoseconds, kinds, segments."""

from pathlib import Path

import can
import pandas as pd
import pytest
from tests.recordings import facts

from axisrig.bench.campaign.results.stored import RECORDING
from axisrig.bench.record.bus import BusFigures
from axisrig.bench.record.facts import run_text
from axisrig.kernel.errors import UserError
from axisrig.results import loading
from axisrig.results.loading import load

TIMES_US = [*range(0, 2500, 7), 999_999, 1_000_001, 17_123_457, 1_000_000_000_001]
"""Up to 11 days: of these a float is exact to far below 1 us."""


def folder_of(place: Path, lines: list[str]) -> Path:
    for name in ("bus", "runs"):
        (place / name).mkdir()
    (place / "cases.csv").write_text("run,verdict\nr,pass\n", encoding="utf-8")
    (place / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    buses = tuple(BusFigures(name, 1_000_000, 0, 0, 0, 0, 0, "", (), ()) for name in ("a", "b"))
    (place / "runs" / "r.json").write_text(run_text(facts(buses=buses)), encoding="utf-8")
    (place / "bus" / "r.log").write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return place


def test_an_instant_is_the_one_of_the_log_to_the_nanosecond(tmp_path: Path) -> None:
    """A log of candump has whole microseconds; as fractions of a second most are no whole bits."""
    lines = [f"({us // 10**6}.{us % 10**6:06d}) a 181#{n % 256:02X}"
             for n, us in enumerate(TIMES_US)]  # fmt: skip
    found = load(folder_of(tmp_path, lines)).frames("r")
    assert found["time_ns"].tolist() == [us * 1000 for us in TIMES_US]
    assert str(found["time_ns"].dtype) == "int64"
    assert found.attrs["units"] == {"time_ns": "ns"}
    assert found["data"].tolist() == [f"{n % 256:02x}" for n in range(len(TIMES_US))]


def test_a_frame_has_its_identifier_data_kind_and_segment(tmp_path: Path) -> None:
    lines = [
        "(0.000001) a 7FF#0102030405060708",
        "(0.000002) b 00000181#FF",  # 8 digits: 29 bits
        "(0.000003) b 080#",
        "(0.000004) a 701#R",
        "(0.000005) other 1FFFFFFF#00",
    ]
    found = load(folder_of(tmp_path, lines)).frames("r")
    columns = ["segment", "id", "data", "is_extended", "is_remote", "is_error"]
    assert [tuple(row) for row in found[columns].itertuples(index=False)] == [
        ("a", 0x7FF, "0102030405060708", False, False, False),
        ("b", 0x181, "ff", True, False, False),
        ("b", 0x080, "", False, False, False),
        ("a", 0x701, "", False, True, False),
        ("other", 0x1FFFFFFF, "00", True, False, False),
    ]


def test_telegrams_of_an_ethercat_line_are_no_frames_of_a_can_bus(tmp_path: Path) -> None:
    """A rig with both leaves both; its table has the CAN frames, whatever the others are."""
    place = folder_of(tmp_path, ["(0.000001) a 7FF#01", "(0.000002) b 080#"])
    alone = load(place).frames("r")
    (place / "bus" / "r@ec1.pcapng").write_bytes(b"no block of it is read")
    pd.testing.assert_frame_equal(load(place).frames("r"), alone)
    assert alone["segment"].tolist() == ["a", "b"]
    (place / "bus" / "r.log").unlink()
    with pytest.raises(UserError, match="CAN"):
        load(place).frames("r")


def test_frames_are_those_of_the_recording_that_a_run_shares(tmp_path: Path) -> None:
    """A row that was judged again, or that ran as another one, has no log of its own name."""
    place = folder_of(tmp_path, ["(0.000001) a 181#01"])
    rows = f"run,verdict,{RECORDING}\nr,pass,\nagain,pass,r\n"
    (place / "cases.csv").write_text(rows, encoding="utf-8")
    found = load(place)
    assert found.frames("again")["data"].tolist() == found.frames("r")["data"].tolist() == ["01"]


def test_an_instant_of_a_log_with_nanoseconds_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A log of BLF or pcap has them; as seconds they are floats."""
    times_ns = [1, 999, 1_000_000_001, 3_600_000_000_123]
    frames = [can.Message(timestamp=ns / 1e9, arbitration_id=1, channel=0) for ns in times_ns]
    monkeypatch.setattr(loading, "messages_of", lambda _: iter(frames))
    found = load(folder_of(tmp_path, [])).frames("r")
    assert found["time_ns"].tolist() == times_ns


@pytest.mark.parametrize(
    ("channel", "segment"), [(0, "a"), (1, "b"), (2, "2"), (-1, "-1"), ("can7", "can7"), (None, "")]
)
def test_a_channel_by_its_number_is_a_segment_of_the_rig(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, channel: object, segment: str
) -> None:
    """From 0 in the order of the rig; of two segments a frame without a channel is of neither."""
    frame = can.Message(timestamp=0.0, arbitration_id=1, channel=channel)
    monkeypatch.setattr(loading, "messages_of", lambda _: iter([frame]))
    assert load(folder_of(tmp_path, [])).frames("r")["segment"].tolist() == [segment]
