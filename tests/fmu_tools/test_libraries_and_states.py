"""Functions that a library has to have, and states that come back: stand-ins, no FMU.

Names of functions: FMI 2.0.4 and FMI 3.0.1, each chapter "FMI for co-simulation".
"""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts
from tests.fmu_tools.trials import CAN, Slave

from axisrig.bench.tools.fmu import stages
from axisrig.kernel.time.clock import MS

FMU = Path("a.fmu")
EVERY = "GetVersion FreeInstance DoStep Reset Terminate EnterInitializationMode"
FMI2 = f"{EVERY} ExitInitializationMode GetTypesPlatform Instantiate SetupExperiment".split()
FMI2 += [f"{way}{kind}" for way in ("Get", "Set") for kind in ("Real", "Integer", "Boolean")]
FMI3 = f"{EVERY} ExitInitializationMode InstantiateCoSimulation GetFloat64 SetFloat64".split()
STATE = {
    "fmi2": "GetFMUstate SetFMUstate FreeFMUstate",
    "fmi3": "GetFMUState SetFMUState FreeFMUState",
}
BYTES = {
    "fmi2": "SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate",
    "fmi3": "SerializedFMUStateSize SerializeFMUState DeserializeFMUState",
}


def library(fake: Any, prefix: str, functions: list[str], version: bytes, **can: bool) -> None:
    """An FMU whose description has version 2.0 or 3.0, with these functions and its own version."""

    def prepare(trial: Any) -> None:
        own = {f"{prefix}{name}": None for name in functions}
        trial.slave.PREFIX = prefix
        trial.slave.STATE_WORD = "FMUstate" if prefix == "fmi2" else "FMUState"
        trial.slave.description = SimpleNamespace(fmiVersion=f"{prefix[-1]}.0")
        trial.slave.fmpy = SimpleNamespace(
            dll=SimpleNamespace(_dll=SimpleNamespace(**own)),
            **{f"{prefix}GetVersion": lambda: version},
        )

    fake(can=SimpleNamespace(**{**CAN, **can}), prepare=staticmethod(prepare))


@pytest.mark.parametrize(("prefix", "plain"), [("fmi2", FMI2), ("fmi3", FMI3)])
def test_a_library_has_every_function_that_it_promises(
    prefix: str, plain: list[str], fake: Any
) -> None:
    """Those of a state only where it can be saved, those of bytes where it can be written."""
    version = f"{prefix[-1]}.0".encode()
    state, packed = STATE[prefix].split(), BYTES[prefix].split()
    for saves, packs, needed in (
        (False, False, plain), (True, False, plain + state), (True, True, plain + state + packed)
    ):  # fmt: skip
        can = {"can_save_state": saves, "can_serialize_state": packs}
        library(fake, prefix, needed, version, **can)
        assert texts(stages.load(FMU).findings) == [
            f"loads, has every function needed, version {version.decode()}"
        ]
        for place, name in enumerate(needed):
            library(fake, prefix, [*needed[:place], *needed[place + 1 :]], version, **can)
            assert texts(stages.load(FMU).findings, "FAIL") == [
                f"functions are missing: {prefix}{name}"
            ], name
    library(fake, prefix, plain[2:], b"9.0", can_save_state=False)
    (found,) = stages.load(FMU).findings  # whose version is asked for only where all is there
    assert found.text.count(prefix) == 2


@pytest.mark.parametrize(
    ("prefix", "version", "is_right"),
    [
        ("fmi2", "2.0", True), ("fmi2", "2.0.4", True), ("fmi2", "3.0", False),
        ("fmi2", "1.0", False), ("fmi3", "3.0-beta.2", True), ("fmi3", "2.0", False),
    ],
)  # fmt: skip
def test_a_library_has_the_version_of_its_description(
    prefix: str, version: str, is_right: bool, fake: Any
) -> None:
    """The first number counts."""
    plain = FMI2 if prefix == "fmi2" else FMI3
    library(fake, prefix, plain + STATE[prefix].split(), version.encode())
    found = stages.load(FMU).findings
    other = f"the library says version {version}, the description {prefix[-1]}.0"
    assert texts(found, "FAIL") == ([] if is_right else [other])
    assert texts(found, "ok") == [f"loads, has every function needed, version {version}"]


def packing(trial: Any) -> None:
    """Keeps what is done with bytes; the state of bytes is that of the handle they are made of."""
    calls: list[Any] = []

    def put_back(handle: Any) -> None:
        calls.append(("set", handle))

    trial.slave.fmpy = SimpleNamespace(
        serializeFMUState=lambda handle: calls.append(("pack", handle)) or bytes(12),
        deserializeFMUState=lambda packed: calls.append(("unpack", len(packed))) or "new handle",
        setFMUState=put_back,
        freeFMUState=lambda handle: calls.append(("free", handle)),
    )
    trial.slave.calls = calls
    type(trial).last = trial


BYTES_CAN = SimpleNamespace(**{**CAN, "can_serialize_state": True})


def test_a_state_comes_back_through_bytes_at_its_own_time(fake: Any) -> None:
    """After two ways back; a quarter of 100 steps until it is saved, as many after it."""
    made = fake(can=BYTES_CAN, prepare=staticmethod(packing))
    found = stages.state(FMU).findings
    assert texts(found) == [
        "restored, the run is equal bit for bit",
        "state of 12 bytes unpacked, the run is equal bit for bit",
    ]
    assert [one.area for one in found] == ["state", "state as bytes"]
    trial = made.last
    assert trial.slave.calls == [
        ("pack", 1), ("unpack", 12), ("set", "new handle"), ("free", "new handle"),
    ]  # fmt: skip
    assert (trial.count, trial.slave.time_ns, trial.restores) == (50, 50 * MS, 2)


def test_bytes_that_give_another_state_fail_and_are_not_tried_where_it_does_not_come_back(
    fake: Any,
) -> None:
    def odd(trial: Any, count: int) -> float:
        return 0.5 * (bool(trial.slave.calls) and count == 30)

    fake(can=BYTES_CAN, prepare=staticmethod(packing), odd=staticmethod(odd))
    good, bad = stages.state(FMU).findings
    assert (good.level, bad.level, bad.area) == ("ok", "FAIL", "state as bytes")
    assert "x at t = 30 ms" in bad.text
    made = fake(
        can=BYTES_CAN, prepare=staticmethod(packing),
        odd=staticmethod(lambda trial, count: 0.5 * (trial.restores > 0 and count > 25)),
    )  # fmt: skip
    (found,) = stages.state(FMU).findings  # both times the same
    assert (found.level, found.area) == ("FAIL", "state")
    assert made.last.slave.calls == []


def test_what_is_saved_is_the_state_of_a_quarter_of_the_steps(fake: Any) -> None:
    saved: list[int] = []

    def prepare(trial: Any) -> None:
        def save() -> Slave:
            saved.append(trial.count)
            return Slave(handle=1, time_ns=trial.slave.time_ns, count=trial.count)

        trial.slave.save_state = save

    fake(prepare=staticmethod(prepare))
    stages.state(FMU)
    assert saved == [25]


@pytest.mark.parametrize(("off", "level_of_it"), [(45e-9, "warn"), (55e-9, "FAIL")])
def test_a_state_that_is_off_by_less_than_an_increment_is_a_warning(
    fake: Any, off: float, level_of_it: str
) -> None:
    """1e-9 of the largest amount of the output, 50 after 50 steps."""
    fake(odd=staticmethod(lambda one, count: off * (one.restores > 0 and count == 40)))
    (found,) = stages.state(FMU).findings
    assert (found.area, found.level) == ("state", level_of_it)
    assert f"by {off / 50:.1e} of the range" in found.text
