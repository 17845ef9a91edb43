"""An instance whose library is written down here: its errors, its messages, its states, its end."""

import math
from collections import deque
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest

from axisrig.kernel.cosim.fmi.library import EndedError, LogMessage, PlantError
from axisrig.kernel.cosim.fmi.slave import PARTS_MAX, Exchange, FmuSlave
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
FILE = Path("models/press.fmu")


def described(**flags: bool) -> Any:
    names = ("canGetAndSetFMUstate", "canSerializeFMUstate", "mightReturnEarlyFromDoStep",
             "canHandleVariableCommunicationStepSize", "canBeInstantiatedOnlyOncePerProcess",
             "needsExecutionTool")  # fmt: skip
    interface = SimpleNamespace(**{**dict.fromkeys(names, False), **flags}, modelIdentifier="press",
                                fixedInternalStepSize=None)  # fmt: skip
    return SimpleNamespace(
        coSimulation=interface, defaultExperiment=None, modelVariables=[], logCategories=[],
        generationTool=None,
    )  # fmt: skip


class Hand(FmuSlave):
    """Its steps go as `goes` says: status of a step, and how far the FMU comes by itself.

    calls: of functions of the library, with the values that tell them apart.
    """

    PREFIX: ClassVar[str] = "fmi3"
    COUNTS_VALUES: ClassVar[bool] = True
    STATE_WORD: ClassVar[str] = "FMUState"
    TYPES: ClassVar[Any] = {}
    loading: ClassVar[Any] = staticmethod(lambda slave: None)

    def __init__(self, name: str = "z", folder: str = "folder", **flags: bool) -> None:
        self.calls: list[Any] = []
        self.statuses: dict[str, int] = {}
        self.goes: Any = lambda begin_s, step_s: (OK, begin_s + step_s)
        self.ends = False
        self.last_s = math.nan
        self.refuses: Exception | None = None
        super().__init__(FILE, name, described(**flags), folder)

    def _instantiate(self, folder: str) -> None:
        self.loading(self)
        self._fmu = SimpleNamespace(
            component=4711, terminate=lambda: self.calls.append("terminate"),
            fmi3FreeInstance=lambda pointer: self.calls.append(("free", pointer)),
        )  # fmt: skip
        self._step = self._one_step
        self._last_time = SimpleNamespace(value=math.inf)
        self._cut = SimpleNamespace(value=0)

    def _one_step(self, _pointer: int, begin_s: float, step_s: float, is_final: bool) -> int:
        self.calls.append(("step", round(begin_s * 1e9), round(step_s * 1e9), is_final))
        status, self.last_s = self.goes(begin_s, step_s)
        return int(status)

    def _enter_initialization(self, start_s: float) -> None:
        if self.refuses is not None:
            raise self.refuses

    def _progress(self) -> tuple[float, bool]:
        return self.last_s, self.ends

    def function(self, name: str, signature: tuple[Any, ...]) -> Any:
        def call(*_arguments: Any) -> int:
            self.calls.append(name)
            return self.statuses.get(name, OK)

        return call

    def says(self, *texts: str) -> None:
        for text in texts:
            self._log(ERROR, b"logStatusError", text.encode())


STATES = {"canGetAndSetFMUstate": True, "canHandleVariableCommunicationStepSize": True}


@pytest.fixture(autouse=True)
def alone() -> Any:
    """Instances that exist once go with their test."""
    from axisrig.kernel.cosim.fmi import slave  # noqa: PLC0415

    yield
    slave._ALONE.clear()


# Loading


def fails(*texts: str) -> Any:
    def load(slave: Hand) -> None:
        slave.says(*texts)
        raise RuntimeError("no such library")

    return staticmethod(load)


@pytest.mark.parametrize(
    ("texts", "more"), [((), ""), (("no licence", "give up"), "; no licence; give up")]
)
@pytest.mark.parametrize("needs_tool", [False, True])
def test_a_library_that_does_not_load_says_why_and_whether_its_tool_is_missing(
    texts: tuple[str, ...], more: str, needs_tool: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Hand, "loading", fails(*texts))
    with pytest.raises(UserError) as caught:
        Hand(needsExecutionTool=needs_tool)
    error = caught.value
    assert error.message == f"the FMU cannot be loaded: no such library{more}"
    assert error.file == str(FILE)
    tool = "the FMU needs the tool that made it on this machine"
    assert error.hint == (tool if needs_tool else None)


def test_an_fmu_that_exists_once_is_refused_under_another_name_until_it_is_freed() -> None:
    once = {"canBeInstantiatedOnlyOncePerProcess": True}
    first = Hand("first", **once)
    Hand("copy", "another folder", **once).close()
    with pytest.raises(UserError) as caught:
        Hand("second", **once)
    error = caught.value
    assert error.message.endswith("only once in a process and is already plant first")
    assert (error.value, error.file) == ("second", str(FILE))
    first.close()
    Hand("second", **once).close()
    Hand("third", **once)


# Messages


@pytest.mark.parametrize(
    ("status", "category", "message", "kept"),
    [
        (OK, b"logAll", b"fine", None), (WARNING, b"logWarning", b" odd \n", ("logWarning", "odd")),
        (ERROR, None, None, ("", "")), (FATAL, b"a\xff", b"b\xff", ("a\ufffd", "b\ufffd")),
        (DISCARD, b"c", b"two\nlines", ("c", "two lines")),
    ],
)  # fmt: skip
def test_what_an_fmu_says_above_ok_is_kept_with_its_time(
    status: int, category: bytes | None, message: bytes | None, kept: tuple[str, str] | None
) -> None:
    """In one line, without what is around it."""
    slave = Hand()
    slave.time_ns = 3 * MS
    slave._log(status, category, message)
    found = [(one.time_ns, one.status, one.category, one.text) for one in slave.messages]
    if kept is None:
        assert found == []
    else:
        ((time_ns, kept_status, word, text),) = found
        assert (time_ns, kept_status, word) == (3 * MS, status, kept[0])
        assert text == kept[1]


@pytest.mark.parametrize("count", [0, 1, 3, 5])
def test_an_error_has_the_last_three_messages(count: int) -> None:
    slave = Hand()
    slave.says(*(f"message {number}" for number in range(count)))
    slave.goes = lambda begin_s, step_s: (ERROR, begin_s)
    slave.initialize(0)
    with pytest.raises(PlantError) as caught:
        slave.step_to(MS)
    last = [f"message {number}" for number in range(max(0, count - 3), count)]
    assert caught.value.reason == "; ".join(["doStep: error", *last])
    assert (caught.value.instance, caught.value.time_ns) == ("z", 0)


def test_an_initialisation_that_fails_has_its_time_and_the_words_of_the_fmu() -> None:
    slave = Hand()
    slave.refuses = RuntimeError("status error")
    slave.says("no start value")
    with pytest.raises(PlantError) as caught:
        slave.initialize(5 * MS)
    assert (caught.value.reason, caught.value.time_ns) == ("status error; no start value", 5 * MS)
    slave.close()
    assert slave.calls == [("free", 4711)]  # it is not in a state in which it could terminate


# Steps


@pytest.mark.parametrize(
    ("last_s", "time_ns"), [(0.0012, 1_200_000), (0.001, MS), (math.nan, MS), (math.inf, MS)]
)
def test_an_fmu_that_ends_the_simulation_names_when(last_s: float, time_ns: int) -> None:
    """By its own account; where it gives none, the begin of the step."""
    slave = Hand()
    slave.initialize(0)
    slave.step_to(MS)
    slave.ends, slave.goes = True, lambda begin_s, step_s: (DISCARD, last_s)
    slave.says("enough")
    with pytest.raises(EndedError) as caught:
        slave.step_to(2 * MS)
    assert caught.value.time_ns == time_ns
    assert caught.value.reason == "the FMU ended the simulation; enough"


@pytest.mark.parametrize("last_s", [0.0009, 0.0021, 1.0, math.nan, math.inf, -1.0])
def test_a_step_that_is_cut_short_ends_inside_itself(last_s: float) -> None:
    slave = Hand(**STATES)
    slave.initialize(0)
    slave.step_to(MS)
    slave.goes = lambda begin_s, step_s: (DISCARD, last_s)
    with pytest.raises(PlantError, match="the FMU does not say how far it came"):
        slave.step_to(2 * MS)


@pytest.mark.parametrize("last_s", [0.00101, 0.0015, 0.002])
def test_after_a_part_the_next_step_begins_where_the_fmu_is(last_s: float) -> None:
    slave = Hand()
    slave.initialize(0)
    slave.step_to(MS)
    parts = [(DISCARD, last_s)]
    slave.goes = lambda begin_s, step_s: parts.pop() if parts else (OK, begin_s + step_s)
    slave.calls.clear()
    slave.step_to(2 * MS)
    at_ns = round(last_s * 1e9)
    more = [("step", at_ns, 2 * MS - at_ns, True)] if at_ns < 2 * MS else []
    assert slave.calls == [("step", MS, MS, True), *more]
    assert slave.time_ns == 2 * MS


@pytest.mark.parametrize(
    ("parts", "is_good"), [(1, True), (PARTS_MAX, True), (PARTS_MAX + 1, False)]
)
def test_a_thousand_parts_may_lead_to_an_end(parts: int, is_good: bool) -> None:
    """The last of them may be the one that comes there."""
    slave = Hand()
    slave.initialize(0)
    end_ns = parts * US

    def go() -> int:
        count = 0
        for _ in slave.parts_to(end_ns):
            slave.time_ns += US
            count += 1
        return count

    if is_good:
        assert go() == parts
        assert go() == 0
    else:
        words = rf"not at {end_ns / 1e6:.6f} ms after {PARTS_MAX} steps"
        with pytest.raises(PlantError, match=words) as caught:
            go()
        assert caught.value.time_ns == PARTS_MAX * US


# States


def test_steps_after_a_state_was_saved_may_be_taken_back() -> None:
    """The flag of doStep: no state before this point will be set any more (FMI 3.0.2, 4.2.1)."""
    slave = Hand(**STATES)
    slave.initialize(0)
    slave.step_to(MS)
    slave.save_state()
    slave.step_to(2 * MS)
    assert [call[3] for call in slave.calls if call[0] == "step"] == [True, False]


@pytest.mark.parametrize("count", [0, 1, 3])
def test_each_saved_state_is_freed_once_and_one_that_is_filled_again_too(count: int) -> None:
    slave = Hand(**STATES)
    slave.initialize(0)
    states = [slave.save_state() for _ in range(count)]
    for state in states:
        assert slave.save_state(state) is state
    slave.close()
    assert slave.calls.count("fmi3FreeFMUState") == count
    assert slave.calls.count("fmi3GetFMUState") == 2 * count
    assert slave.calls[-2:] == ["terminate", ("free", 4711)]


@pytest.mark.parametrize(
    ("name", "what"),
    [("fmi3GetFMUState", "save the state"), ("fmi3SetFMUState", "restore the state")],
)
@pytest.mark.parametrize(
    ("status", "word"), [(DISCARD, "discard"), (ERROR, "error"), (FATAL, "fatal")]
)
def test_a_state_that_is_refused_is_an_error_of_its_own(
    name: str, what: str, status: int, word: str
) -> None:
    """Then the instance is only freed; after `fatal` not even that."""
    slave = Hand(**STATES)
    slave.initialize(0)
    state = slave.save_state()
    slave.statuses[name] = status
    with pytest.raises(PlantError) as caught:
        slave.restore_state(state) if "Set" in name else slave.save_state(state)
    assert caught.value.reason == f"{what}: {word}"
    slave.calls.clear()
    slave.close()
    assert slave.calls == ([] if status == FATAL else ["fmi3FreeFMUState", ("free", 4711)])


# The end


@pytest.mark.parametrize(
    ("goes", "calls"),
    [
        (None, [("free", 4711)]),  # never initialised
        (OK, ["terminate", ("free", 4711)]), (WARNING, ["terminate", ("free", 4711)]),
        (ERROR, [("free", 4711)]), (FATAL, []),
    ],
)  # fmt: skip
def test_an_instance_is_terminated_where_it_may_be_and_freed_once(
    goes: int | None, calls: list[Any]
) -> None:
    """FMI 3.0.2, 2.3.1: after an error freeing alone is allowed, after a fatal one nothing."""
    slave = Hand()
    if goes is not None:
        slave.initialize(0)
        slave.goes = lambda begin_s, step_s: (goes, begin_s + step_s)
        if goes > WARNING:
            with pytest.raises(PlantError):
                slave.step_to(MS)
        else:
            slave.step_to(MS)
    slave.calls.clear()
    for _ in range(2):
        slave.close()
    assert slave.calls == calls


def test_what_is_freed_names_when_it_was() -> None:
    slave = Hand()
    slave.initialize(0)
    slave.step_to(7 * MS)
    slave.close()
    with pytest.raises(PlantError, match="the instance is freed") as caught:
        Exchange(slave, [])
    assert (caught.value.instance, caught.value.time_ns) == ("z", 7 * MS)


def test_messages_are_kept_a_thousand_at_most() -> None:
    slave = Hand()
    slave.says(*map(str, range(1005)))
    assert isinstance(slave.messages, deque)
    assert [one.text for one in list(slave.messages)[:2]] == ["5", "6"]
    assert len(slave.messages) == 1000
    assert isinstance(slave.messages[0], LogMessage)
