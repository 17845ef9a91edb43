"""Blocks of programs as the interpreter hands them over."""

from typing import Any

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block


def block(number: int) -> Block:
    return Block(number, number * 10, f"N{number * 10}")


def move(number: int, feed_mm_min: float, **target_mm: float) -> canon.LinearMove:
    return canon.LinearMove(block(number), target_mm, False, feed_mm_min)


def probe(
    number: int,
    feed_mm_min: float | None,
    kind: int = 1,
    *,
    goes_on: bool = False,
    error_no_signal: bool | None = None,
    **target_mm: float,
) -> canon.MeasuringRun:
    axes = tuple(target_mm)
    return canon.MeasuringRun(
        block(number), target_mm, axes, axes, feed_mm_min, kind, goes_on, error_no_signal
    )


def probe_settings(number: int, axis: str, **settings: Any) -> canon.ProbeSettings:
    return canon.ProbeSettings(block(number), axis, **settings)


def prepare(number: int, *axes: str) -> canon.PrepareProbe:
    return canon.PrepareProbe(block(number), axes)


def message(number: int, text: str, *, synchronous: bool) -> canon.Message:
    return canon.Message(block(number), text, synchronous)


def wait(number: int) -> canon.Wait:
    return canon.Wait(block(number))


def end(number: int = 99) -> canon.EndOfProgram:
    return canon.EndOfProgram(block(number))
