"""Power of a drive as the control sees it and asks for it; `power.csv` has the requests."""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final


class Power(Enum):
    """The state of a drive's power."""

    __hash__ = object.__hash__  # tables are asked in every cycle; that of Enum is in Python

    OFF = auto()  # no torque, no fault
    OPERATING = auto()  # it follows its set values
    STOPPING = auto()  # it stops by itself, with torque
    FAULT = auto()


class PowerRequest(Enum):
    """What the control wants of a drive's power."""

    __hash__ = object.__hash__

    OFF = auto()
    ON = auto()
    KEEP = auto()  # go on with what it does, but never lead it into operation again
    RELEASE = auto()  # out of operation, and never into it again
    STOP = auto()  # let it stop by itself: it does not follow its set values


class PowerOrder(Enum):
    """What changes a request."""

    SWITCH_ON = auto()
    SWITCH_OFF = auto()
    HOLD_BACK = auto()  # an alarm: see KEEP and RELEASE
    STOP = auto()
    LET_GO = auto()  # a reset: lead it again


def _read() -> Mapping[tuple[PowerRequest, PowerOrder], PowerRequest]:
    text = resources.files(__package__).joinpath("power.csv").read_text(encoding="utf-8")
    return {
        (PowerRequest[row["request"]], PowerOrder[row["order"]]): PowerRequest[row["next"]]
        for row in csv.DictReader(text.splitlines())
    }


NEXT: Final = _read()
"""The request after an order; an order that is not there changes nothing."""
