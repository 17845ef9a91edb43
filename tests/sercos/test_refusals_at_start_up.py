"""What ends the start-up of a SERCOS drive: each access that it refuses, by its name."""

from typing import Any

import pytest
from tests.sercos.test_start_up_by_hand import DONE, IDLE, RUNNING, Far, alarm_of

from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.drives.sercos.settings import RealTimeBits
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.sercos.service import Element, pack_list

NO_IDENT, PROTECTED = 0x1001, 0x7004


class Refusing(Far):
    """refuses: an element of an ident that cannot be read (None: a value that is not taken)."""

    def __init__(self, *refuses: tuple[int, Element | None], **idents: Any) -> None:
        super().__init__(**idents)
        self.refuses = set(refuses)

    def read(self, drive: int, ident: int, elements: Element, done: Any) -> None:
        if (ident, elements) in self.refuses:
            done(SoeError(ident, NO_IDENT))
        else:
            super().read(drive, ident, elements, done)

    def write(self, drive: int, ident: int, value: bytes, done: Any) -> None:
        if (ident, None) in self.refuses:
            done(SoeError(ident, PROTECTED))
        else:
            super().write(drive, ident, value, done)


@pytest.mark.parametrize(
    ("ident", "step"),
    [
        (57, "S-0-0057 = 7"),
        (301, "S-0-0301 = S-0-0405"),
        (305, "S-0-0305 = nothing"),
        (1, "S-0-0001 = 2000"),
        (2, "S-0-0002 = 2000"),
        (32, "S-0-0032 = 11"),
        (15, "S-0-0015 = 7"),
    ],
)
@pytest.mark.parametrize("element", [Element.ATTRIBUTE, None])
def test_a_value_that_is_refused_is_named_with_what_was_to_be_written(
    ident: int, step: str, element: Element | None
) -> None:
    """Whether its attribute is not there or the value is not taken; nothing is written after it."""
    far = Refusing((ident, element), i76=1)
    writes = [(57, 7), (301, 405), (305, 0)]
    alarm = alarm_of(far, far.steps(increments_per_mm=1e4, writes=writes).in_preop())
    assert (alarm.id, alarm.values["axis"], alarm.values["step"]) == (900743, "Z", step)
    assert alarm.values["answer"] == str(SoeError(ident, NO_IDENT if element else PROTECTED))
    order = [57, 301, 305, 1, 2, 32, 15]
    assert [written for written, _ in far.written] == order[: order.index(ident)]


@pytest.mark.parametrize(("ident", "step"), [(16, "S-0-0016 = "), (24, "S-0-0024 = ")])
def test_a_list_of_a_telegram_that_is_refused_is_named(ident: int, step: str) -> None:
    far = Refusing((ident, None), i76=1)
    alarm = alarm_of(far, far.steps(increments_per_mm=1e4).in_preop())
    assert (alarm.id, alarm.values["step"]) == (900743, step)


@pytest.mark.parametrize("phase", [3, 4])
@pytest.mark.parametrize(
    ("refused", "step"),
    [("start", "= 3"), ("state", "= 3"), ("end", "= 0")],
)
def test_a_check_that_cannot_be_made_ends_the_start_up(phase: int, refused: str, step: str) -> None:
    """S-0-0127 before phase 3 and S-0-0128 before phase 4: begun, asked for, cancelled."""
    command = {3: 127, 4: 128}[phase]
    element = {"start": None, "state": Element.DATA_STATE, "end": Element.NAME}[refused]
    far = Refusing((command, element))
    far.states[command] = [RUNNING, DONE]
    if refused == "end":
        write = far.write

        def until_the_end(drive: int, ident: int, value: bytes, done: Any) -> None:
            if not any(value):
                far.refuses.add((ident, None))
            write(drive, ident, value, done)

        far.write = until_the_end  # type: ignore[method-assign]
    steps = far.steps()
    alarm = alarm_of(far, steps.before_safeop() if phase == 3 else steps.before_op())
    assert (alarm.id, alarm.values["step"]) == (900743, f"S-0-0{command} {step}")
    assert alarm.values["answer"] == str(
        SoeError(command, NO_IDENT if refused == "state" else PROTECTED)
    )
    assert far.warned == []


@pytest.mark.parametrize(("bit", "allocation"), [(0x40, 301), (0x80, 303)])
def test_a_real_time_bit_of_the_probing_cycle_has_to_be_there_too(
    bit: int, allocation: int
) -> None:
    """P-AXIS-00700: S-0-0170 by a real-time control bit; the other one is that of the enable."""
    bits = RealTimeBits(0xC0 ^ bit, 0x40, 0x80, bit)
    other = 604 - allocation
    right = {allocation: 170, other: 405, 305: 409, 307: 401, 169: 1}

    def checked(**changes: int) -> Far:
        far = Far(i76=1)
        far.idents |= right | {int(name[1:]): value for name, value in changes.items()}
        far.run(far.steps(increments_per_mm=1e4, bits=bits, measures=True).in_preop())
        return far

    assert checked().drive.knows_level
    for wrong, shown in ((0, "nothing"), (405, "S-0-0405")):
        with pytest.raises(Alarm) as caught:
            checked(**{f"i{allocation}": wrong})
        values = caught.value.values
        assert (caught.value.id, values["ident"]) == (900744, f"S-0-0{allocation}")
        assert (values["found"], values["expected"]) == (shown, "S-0-0170")
        assert (values["input"], values["edge"]) == (1, "POS")


@pytest.mark.parametrize("when", ["before", "after", "write", "attribute"])
def test_a_probing_cycle_that_cannot_be_begun(when: str) -> None:
    """Without an answer to what it was before it is begun; without one afterwards it is refused."""
    refuses = {
        "attribute": (170, Element.ATTRIBUTE),
        "write": (170, None),
        "before": (170, Element.DATA_STATE),
        "after": (170, Element.DATA_STATE),
    }
    far = Refusing() if when in ("before", "after") else Refusing(refuses[when])
    far.states[170] = [IDLE, RUNNING]
    if when in ("before", "after"):
        looks = [SoeError(170, NO_IDENT), b"\7\0"]
        if when == "after":
            looks = [b"\0\0", SoeError(170, NO_IDENT)]
        read = far.read

        def first(drive: int, ident: int, elements: Element, done: Any) -> None:
            if elements is Element.DATA_STATE:
                done(looks.pop(0))
            else:
                read(drive, ident, elements, done)

        far.read = first  # type: ignore[method-assign]
    steps = far.steps(measures=True).in_op()
    if when == "before":
        far.run(steps)
        assert far.written == [(170, b"\3\0\0\0")]
    else:
        assert alarm_of(far, steps).id == (900746 if when == "after" else 900743)


def test_what_is_invalid_for_a_phase_comes_in_the_order_of_the_drive() -> None:
    far = Far()
    far.states[127] = [0xF]
    far.lists[21] = pack_list([76, 1, 2], 2, 8)
    far.run(far.steps().before_safeop())
    assert [each.values["ident"] for each in far.warned] == ["S-0-0076", "S-0-0001", "S-0-0002"]
    assert {each.values["command"] for each in far.warned} == {"S-0-0127"}
