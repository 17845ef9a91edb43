"""Assignments of a plan row or of --set: what each kind changes and what each mistake says."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, read_settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]


def _refused(settings_of: Read, path: Path, text: str) -> UserError:
    with pytest.raises(UserError) as caught:
        settings_of(path, text)
    error = caught.value
    assert text in error.message, "the error names the place where the value was written"
    return error


# What they change


def test_plc_says_how_stops_go_on(rig_file: Write, settings_of: Read) -> None:
    plain = settings_of(rig_file()).operator
    assert (plain.start_after_ns, plain.optional_stop) == (None, False)
    settings = settings_of(rig_file(), "plc:start_ms=0.5", "plc:optional_stop=1")
    assert (settings.operator.start_after_ns, settings.operator.optional_stop) == (500_000, True)
    assert plain.limit_ns == 600 * 10**9
    limited = settings_of(rig_file(), "plc:limit_s=2.5").operator
    assert limited.limit_ns == 2_500_000_000
    assert plain.after_end_ns == 0
    assert settings_of(rig_file(), "plc:after_end_ms=0.5").operator.after_end_ns == 500_000


def test_set_changes_axis_and_channel(rig_file: Write, settings_of: Read) -> None:
    settings = settings_of(
        rig_file(),
        "set:Z.kenngr.measure.edge=NEG",
        "set:Z.kenngr.probing_offset=20000",
        "set:channel.meas_error_no_signal=1",
    )
    assert settings.axis["Z"].word("kenngr.measure.edge") == "NEG"
    assert settings.axis["Z"].mm("kenngr.probing_offset") == 2.0  # 20000 * 0.1 um
    assert settings.channel.flag("meas_error_no_signal") is True


def test_set_changes_zero_offsets_and_tools(rig_file: Write, settings_of: Read) -> None:
    """Lists of the rig first, then the assignments."""
    path = rig_file(("[channel]", '[channel]\ntools = "lists/tools.lst"'))
    (path.parent / "lists" / "tools.lst").write_text("wz[1].radius 20000\nwz[1].gueltig 1\n")
    tables = settings_of(
        path, "set:tools.wz[1].radius=30000", "set:zero_offsets.np_grp[1].achse[0].versch=-5"
    ).offset_tables
    tool = tables.tools.find(1)
    assert tool is not None
    assert tool.radius_mm == 3.0
    assert tables.zero_offsets.shift_mm(1, 0) == -0.0005
    assert tables.ball_radius_counts


@pytest.mark.parametrize("whose", ["channel", "axis-z"])
@pytest.mark.parametrize("given", ["lists/none.lst", "lists"])
def test_a_parameter_list_that_is_no_file_is_refused_at_its_key(
    whose: str, given: str, rig_file: Write, settings_of: Read
) -> None:
    """A folder is none either."""
    path = rig_file((f'list = "lists/{whose}.lst"', f'list = "{given}" # here'))
    with pytest.raises(UserError, match=r"the parameter list \S+ is no file") as caught:
        settings_of(path)
    assert "# here" in path.read_text(encoding="utf-8").splitlines()[(caught.value.line or 0) - 1]


def test_a_list_that_is_missing_or_wrong_is_told_with_its_place(
    rig_file: Write, settings_of: Read
) -> None:
    path = rig_file(("[channel]", '[channel]\nzero_offsets = "lists/zero.lst"'))
    with pytest.raises(UserError, match=r"zero offsets zero\.lst is no file") as caught:
        settings_of(path)
    assert caught.value.file == str(path)
    wrong = path.parent / "lists" / "zero.lst"
    wrong.write_text("# first\nnp_grp[1].achse[0].versch fast\n")
    with pytest.raises(UserError, match="takes a value of type SGN32") as caught:
        settings_of(path)
    assert (caught.value.file, caught.value.line) == (str(wrong), 2)


def test_the_last_assignment_wins(rig_file: Write, settings_of: Read) -> None:
    settings = settings_of(rig_file(), "bus:can1.bitrate=500000", "bus:can1.bitrate=800000")
    assert settings.segment["can1"].bitrate == 800_000


def test_bus_changes_the_run_and_not_the_rig(rig_file: Write, settings_of: Read) -> None:
    settings = settings_of(rig_file(), "bus:can1.bitrate=500000")
    assert settings.segment["can1"].bitrate == 500_000
    assert settings.rig.segment["can1"].bitrate == 1_000_000


def test_plant_values_are_kept_in_their_order_for_the_fmu(
    rig_file: Write, settings_of: Read
) -> None:
    settings = settings_of(
        rig_file(), "plant:probe.surface_mm=100.5", "plant:probe.trigger_delay_us=20"
    )
    kept = [(item.name, item.si()) for item, _ in settings.start["probe"]]
    assert kept == [("surface", 0.1005), ("trigger_delay", 2e-5)]


def test_plc_gives_external_variables(rig_file: Write, settings_of: Read) -> None:
    settings = settings_of(rig_file(), "plc:V.E.FEED=1200", "plc:V.E.SIDE=-1")
    assert settings.external == {"FEED": 1200.0, "SIDE": -1.0}


def test_fault_drop_takes_several_telegrams(rig_file: Write, settings_of: Read) -> None:
    settings = settings_of(rig_file(), "fault:drop=Z.TPDO2 Z.RPDO1")
    assert [fault.target for fault in settings.faults] == ["Z.TPDO2", "Z.RPDO1"]


# What they refuse


@pytest.mark.parametrize(
    ("text", "value", "found"),
    [
        ("set:Q.kenngr.measure.edge=NEG", "Q", "channel, Z"),
        ("set:Z.kenngr.measure.edges=NEG", "kenngr.measure.edges", "kenngr.measure.edge"),
        ("set:Z.kenngr.measure.edge=LEFT", "LEFT", "POS, NEG"),
        ("set:Z.kenngr.measure.input=3", "3", "1 .. 2"),
        ("set:Z.kenngr.messachse=yes", "yes", "0 .. 1"),
        ("set:channel.messtyp=8", "8", "1 .. 7"),
        ("set:Z.kenngr.measure.signal=SPS", "SPS", "PLC_TIMESTAMP"),
        ("plc:period_us=1000", "period_us", "the rig has no PLC task"),
        ("set:Z.messtyp=1", "messtyp", "parameter of the channel"),
        ("set:tools.wz[1].length=1", "wz[1].length", "wz[i].laenge"),
        ("set:tools.wz[201].radius=1", "wz[201].radius", "0 .. 200"),
        ("set:zero_offsets.default_index=97", "97", "0 .. 96"),
        ("plant:q.surface_mm=1", "q", "z, probe"),
        ("bus:can7.bitrate=500000", "can7", "can1"),
        ("bus:can1.bitrates=500000", "bitrates", "bitrate"),
        ("bus:can1.bitrate=300000", "300000", "bitrate"),
        ("bus:can1.bitrate=fast", "fast", "bitrate"),
        ("bus:can1.interface=socketkan", "socketkan", "socketcan"),
        ("bus:can1.options=tty", "tty", "key=value"),
        ("plc:FEED=3", "FEED", "V.E.<NAME>"),
        ("plc:start_s=1", "start_s", "start_ms"),
        ("plc:start_ms=soon", "soon", "not a number"),
        ("plc:start_ms=-1", "-1", "0 .. 1e9 ms"),
        ("plc:optional_stop=yes", "yes", "0, 1"),
        ("plc:limit_s=0", "0", "0.001 .. 1e7 s"),
        ("plc:after_end_ms=-1", "-1", "0 .. 1e7 ms"),
        ("plc:V.E.FEED=fast", "fast", "not a number"),
        ("fault:dealy=Z.TPDO1", "dealy", "delay"),
        ("fault:drop=Z.TPDO5", "Z.TPDO5", "Z.TPDO1, Z.TPDO2, Z.TPDO3, Z.TPDO4, Z.RPDO1"),
        ("fault:drop=Z.TPDO1 X.TPDO1", "X.TPDO1", "Z.TPDO1"),
    ],
)
def test_each_wrong_assignment_names_itself_and_what_is_allowed(
    rig_file: Write, settings_of: Read, text: str, value: str | None, found: str
) -> None:
    error = _refused(settings_of, rig_file(), text)
    assert error.value == value
    assert found in str(error)


@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
def test_an_external_variable_is_a_finite_number(
    rig_file: Write, settings_of: Read, number: str
) -> None:
    _refused(settings_of, rig_file(), f"plc:V.E.FEED={number}")


def test_whoever_wrote_the_value_is_asked_for_the_place(rig_file: Write) -> None:
    """A plan hands over its own function, which knows the cell."""
    asked: list[tuple[str, str]] = []

    def cell(error: UserError, assignment: Assignment) -> UserError:
        asked.append((error.message, assignment.column))
        return UserError(error.message, file="plan.csv", line=7, column=4)

    rig, files = read_rig(rig_file())
    good = parse_assignment("set:Z.kenngr.measure.edge=NEG")
    bad = parse_assignment("bus:can7.bitrate=500000")
    with pytest.raises(UserError, match=r"^plan\.csv:7:4: the rig has no such segment"):
        read_settings(rig, files, [(good, cell), (bad, cell)])
    assert asked == [("the rig has no such segment", "bus:can7.bitrate")]


def test_a_list_that_is_not_there_is_named(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("lists/axis-z.lst", "lists/axis-w.lst"))
    with pytest.raises(UserError) as caught:
        settings_of(path)
    assert (caught.value.file, caught.value.line is None) == (str(path.resolve()), False)
