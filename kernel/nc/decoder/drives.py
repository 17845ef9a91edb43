"""Functions of the drives (#DRIVE)."""

from collections.abc import Iterator

from kernel.nc import canon
from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic
from kernel.nc.decoder.variables import own
from kernel.nc.syntax import DriveRead, DriveWait, DriveWrite


def _write(context: Context, block: Block, written: DriveWrite) -> Iterator[canon.Command]:
    number = context.value(block, written.value)
    yield canon.DriveWrite(block, written.axis, written.key, number, written.waits)


def _wait(context: Context, block: Block, waiting: DriveWait) -> Iterator[canon.Command]:
    yield canon.DriveWait(block, waiting.axis)


def _read(context: Context, block: Block, reading: DriveRead) -> Iterator[canon.Command]:
    yield canon.DriveRead(block, reading.axis, reading.key)
    yield canon.Wait(block)
    value = context.machine.drive_value(reading.axis, reading.key)
    own.store(context, block, reading.variable, value)


TOPIC = Topic(statements={DriveWrite: _write, DriveWait: _wait, DriveRead: _read})
