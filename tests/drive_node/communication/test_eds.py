"""The EDS tells the truth: foreign readers accept it, and the drive has what it says."""

import csv
import io
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from configparser import ConfigParser
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from canopen.objectdictionary import ODVariable, datatypes
from canopen.objectdictionary.eds import import_eds
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.objects import TABLES
from axisrig.bench.drive.cia402.dictionary.profiles import named_profile, profile_names
from axisrig.bench.tools.bus_log.canopen.transfers import Transfers, Value
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

Make = Callable[..., Any]

READ_ONLY, WRITE_ONLY = 0x06010002, 0x06010001
# Values of the running drive; the EDS gives a default that need not be theirs
LIVE = {0x1001, 0x1003, 0x1018, 0x6041, 0x6061, 0x6502, 0x606C, 0x6077, 0x6078, 0x60FD}


@pytest.mark.long
@pytest.mark.parametrize("name", profile_names())
def test_foreign_checker_has_no_complaint_about_any_profile(name: str, tmp_path: Path) -> None:
    """`dcfchk` of lely's dcf-tools, by its own command line."""
    if find_spec("dcf") is None:
        pytest.skip("dcf-tools is not installed (pip install dcf-tools)")
    eds = tmp_path / "drive.eds"
    eds.write_text(eds_text(named_profile(name)), encoding="ascii", newline="\r\n")
    check = "import sys; from dcf.cli import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", check, "-n", "5", str(eds)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def variables_of(text: str) -> Iterator[ODVariable]:
    for entry in import_eds(io.StringIO(text), 3).values():
        if entry.index >= 0x1000:
            yield from [entry] if isinstance(entry, ODVariable) else entry.values()


@pytest.mark.parametrize("name", ["generic", "epos4-like", "steppeonline-like"])
@pytest.mark.long(but=1)
def test_the_drive_has_what_its_eds_says(drive_bench: Make, name: str) -> None:
    """Every variable: length, default, access rights, and nothing beside them in its object."""
    profile = named_profile(name)
    bench = drive_bench(profile=profile)
    sdo, text = bench.remote.sdo, eds_text(profile)
    for variable in variables_of(text):
        where = f"{variable.index:04X}:{variable.subindex}"
        data, code = b"", 0
        try:
            data = sdo.upload(variable.index, variable.subindex)
        except SdoAbortedError as refusal:
            code = refusal.code
        assert code == (0x08000024 if variable.index == 0x1003 and variable.subindex else 0), where
        is_number = variable.data_type in datatypes.NUMBER_TYPES
        if is_number and not code:
            assert 8 * len(data) == len(variable), where
            if variable.index not in LIVE and variable.access_type != "ro":
                assert variable.decode_raw(data) == variable.default, where
        if not variable.writable:
            with pytest.raises(SdoAbortedError) as caught:
                sdo.download(variable.index, variable.subindex, data or b"\0\0\0\0")
            assert caught.value.code == READ_ONLY, where


def test_limits_of_the_tables_are_in_the_eds_also_where_they_are_0() -> None:
    """A row of the tables without a limit has no line of its own."""
    eds = ConfigParser()
    eds.read_string(eds_text(named_profile("generic")))
    folder = resources.files("axisrig.bench.drive.cia402.dictionary")
    texts = [folder.joinpath(name).read_text(encoding="utf-8") for name in TABLES]
    rows = [row for text in texts for row in csv.DictReader(text.splitlines())]
    given = dict.fromkeys(("low", "high"), 0)
    for row in rows:
        title = row["index"] + (f"sub{int(row['sub']):X}" if row["sub"] else "")
        for column, entry in (("low", "LowLimit"), ("high", "HighLimit")):
            if eds.has_section(title):
                shown = eds[title].get(entry, "")
                assert (int(shown, 0) if shown else "") == (
                    int(row[column], 0) if row[column] else ""
                ), (title, entry)
                given[column] += row[column] == "0"
    assert min(given.values()) > 0, "no limit of 0 in the tables"


@pytest.mark.parametrize("name", profile_names())
def test_the_head_of_an_eds_counts_what_follows_it(name: str) -> None:
    """PDOs by their communication parameters (CiA 306-1: NrOfRXPDO, NrOfTXPDO), lists, sub-indices.

    CiA 301: 1400 to 15FF receive, 1800 to 19FF transmit.
    """
    text = eds_text(named_profile(name), "as-named.eds")
    eds = ConfigParser()
    eds.optionxform = str  # type: ignore[assignment, method-assign]
    eds.read_string(text)
    objects = [int(section, 16) for section in eds if re.fullmatch("[0-9A-F]{4}", section)]
    device = eds["DeviceInfo"]
    assert eds["FileInfo"]["FileName"] == "as-named.eds"
    for key, low, high in (("NrOfRXPDO", 0x1400, 0x15FF), ("NrOfTXPDO", 0x1800, 0x19FF)):
        assert int(device[key]) == sum(low <= index <= high for index in objects) > 0
    identity = {"VendorNumber": 1, "ProductNumber": 2, "RevisionNumber": 3}
    for key, sub in identity.items():
        assert int(device[key], 0) == int(eds[f"1018sub{sub}"]["DefaultValue"], 0)
    listed: list[int] = []
    for title, is_of in (
        ("MandatoryObjects", lambda index: index in (0x1000, 0x1001, 0x1018)),
        (
            "OptionalObjects",
            lambda index: index not in (0x1000, 0x1001, 0x1018) and not 0x2000 <= index < 0x6000,
        ),
        ("ManufacturerObjects", lambda index: 0x2000 <= index < 0x6000),
    ):
        section = dict(eds[title])
        count = int(section.pop("SupportedObjects"))
        assert list(section) == [str(number) for number in range(1, count + 1)]
        indices = [int(value, 16) for value in section.values()]
        assert all(is_of(index) for index in indices)
        listed += indices
    assert sorted(listed) == sorted(objects)
    for index in objects:
        section_of = eds[f"{index:04X}"]
        subs = sum(re.fullmatch(f"{index:04X}sub[0-9A-F]+", other) is not None for other in eds)
        assert int(section_of.get("SubNumber", "0")) == subs


@pytest.mark.long
def test_the_drive_hands_out_its_own_eds(drive_bench: Make) -> None:
    """1021, by canopen's client in segments and in blocks: the same text as `eds_text`."""
    bench = drive_bench()
    text = eds_text(named_profile("generic")).encode("ascii")
    assert len(text) > 20_000
    assert bench.remote.sdo.upload(0x1021, 0) == text
    with bench.remote.sdo[0x1021].open("rb", block_transfer=True) as stream:
        assert stream.read() == text


@pytest.mark.long
def test_block_transfers_of_canopen_are_read_off_the_bus(drive_bench: Make) -> None:
    """A client that is not ours: what `axisrig bus` puts together is what it got and gave."""
    bench = drive_bench()
    seen: list[Frame] = []
    bench.segment.observe(lambda _time_ns, _name, frame, _is_error: seen.append(frame))
    with bench.remote.sdo[0x1021].open("rb", block_transfer=True) as stream:
        text = stream.read()
    with bench.remote.sdo[0x1017].open("wb", size=2, block_transfer=True) as stream:
        stream.write(b"\x10\x27")
    bench.scheduler.run_until(bench.scheduler.now_ns + MS)
    transfers, values = Transfers(), []
    for frame in seen:
        found, value = transfers.take("can1", frame.data, dissect(frame))
        assert "abort_code" not in found.fields
        values += [] if value is None else [value]
    assert values == [Value(0x1021, 0, text), Value(0x1017, 0, b"\x10\x27")]


def test_canopen_writes_by_block_transfer(drive_bench: Make) -> None:
    bench = drive_bench()
    with bench.remote.sdo[0x1017].open("wb", size=2, block_transfer=True) as stream:
        stream.write((750).to_bytes(2, "little"))
    assert bench.remote.sdo[0x1017].raw == 750


def test_a_block_takes_its_time_on_a_slow_bus(fake_axis: Any) -> None:
    """127 segments at 10 kbit/s take longer than the 1 s that a client may be silent."""
    scheduler = new_scheduler()
    with Segment("slow", 10_000, scheduler) as segment:
        network = SimNetwork(segment.port("drive")).connect()
        DriveNode("Z", 3, network, scheduler, fake_axis())
        heard: list[bytes] = []
        port = segment.port("client")
        port.attach_data(
            lambda can_id, data, _time: heard.append(data) if can_id == 0x583 else None
        )
        for request, wait_ms in (("a42110007f000000", 100), ("a300000000000000", 2300)):
            port.send_raw(0x603, bytes.fromhex(request))
            scheduler.run_until(scheduler.now_ns + wait_ms * MS)
        assert [data[0] for data in heard[1:]] == list(range(1, 128))


@pytest.mark.long
def test_segments_of_a_block_let_the_pdos_pass(drive_bench: Make) -> None:
    """While the EDS goes out in blocks, every SYNC is answered, at most two segments late.

    Worst cases in bits: SYNC 55, two segments of 135, TPDO1 135, TPDO2 95; 1 bit = 1 us.
    """
    bench = drive_bench()
    bench.operational()
    bench.master.sync.start(0.001)
    begin_ns = bench.scheduler.now_ns
    with bench.remote.sdo[0x1021].open("rb", block_transfer=True) as stream:
        stream.read()
    bench.master.sync.stop()
    syncs = (bench.scheduler.now_ns - begin_ns) // 1_000_000 + 1
    bench.run_to_ms(bench.scheduler.now_ns / 1e6 + 2)
    for can_id in (0x183, 0x283):
        late_ns = [t - begin_ns - n * 1_000_000 for n, t in enumerate(bench.times_ns(can_id))]
        assert len(late_ns) == syncs
        assert min(late_ns) > 0
        assert max(late_ns) < (55 + 2 * 135 + 135 + 95) * 1000
