"""The state machine over every (state, controlword) pair, against the standard's table by hand.

The table stands here once more, as the standard prints it: bits 7, 3, 2, 1, 0 of the controlword,
"x" = any. The drive must not look at any other bit, so all 65536 words are tried.
"""

from collections.abc import Callable
from itertools import product
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.states import OPTIONS, StateMachine
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import US

Make = Callable[..., Any]
PATTERNS = {
    "shutdown": "0x110",
    "switch on": "00111",
    "enable operation": "01111",
    "disable voltage": "0xx0x",
    "quick stop": "0x01x",
    "fault reset": "1xxxx",
}
# state: {command: (transition, target)}; disable operation has the bits of switch on
STANDARD = {
    "NOT_READY_TO_SWITCH_ON": {},
    "SWITCH_ON_DISABLED": {"shutdown": (2, "READY_TO_SWITCH_ON")},
    "READY_TO_SWITCH_ON": {
        "switch on": (3, "SWITCHED_ON"),
        "enable operation": (4, "OPERATION_ENABLED"),  # 3 before it: switch on + enable operation
        "disable voltage": (7, "SWITCH_ON_DISABLED"),
        "quick stop": (7, "SWITCH_ON_DISABLED"),
    },
    "SWITCHED_ON": {
        "enable operation": (4, "OPERATION_ENABLED"),
        "shutdown": (6, "READY_TO_SWITCH_ON"),
        "disable voltage": (10, "SWITCH_ON_DISABLED"),
        "quick stop": (10, "SWITCH_ON_DISABLED"),
    },
    "OPERATION_ENABLED": {
        "switch on": (5, "SWITCHED_ON"),
        "shutdown": (8, "READY_TO_SWITCH_ON"),
        "disable voltage": (9, "SWITCH_ON_DISABLED"),
        "quick stop": (11, "QUICK_STOP_ACTIVE"),
    },
    "QUICK_STOP_ACTIVE": {
        "disable voltage": (12, "SWITCH_ON_DISABLED"),
        "enable operation": (16, "OPERATION_ENABLED"),
    },
    "FAULT_REACTION_ACTIVE": {},
    "FAULT": {"fault reset": (15, "SWITCH_ON_DISABLED")},
}
CLASSES = [b7 | low for b7, low in product((0x00, 0x80), range(16))]


def command_of(word: int) -> str:
    bits = "".join(str(word >> bit & 1) for bit in (7, 3, 2, 1, 0))
    found = [
        name
        for name, pattern in PATTERNS.items()
        if all(p in ("x", b) for p, b in zip(pattern, bits, strict=True))
    ]
    assert len(found) == 1, f"0x{word:04X}: {found}"
    return found[0]


def expected(state: str, word: int, before: int) -> tuple[int | None, str]:
    """Transition and state by the standard; fault reset counts as a rising edge only."""
    command = command_of(word)
    if command == "fault reset" and before & 0x80:
        return None, state
    return STANDARD[state].get(command, (None, state))


def machine_in(
    state: str, before: int, entered: Callable[[State], None] | None = None, **options: int
) -> tuple[StateMachine, ProcessImage]:
    image = ProcessImage()
    image.set_defaults(DriveProfile())
    for name, value in options.items():
        setattr(image, name, value)
    machine = StateMachine(image, entered)
    machine.state = State.OPERATION_ENABLED
    image.controlword = 0x02 if state == "QUICK_STOP_ACTIVE" else before
    if state == "QUICK_STOP_ACTIVE":
        machine.command()  # so that it knows by which option code it stops
    machine.state = State.NOT_READY_TO_SWITCH_ON
    image.controlword = before
    machine.command()
    machine.state = State[state]
    return machine, image


@pytest.mark.long
@pytest.mark.parametrize("before", [0x00, 0x80])
@pytest.mark.parametrize("state", STANDARD)
def test_every_controlword_in_every_state(state: str, before: int) -> None:
    """All 65536 words, with option codes that neither brake (605B, 605C) nor hold back 16."""
    options = {"shutdown_option": 0, "disable_option": 0, "quick_stop_option": 6}
    by_bits = {word: expected(state, word, before) for word in CLASSES}
    machine, image = machine_in(state, before, **options)
    start, option = State[state], machine.option
    for word in range(0x10000):
        image.controlword = before
        machine.state = State.NOT_READY_TO_SWITCH_ON
        machine.command()
        machine.state, machine.option = start, option
        image.controlword = word
        answer = machine.command(), machine.state.name
        assert answer == by_bits[word & 0x8F], f"0x{word:04X}"


@pytest.mark.parametrize("before", [0x06, 0x0F])
def test_switch_on_and_enable_operation_in_one_word(before: int) -> None:
    """CiA 402-2, commands in the controlword: 0xxx 1111 takes transition 3, then 4 by itself."""
    seen: list[State] = []
    machine, image = machine_in("READY_TO_SWITCH_ON", before, seen.append)
    seen.clear()
    image.controlword = 0x0F
    assert machine.command() == 4
    assert seen == [State.SWITCHED_ON, State.OPERATION_ENABLED]


@pytest.mark.parametrize("code", range(9))
def test_operation_goes_on_after_a_quick_stop_only_when_it_stays_active(code: int) -> None:
    """Transition 16 belongs to the codes 5 to 8 of 605A; 12 by command to all."""
    machine, image = machine_in("QUICK_STOP_ACTIVE", 0x02, quick_stop_option=code)
    image.controlword = 0x0F
    assert machine.command() == (16 if code >= 5 else None)
    machine, image = machine_in("QUICK_STOP_ACTIVE", 0x02, quick_stop_option=code)
    image.controlword = 0x00
    assert (machine.command(), machine.state) == (12, State.SWITCH_ON_DISABLED)


@pytest.mark.parametrize(
    ("word", "number", "target"), [(0x06, 8, "READY_TO_SWITCH_ON"), (0x07, 5, "SWITCHED_ON")]
)
def test_a_transition_that_brakes_leaves_the_state_until_the_axis_stands(
    word: int, number: int, target: str
) -> None:
    machine, image = machine_in("OPERATION_ENABLED", 0x0F, shutdown_option=1, disable_option=1)
    image.controlword = word
    assert (machine.command(), machine.state.name) == (number, "OPERATION_ENABLED")
    assert machine.command() is None  # the word stays, the ramp runs
    assert machine.arrive()
    assert machine.state.name == target


@pytest.mark.parametrize(
    ("word", "number", "state"),
    [(0x0F, 4, "OPERATION_ENABLED"), (0x00, 9, "SWITCH_ON_DISABLED"),
     (0x02, 11, "QUICK_STOP_ACTIVE"), (0x80, None, "OPERATION_ENABLED")],
)  # fmt: skip
def test_what_a_command_does_while_the_ramp_runs(word: int, number: int, state: str) -> None:
    """Enable calls the ramp off, disable voltage and quick stop do not wait for it."""
    machine, image = machine_in("OPERATION_ENABLED", 0x0F, shutdown_option=1)
    image.controlword = 0x06
    machine.command()
    image.controlword = word
    assert (machine.command(), machine.state.name) == (number, state)
    assert (machine.waiting is None) == (number is not None)


# The same on the bus: statusword and power of a drive, for each class of words

MASKS = {
    "SWITCH_ON_DISABLED": (0x4F, 0x40), "READY_TO_SWITCH_ON": (0x6F, 0x21),
    "SWITCHED_ON": (0x6F, 0x23), "OPERATION_ENABLED": (0x6F, 0x27),
    "QUICK_STOP_ACTIVE": (0x6F, 0x07), "FAULT_REACTION_ACTIVE": (0x4F, 0x0F),
    "FAULT": (0x4F, 0x08),
}  # fmt: skip
WAYS = {
    "SWITCH_ON_DISABLED": [0x00], "READY_TO_SWITCH_ON": [0x06], "SWITCHED_ON": [0x06, 0x07],
    "OPERATION_ENABLED": [0x06, 0x07, 0x0F], "QUICK_STOP_ACTIVE": [0x06, 0x07, 0x0F, 0x02],
    "FAULT_REACTION_ACTIVE": [0x06, 0x07, 0x0F], "FAULT": [0x00],
}  # fmt: skip
POWER = ("OPERATION_ENABLED", "QUICK_STOP_ACTIVE", "FAULT_REACTION_ACTIVE")


@pytest.mark.parametrize("word", CLASSES)
def test_every_command_on_the_bus_in_every_state(
    drive_bench: Make, fake_axis: Any, word: int
) -> None:
    """The axis runs with 1 m/s whatever it is told, so that a fault reaction goes on and on."""
    bench = drive_bench(fake_axis(motion=lambda t: t))
    sdo = bench.remote.sdo
    for name, words in WAYS.items():
        bench.remote.nmt.send_command(129)
        bench.scheduler.run_until(bench.scheduler.now_ns + 1000 * US)
        sdo[0x605A].raw, sdo[0x605C].raw = 6, 0
        for step in words:
            sdo[0x6040].raw = step
        if name.startswith("FAULT"):
            bench.node.servo.fault(0x2310, 0x02, bench.scheduler.now_ns)
        if name == "FAULT":
            bench.scheduler.run_until(bench.scheduler.now_ns + 500 * US)
        mask, value = MASKS[name]
        assert sdo[0x6041].raw & mask == value, name
        sdo[0x6040].raw = word
        _, target = expected(name, word, words[-1])
        mask, value = MASKS[target]
        status = sdo[0x6041].raw
        assert status & mask == value, f"{name} -> {target}, not 0x{status:04X}"
        assert bench.axis.commands[-1].enabled == (target in POWER), name
        assert status & 0x0210 == 0x0210  # voltage enabled, remote


def test_numbers_of_option_codes_are_those_of_the_standard() -> None:
    """605A 0 to 8, 605B and 605C 0 and 1, 605D 1 to 4, 605E 0 to 4; what follows by number."""
    slow, quick, current, voltage = "SLOW_DOWN", "QUICK_STOP", "CURRENT_LIMIT", "VOLTAGE_LIMIT"
    four = [slow, quick, current, voltage]
    table = {
        0x605A: dict(enumerate(["COAST", *four, *four])),
        0x605B: {0: "COAST", 1: slow},
        0x605C: {0: "COAST", 1: slow},
        0x605D: dict(enumerate(four, 1)),
        0x605E: dict(enumerate(["COAST", *four])),
    }
    ours: dict[int, dict[int, str]] = {}
    for (index, code), option in OPTIONS.items():
        ours.setdefault(index, {})[code] = option.reaction.name
    assert ours == table
    assert [OPTIONS[0x605A, code].then.name for code in range(9)] == (
        ["SWITCH_ON_DISABLED"] * 5 + ["QUICK_STOP_ACTIVE"] * 4
    )


@pytest.mark.parametrize(
    ("habit", "usual", "taken", "refused"),
    [
        ("", {0x605A: 2, 0x605B: 0, 0x605C: 1, 0x605D: 1, 0x605E: 2}, (0, 5, 8), (9, -1)),
        ("605A:6", {0x605A: 6, 0x605E: 2}, (6,), (2, 5)),
        ("605A:2,6 605E:2,0", {0x605A: 2, 0x605E: 2}, (2, 6), (0, 1, 5)),
    ],
)
def test_a_drive_profile_may_take_fewer_option_codes(
    drive_bench: Make,
    habit: str,
    usual: dict[int, int],
    taken: tuple[int, ...],
    refused: tuple[int, ...],
) -> None:
    sdo = drive_bench(profile=DriveProfile(option_codes=habit)).remote.sdo
    assert {index: sdo[index].raw for index in usual} == usual
    for code in taken:
        sdo[0x605A].raw = code
    for code in refused:
        with pytest.raises(SdoAbortedError) as caught:
            sdo[0x605A].raw = code
        assert caught.value.code == 0x06090030


@pytest.mark.parametrize("state", STANDARD)
def test_power_off_and_on_are_the_transitions_0_and_1_from_every_state(state: str) -> None:
    entered: list[State] = []
    machine, _ = machine_in(state, 0, entered.append)
    entered.clear()
    machine.reset()
    begins = [] if state == "NOT_READY_TO_SWITCH_ON" else [State.NOT_READY_TO_SWITCH_ON]
    assert entered == [*begins, State.SWITCH_ON_DISABLED]
