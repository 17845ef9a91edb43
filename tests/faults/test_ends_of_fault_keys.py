"""Each key of a fault from its first value to its last, in every kind that has it."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.rig.reading.fault_targets import axes_of, is_target, place_of, targets
from axisrig.bench.rig.reading.faults import (
    Fault,
    FaultKey,
    Moment,
    fault_keys,
    fault_kinds,
    fault_moments,
    faults_table,
    read_faults,
)
from axisrig.bench.rig.reading.file import RigFile, read_rig
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
TARGETS = {"telegram": "Z.TPDO1", "axis": "Z", "bus": "can1", "signal": "probe"}
# A step below or above the last value, by the type of the key
STEPS = {"number": 1, "time": 0.5, "share": 1e-9, "real": 1.0}


@pytest.fixture(scope="module")
def rig() -> RigFile:
    return read_rig(RIGS / "probe-xyz.toml")[0]


def _use(key: str) -> tuple[str, str]:
    """A kind with the key that this rig has a place for, and that place."""
    for kind in fault_kinds().values():
        places = [TARGETS[word] for word in kind.targets if word in TARGETS]
        if key in kind.keys and places:
            return kind.name, places[0]
    return "", ""


USED = [key for key in fault_keys().values() if _use(key.name)[0]]
IN_RANGE = [key for key in USED if " to " in key.allowed and key.type != "data"]


def _read(rig: RigFile, key: FaultKey, text: str) -> Any:
    kind, place = _use(key.name)
    (fault,) = read_faults(kind, f"{place} {key.name}={text}", rig)
    return fault.values[key.name]


def _number(key: FaultKey, text: str) -> float:
    """A value of the column `allowed`; times in us."""
    if key.type == "time":
        number, unit = (text[:-2], text[-2:]) if text[-2:] in ("us", "ms") else (text[:-1], "s")
        return float(number) * {"us": 1.0, "ms": 1e3, "s": 1e6}[unit]
    return float(int(text, 0)) if key.type == "number" else float(text)


def _text(key: FaultKey, value: float) -> str:
    if key.type == "time":
        return f"{value:.1f}us"
    return str(int(value)) if key.type == "number" else f"{value:.12g}"


@pytest.mark.parametrize("key", IN_RANGE, ids=lambda key: key.name)
def test_a_key_takes_its_first_and_its_last_value_and_none_beyond(
    rig: RigFile, key: FaultKey
) -> None:
    low, high = (_number(key, text) for text in key.allowed.split(" to "))
    assert low < high
    scale = 1000.0 if key.type == "time" else 1.0
    for value in (low, high, (low + high) // 2 or high):
        if value or key.name not in fault_kinds()[_use(key.name)[0]].defaults:
            assert _read(rig, key, _text(key, value)) == pytest.approx(value * scale, rel=1e-12)
    step = STEPS[key.type]
    for value in (low - step, high + step):
        with pytest.raises(UserError, match=f"^{key.name}: ") as caught:
            _read(rig, key, _text(key, value))
        assert (caught.value.value, caught.value.allowed) == (_text(key, value), key.allowed)


WORDS = [key for key in fault_keys().values() if key.type == "word"]


@pytest.mark.parametrize("key", WORDS, ids=lambda key: key.name)
def test_a_key_of_words_has_one_of_them_by_default(key: FaultKey) -> None:
    assert key.default in key.allowed.split()


def test_a_command_is_one_of_its_words(rig: RigFile) -> None:
    key = fault_keys()["command"]
    for word in key.allowed.split():
        assert _read(rig, key, word) == word
    for word in ("RESET", "res", "reset_stop", ""):
        with pytest.raises(UserError, match="command: unknown word") as caught:
            _read(rig, key, word)
        assert (caught.value.value, caught.value.allowed) == (word, key.allowed)


@pytest.mark.parametrize("moment", list(fault_moments()))
@pytest.mark.parametrize(("more", "offset_ns"), [("", 0), ("+1us", 1000), ("+2.5ms", 2_500_000)])
def test_a_fault_begins_at_every_moment_and_a_time_after_it(
    rig: RigFile, moment: str, more: str, offset_ns: int
) -> None:
    assert _read(rig, fault_keys()["at"], f"{moment}{more}") == Moment(moment, offset_ns)


@pytest.mark.parametrize("text", ["motion+", "motion-1ms", "+1ms", "motion+1ms+1ms", "Motion", ""])
def test_what_is_no_moment_is_refused_with_all_moments(rig: RigFile, text: str) -> None:
    with pytest.raises(UserError, match="at: no moment of a run") as caught:
        _read(rig, fault_keys()["at"], text)
    assert caught.value.value == text
    allowed = str(caught.value.allowed)
    assert all(f", {name}" in allowed for name in fault_moments())
    assert allowed.endswith("motion+2ms")


@pytest.mark.parametrize("kind", list(fault_kinds()))
def test_a_kind_takes_its_own_keys_only(rig: RigFile, kind: str) -> None:
    """A key of others is refused before its value is read."""
    known = fault_kinds()[kind]
    for name in set(fault_keys()) - set(known.keys):
        with pytest.raises(UserError, match=f"kind {kind} has no such key") as caught:
            read_faults(kind, f"nowhere {name}=x", rig)
        assert caught.value.value == name
        assert str(caught.value.allowed) == ", ".join(known.keys)


DEFAULTS = [(k.name, key, text) for k in fault_kinds().values() for key, text in k.defaults.items()]


@pytest.mark.parametrize(("kind", "key", "text"), DEFAULTS)
def test_a_kind_that_would_do_nothing_has_a_value_of_its_own(
    rig: RigFile, kind: str, key: str, text: str
) -> None:
    """Its default is good; 0 is refused, with that default where 0 is in the range of the key."""
    table = fault_keys()[key]
    none = {"time": "0us", "share": "0", "real": "0", "number": "0"}[table.type]
    with pytest.raises(UserError) as caught:
        read_faults(kind, f"nowhere {key}={none}", rig)
    assert caught.value.value == none
    if _number(table, table.allowed.split(" to ")[0]) <= 0:
        assert caught.value.allowed == f"more than 0; {text} without it"
        assert caught.value.message == f"{key}: a fault of kind {kind} does nothing like this"
    else:
        assert caught.value.allowed == table.allowed
    with pytest.raises(UserError, match="no such place"):  # the value is good
        read_faults(kind, f"nowhere {key}={text}", rig)


@pytest.mark.parametrize("text", ["", ";", "Z.TPDO1;;X.TPDO1", " ; Z.TPDO1", "Z.TPDO1 ; "])
def test_between_semicolons_there_is_a_fault(rig: RigFile, text: str) -> None:
    with pytest.raises(UserError, match="missing between the semicolons") as caught:
        read_faults("drop", text, rig)
    assert caught.value.value == text


@pytest.mark.parametrize("text", ["p=0.5", "Z.TPDO1; p=0.5 count=2"])
def test_a_fault_without_a_target_names_those_there_are(rig: RigFile, text: str) -> None:
    with pytest.raises(UserError, match="a fault has no target") as caught:
        read_faults("drop", text, rig)
    assert caught.value.value == text.rpartition(";")[2]
    assert str(caught.value.allowed).startswith("X.TPDO1, X.TPDO2")


def test_of_several_targets_each_is_looked_at(rig: RigFile) -> None:
    for text in ("Z.TPDO9 Z.TPDO1", "Z.TPDO1 Z.TPDO9", "Z.TPDO1; X.TPDO1 Z.TPDO9 p=0.5"):
        with pytest.raises(UserError, match="no such telegram") as caught:
            read_faults("drop", text, rig)
        assert caught.value.value == "Z.TPDO9"
        assert {name.partition(".")[0] for name in str(caught.value.allowed).split(", ")} == {"Z"}
    with pytest.raises(UserError) as caught:
        read_faults("drop", "can1.TPDO1", rig)
    assert caught.value.allowed == "can1.SYNC, can1.NMT"


@pytest.mark.parametrize(("kind", "what"), [("sensor_drift", "sensor"), ("line_lost", "line")])
def test_a_kind_without_a_place_in_the_rig_says_what_is_missing(
    rig: RigFile, kind: str, what: str
) -> None:
    with pytest.raises(UserError) as caught:
        read_faults(kind, "Z", rig)
    assert caught.value.message.endswith(f": the rig has no {what}")
    assert caught.value.hint == f"axisrig faults {kind}"


def test_a_key_is_given_once_for_each_fault(rig: RigFile) -> None:
    assert len(read_faults("drop", "Z.TPDO1 p=0.1; Z.TPDO2 p=0.1", rig)) == 2
    with pytest.raises(UserError, match="the key p is given twice") as caught:
        read_faults("drop", "Z.TPDO1 p=0.1 count=2 p=0.1", rig)
    assert caught.value.value == "p=0.1"


@pytest.mark.parametrize("text", ["0", "00112233445566778", "0x11", "gg", "lastrandom", "LAST"])
def test_data_of_a_frame_are_whole_octets(rig: RigFile, text: str) -> None:
    with pytest.raises(UserError, match="data: no data of a frame") as caught:
        _read(rig, fault_keys()["data"], text)
    assert caught.value.value == text


@pytest.mark.parametrize(
    ("text", "data"),
    [("last", "last"), ("random", "random"), ("00", b"\0"), ("0A", b"\n"), ("0a", b"\n"),
     ("0011223344556677", bytes(0x11 * n for n in range(8)))],
)  # fmt: skip
def test_data_of_a_frame_are_a_word_or_up_to_eight_octets(
    rig: RigFile, text: str, data: str | bytes
) -> None:
    assert _read(rig, fault_keys()["data"], text) == data


@pytest.mark.parametrize("text", ["１", "1_0", "+-1", "1e", "0b2", "--"])
@pytest.mark.parametrize("name", ["count", "p"])
def test_a_number_is_written_as_engineers_do(rig: RigFile, name: str, text: str) -> None:
    with pytest.raises(UserError, match=f"{name}: not a"):
        _read(rig, fault_keys()[name], text)


# --- places ------------------------------------------------------------------------------------


def test_a_fault_of_a_place_begins_with_the_moments_of_its_axes(rig: RigFile) -> None:
    """Of an axis with its own, of a bus with those on it, of a sensor with those that read it."""
    for target, words, axes in (
        ("Z.TPDO1", ("telegram",), ("Z",)),
        ("Y", ("axis",), ("Y",)),
        ("can2", ("bus",), ("Y",)),
        ("can3.SYNC", ("telegram",), ("Z",)),
        ("probe", ("signal",), ("X", "Y", "Z")),
        ("x.kv", ("input",), ("X",)),
        ("probe.level", ("input",), ("X", "Y", "Z")),
        ("plc", ("plc",), ("X", "Y", "Z")),  # of nobody: all of them
    ):
        assert axes_of(target, words, rig) == axes, target


def test_a_sensor_of_one_axis_has_the_moments_of_that_axis(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    own = '[plant.other]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { z = "z" }\n'
    own += '[axis.Z]\nprobe_1 = "other"\nprobe_2 = "other"\n'
    path.write_text(f'base = "{(RIGS / "probe-xyz.toml").as_posix()}"\n{own}', encoding="utf-8")
    found = read_rig(path)[0]
    assert axes_of("other", ("signal",), found) == ("Z",)
    assert axes_of("probe", ("signal",), found) == ("X", "Y")


def test_a_place_is_an_axis_or_a_bus_for_kinds_of_axes_and_buses_only(rig: RigFile) -> None:
    for target, words, place in (
        ("Z.TPDO1", ("telegram",), ("Z", "", "TPDO1")),
        ("Z", ("bus", "axis"), ("Z", "", "")),
        ("can1", ("bus", "axis"), ("", "can1", "")),
        ("Z.kv", ("input",), ("", "", "")),  # a plant may be named as an axis is
        ("Z", ("sensor",), ("", "", "")),
        ("can1", ("signal",), ("", "", "")),
    ):
        assert place_of(target, words, rig) == place


def test_an_input_is_one_of_a_plant_that_is_there(rig: RigFile) -> None:
    for name, found in (("x.kv", True), ("x.", False), ("x", False), ("q.kv", False)):
        assert is_target(name, ("input",), rig) is found, name
        assert not is_target(name, ("signal",), rig)
    assert targets(("input",), rig) == [f"{plant}.INPUT" for plant in rig.plant]


@pytest.mark.parametrize("kind", ["dropp", "sync_los", "zzzz"])
def test_an_unknown_kind_is_refused_with_the_nearest_or_all(rig: RigFile, kind: str) -> None:
    for ask in (lambda: read_faults(kind, "Z.TPDO1", rig), lambda: faults_table(kind)):
        with pytest.raises(UserError, match="unknown kind of fault") as caught:
            ask()
        assert caught.value.value == kind
        found = str(caught.value.allowed).split(", ")
        if kind == "zzzz":
            assert set(found) == set(fault_kinds())
        else:
            assert found[0] == {"dropp": "drop", "sync_los": "sync_loss"}[kind]


def test_a_fault_has_every_key_of_its_kind_and_none_where_it_has_no_value(rig: RigFile) -> None:
    for kind, place in (("corrupt", "Z.TPDO1"), ("babble", "can1"), ("probe_chatter", "probe")):
        (fault,) = read_faults(kind, place, rig)
        assert isinstance(fault, Fault)
        assert list(fault.values) == list(fault_kinds()[kind].keys)
        for name, value in fault.values.items():
            has_none = not fault_keys()[name].default and name not in fault_kinds()[kind].defaults
            assert (value is None) is has_none, name
