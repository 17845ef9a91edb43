"""The order in which blocks are decoded: structures, jumps, subprograms, the end of the program."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.cells import Cell, Store
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.frames import CALLS_MAX
from axisrig.kernel.nc.decoder.base.topic import Topic, silent
from axisrig.kernel.nc.decoder.topics.circles import Circle
from axisrig.kernel.nc.decoder.topics.pauses import BlockEnds
from axisrig.kernel.nc.expressions import Value
from axisrig.kernel.nc.syntax import (
    Break,
    Case,
    Continue,
    Default,
    Do,
    Else,
    ElseIf,
    EndDo,
    EndFor,
    EndIf,
    EndSwitch,
    EndWhile,
    Expression,
    For,
    Goto,
    If,
    Label,
    Repeat,
    SubprogramCall,
    Switch,
    Until,
    While,
    Words,
)

# $SWITCH and $CASE are equal below this difference. Source: programming manual 206908427
SAME_CASE = 0.001


def _if(context: Context, block: Block, statement: If) -> None:
    frame = context.flow.frame
    if not context.holds(block, statement.condition):
        frame.jump(frame.link.other)
        frame.testing = True


def _else_if(context: Context, block: Block, statement: ElseIf) -> None:
    frame = context.flow.frame
    if frame.testing:
        frame.testing = False
        _if(context, block, If(statement.condition))
    else:
        frame.jump(frame.link.end)


def _else(context: Context, block: Block, statement: Else) -> None:
    frame = context.flow.frame
    if frame.testing:
        frame.testing = False
    else:
        frame.jump(frame.link.end)


def _end_if(context: Context, block: Block, statement: EndIf) -> None:
    context.flow.frame.testing = False


def _switch(context: Context, block: Block, statement: Switch) -> None:
    frame = context.flow.frame
    value = context.any_value(block, statement.value)
    frame.jump(frame.link.other)
    frame.choosing = value


def _case(context: Context, block: Block, statement: Case) -> None:
    frame = context.flow.frame
    choosing = frame.choosing
    if choosing is None:
        return  # the case before has no $BREAK
    if _same(choosing, context.any_value(block, statement.value)):
        frame.choosing = None
    else:
        frame.jump(frame.link.other)
        frame.choosing = choosing


def _same(left: Value, right: Value) -> bool:
    if isinstance(left, str) or isinstance(right, str):
        return left == right
    return abs(left - right) < SAME_CASE


def _chosen(context: Context, block: Block, statement: Default | EndSwitch) -> None:
    context.flow.frame.choosing = None


def _for(context: Context, block: Block, statement: For) -> Iterator[canon.Command]:
    frame = context.flow.frame
    first, last, step = (
        context.value(block, value) for value in (statement.first, statement.last, statement.step)
    )
    frame.loops[frame.place] = (last, step)
    frame.turns.pop(frame.place, None)
    yield from context.write(block, statement.variable, first)
    if _is_beyond(first, last, step):
        frame.jump(frame.link.end + 1)


def _end_for(context: Context, block: Block, statement: EndFor) -> Iterator[canon.Command]:
    frame = context.flow.frame
    link = frame.link
    loop = frame.part(link.begin).statement
    assert isinstance(loop, For)
    last, step = frame.loops[link.begin]
    value = context.value(block, loop.variable) + step
    yield from context.write(block, loop.variable, value)
    if not _is_beyond(value, last, step):
        frame.turn_back(link.begin)
        frame.jump(link.begin + 1)


def _is_beyond(value: float, last: float, step: float) -> bool:
    """A step of 0 never gets there. Source: programming manual 206929163."""
    return value > last if step > 0 else value < last if step < 0 else False


def _while(context: Context, block: Block, statement: While) -> None:
    frame = context.flow.frame
    _enter(context, block, statement)
    if not context.holds(block, statement.condition):
        frame.jump(frame.link.end + 1)


def _enter(context: Context, block: Block, statement: Any) -> None:
    """Count the turns of a loop from its entry on."""
    frame = context.flow.frame
    if frame.turning != frame.place:
        frame.turns.pop(frame.place, None)
    frame.turning = None


def _turn(context: Context, block: Block, statement: EndWhile) -> None:
    frame = context.flow.frame
    frame.turn_back(frame.link.begin)


def _end_do(context: Context, block: Block, statement: EndDo) -> None:
    if context.holds(block, statement.condition):
        frame = context.flow.frame
        frame.turn_back(frame.link.begin)


def _until(context: Context, block: Block, statement: Until) -> None:
    if not context.holds(block, statement.condition):
        frame = context.flow.frame
        frame.turn_back(frame.link.begin)


def _break(context: Context, block: Block, statement: Break) -> None:
    frame = context.flow.frame
    frame.jump(frame.link.end + 1)


def _continue(context: Context, block: Block, statement: Continue) -> None:
    frame = context.flow.frame
    frame.jump(frame.link.end)


def _goto(context: Context, block: Block, statement: Goto) -> None:
    if statement.condition is None or context.holds(block, statement.condition):
        context.flow.jump(statement.target.label)


def _nothing(context: Context, block: Block, statement: Any) -> None:
    pass


def _restoring(context: Context) -> Callable[[], None] | None:
    """Return what gives the caller of a cycle its modal state back; None with P-CHAN-00210 = 1.

    Given back are G functions that stand alone (motion, G90/G91, G70/G71, plane, G53 to G59, G161
    to G165, G260/G261, G359/G360), what is kept of circles, and the feed. What comes with a value
    or with axes (G92, G101, G130, G159) stays. Source: TF5200 channel parameters 476043659.
    """
    if context.tables.cycle_changes_modal:
        return None
    modal = replace(context.modal)
    circle, ends = replace(context.part(Circle)), replace(context.part(BlockEnds))
    plane, zero_group = context.coordinates.plane, context.coordinates.zero_group

    def restore() -> None:
        if context.modal.zero_group != modal.zero_group:
            context.select_zero(zero_group)
        context.modal = modal
        ends.rounds = context.part(BlockEnds).rounds  # of the last block of motion, not modal
        context.keep(circle)
        context.keep(ends)
        context.coordinates.plane = plane

    return restore


def _call(context: Context, block: Block, call: SubprogramCall) -> None:
    flow = context.flow
    if len(flow.frames) > CALLS_MAX:
        # Source of the ID: global subprograms; the local ones have none of their own
        raise context.alarm(20360, block, limit=CALLS_MAX, name=call.name)
    unit = flow.frame.routine.unit
    if call.scope == "local":
        flow.call(unit.local[call.name])
        return
    called = unit.called[call.name].main
    if call.scope == "cycle":
        flow.call(called, _parameters(context, block, call), _restoring(context))
    else:
        flow.call(called)


def _parameters(context: Context, block: Block, call: SubprogramCall) -> Store:
    """Return @P and @S as the call gives them; they are computed before the cycle begins."""
    store: Store = {}
    for keyword, option in call.parameters:
        if not isinstance(option, Expression):
            raise context.not_acting(block, f"L CYCLE [{keyword}]", "modal call of a cycle")
        sign, number = keyword[:2], int(keyword[2:])
        values = store.setdefault(f"{sign}[]", Cell()).values
        values[number,] = context.any_value(block, option)
    return store


def _return(context: Context, block: Block, words: Words) -> None:
    if not context.flow.leave():
        context.ends = True


def _end(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """M2, M30: also in a subprogram, with a warning. Source: programming manual 206828043."""
    context.ends = True
    flow = context.flow
    if len(flow.frames) > 1:
        word = "M30" if "M30" in words.m else "M2"
        name = flow.frame.routine.name
        yield canon.Warn(block, context.alarm(900125, block, word=word, name=name))


TOPIC = Topic(
    statements={
        If: silent(_if),
        ElseIf: silent(_else_if),
        Else: silent(_else),
        EndIf: silent(_end_if),
        Switch: silent(_switch),
        Case: silent(_case),
        Default: silent(_chosen),
        EndSwitch: silent(_chosen),
        For: _for,
        EndFor: _end_for,
        While: silent(_while),
        EndWhile: silent(_turn),
        Do: silent(_enter),
        EndDo: silent(_end_do),
        Repeat: silent(_enter),
        Until: silent(_until),
        Break: silent(_break),
        Continue: silent(_continue),
        Goto: silent(_goto),
        Label: silent(_nothing),
        SubprogramCall: silent(_call),
    },
    endings={
        "M2": _end,
        "M30": _end,
        "M17": silent(_return),
        "M29": silent(_return),
    },
)
