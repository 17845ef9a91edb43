"""`axisrig fmu check`: functions and version of a library, and states that come back as bytes."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts
from tests.fmu_tools.trials import CAN

from axisrig.bench.tools.fmu import stages
from axisrig.bench.tools.fmu.findings import Finding

FMU = Path("a.fmu")


class Library:
    """The functions of a library, with these left out."""

    def __init__(self, prefix: str, *without: str) -> None:
        self._prefix, self._without = prefix, without

    def __getattr__(self, name: str) -> Any:
        if not name.startswith(self._prefix) or name in self._without:
            raise AttributeError(name)
        return name


STATE2 = ("GetFMUstate", "SetFMUstate", "FreeFMUstate")
BYTES2 = ("SerializedFMUstateSize", "SerializeFMUstate", "DeSerializeFMUstate")
STATE3 = ("GetFMUState", "SetFMUState", "FreeFMUState")
BYTES3 = ("SerializedFMUStateSize", "SerializeFMUState", "DeserializeFMUState")


def loaded(
    fake: Any, prefix: str, *without: str, says: bytes, declared: str, **can: bool
) -> dict[str, list[str]]:
    """What loading such a library finds, by level."""
    library = Library(prefix, *(prefix + name for name in without))
    fmpy = SimpleNamespace(
        dll=SimpleNamespace(_dll=library), fmi2GetVersion=lambda: says if prefix == "fmi2" else b"",
        fmi3GetVersion=lambda: says if prefix == "fmi3" else b"",
    )  # fmt: skip

    def prepare(one: Any) -> None:
        one.slave.fmpy, one.slave.PREFIX = fmpy, prefix
        one.slave.STATE_WORD = "FMUstate" if prefix == "fmi2" else "FMUState"
        one.slave.description = SimpleNamespace(fmiVersion=declared)

    can = {"can_save_state": False, **can}
    fake(can=SimpleNamespace(**{**CAN, **can}), prepare=staticmethod(prepare))
    found = stages.load(FMU).findings
    return {name: texts(found, name) for name in ("ok", "FAIL")}


@pytest.mark.parametrize(
    ("prefix", "version", "state", "as_bytes"),
    [("fmi2", "2.0", STATE2, BYTES2), ("fmi3", "3.0.1", STATE3, BYTES3)],
)
def test_a_library_has_the_functions_of_what_its_description_promises(
    fake: Any, prefix: str, version: str, state: tuple[str, ...], as_bytes: tuple[str, ...]
) -> None:
    """Names of FMI 2.0.4 (2.1.8, 4.2) and 3.0 (2.2.6, 4.2); saved states only where they are."""
    good = {"ok": [f"loads, has every function needed, version {version}"], "FAIL": []}
    says = {"says": version.encode(), "declared": version}
    assert loaded(fake, prefix, *state, *as_bytes, **says) == good
    for name in state:
        assert loaded(fake, prefix, name, can_save_state=True, **says)["FAIL"] == [
            f"functions are missing: {prefix}{name}"
        ]
    both = {"can_save_state": True, "can_serialize_state": True}
    assert loaded(fake, prefix, **both, **says) == good
    assert loaded(fake, prefix, *as_bytes, can_save_state=True, **says) == good
    for name in as_bytes:
        assert loaded(fake, prefix, name, **both, **says)["FAIL"] == [
            f"functions are missing: {prefix}{name}"
        ]
    assert loaded(fake, prefix, "DoStep", "Reset", **says) == {
        "ok": [], "FAIL": [f"functions are missing: {prefix}"
                           + (f"Reset, {prefix}DoStep" if prefix == "fmi2" else
                              f"DoStep, {prefix}Reset")],
    }  # fmt: skip


def test_a_library_is_of_the_version_that_its_description_gives(fake: Any) -> None:
    for prefix, says, declared, is_good in (
        ("fmi2", b"2.0", "2.0", True), ("fmi2", b"2.0", "2.0.4", True),
        ("fmi3", b"3.0-beta.2", "3.0", True), ("fmi3", b"3.0", "2.0", False),
        ("fmi2", b"1.0", "2.0", False),
    ):  # fmt: skip
        found = loaded(fake, prefix, says=says, declared=declared)
        assert found["ok"] == [f"loads, has every function needed, version {says.decode()}"]
        assert found["FAIL"] == ([] if is_good else [
            f"the library says version {says.decode()}, the description {declared}"
        ])  # fmt: skip


class Packed:
    """States as bytes of a library."""

    def __init__(self) -> None:
        self.freed: list[int] = []

    def serializeFMUState(self, handle: int) -> bytes:  # noqa: N802 - of fmpy
        assert handle == 1
        return b"state"

    def deserializeFMUState(self, packed: bytes) -> int:  # noqa: N802
        assert packed == b"state"
        return 2

    def setFMUState(self, handle: int) -> None:  # noqa: N802
        assert handle == 2

    def freeFMUState(self, handle: int) -> None:  # noqa: N802
        self.freed.append(handle)


def test_a_state_as_bytes_must_come_back_too(fake: Any) -> None:
    """Range of the output 0 to 75 in what is compared: 25 steps from 25 on."""
    both = SimpleNamespace(**{**CAN, "can_serialize_state": True})

    def state_of(odd: Any) -> tuple[list[Finding], Packed]:
        packed = Packed()

        def prepare(one: Any) -> None:
            one.slave.fmpy = packed

        fake(can=both, odd=staticmethod(odd), prepare=staticmethod(prepare))
        return stages.state(FMU).findings, packed

    good, packed = state_of(lambda *_: 0.0)
    assert texts(good) == [
        "restored, the run is equal bit for bit",
        "state of 5 bytes unpacked, the run is equal bit for bit",
    ]
    assert [one.area for one in good] == ["state", "state as bytes"]
    assert packed.freed == [2]
    # The fourth run from the same state on is that of the bytes
    runs: list[int] = []

    def fourth(_: Any, count: int) -> float:
        runs.append(count)
        return 0.5 if runs.count(26) == 4 and count == 30 else 0.0

    bad, _ = state_of(fourth)
    assert [(one.area, one.level) for one in bad] == [("state", "ok"), ("state as bytes", "FAIL")]
    assert "x at t = 30 ms is 30.0 and 30.5" in bad[1].text


@pytest.mark.parametrize(("off", "level_of_it"), [(45e-9, "warn"), (55e-9, "FAIL")])
def test_a_state_that_is_off_by_less_than_an_increment_is_a_warning(
    fake: Any, off: float, level_of_it: str
) -> None:
    """1e-9 of the largest amount of the output, 50 after 50 steps."""
    fake(odd=staticmethod(lambda one, count: off * (one.restores > 0 and count == 40)))
    (found,) = stages.state(FMU).findings
    assert (found.area, found.level) == ("state", level_of_it)
    assert f"by {off / 50:.1e} of the range" in found.text
