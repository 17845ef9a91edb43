"""Opens CAN interfaces by their python-can names, with errors that say what is missing.

`interfaces.csv` has data of some: options they get when none are given, how long a
cycle waits for answers that come over a slow line, what must be installed.
"""

import contextlib
import csv
import importlib
import io
import logging
from collections.abc import Iterator, Mapping
from ctypes.util import find_library
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import can
from can.interfaces import BACKENDS

from axisrig.bench.bus.can.socketcand import SocketcandServer
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.time.clock import MS, TimeNs

SIMULATED = "axisrig"
_TRACEBACK = "Traceback (most recent call last)"
OWN = {"axisrig_tcp": SocketcandServer}
Option = bool | int | float | str


@dataclass(frozen=True)
class Interface:
    """Data of an interface.

    options: what it gets when nothing else is said. required: what it does not open without, with
    a value that shows what it looks like. wait_ns: how long a cycle waits for answers.
    libraries: names of its driver's library, one of which must be there.
    """

    name: str
    options: Mapping[str, Option]
    required: Mapping[str, Option]
    wait_ns: TimeNs
    libraries: tuple[str, ...]
    needs: str
    about: str


@cache
def known_interfaces() -> Mapping[str, Interface]:
    """Return the rows of `interfaces.csv` by name."""
    text = resources.files(__package__).joinpath("interfaces.csv").read_text(encoding="utf-8")
    return {
        row["interface"]: Interface(
            row["interface"],
            parse_options(row["options"]),
            parse_options(row["required"]),
            int(row["wait_ms"]) * MS,
            tuple(row["library"].split()),
            row["needs"],
            row["about"],
        )
        for row in csv.DictReader(text.splitlines())
    }


def interface_names() -> list[str]:
    """Return every name that may be given as `interface`, the simulated one first."""
    return [SIMULATED, *sorted({*BACKENDS, *OWN} - {SIMULATED})]


def parse_options(text: str) -> dict[str, Option]:
    """Read `key=value key=value`: true and false, numbers, else text.

    Raises UserError for what has no equals sign.
    """
    options: dict[str, Option] = {}
    for part in text.split():
        key, sign, value = part.partition("=")
        if not (key and sign and value):
            raise UserError("an option is key=value", value=part)
        options[key] = _value(value)
    return options


def _value(text: str) -> Option:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return text


def wait_ns(interface: str) -> TimeNs:
    """Return how long a cycle waits for answers on this interface; 0 for those in real time."""
    known = known_interfaces().get(interface)
    return known.wait_ns if known else 0


def open_bus(
    interface: str, channel: str | int | None, bitrate: int, options: Mapping[str, Option]
) -> can.BusABC:
    """Open an interface. options: passed on to it, over those of `interfaces.csv`.

    Raises UserError that says what is missing or wrong.
    """
    _hear_python_can()
    known = known_interfaces().get(interface)
    if interface not in interface_names():
        raise UserError(
            "no such CAN interface",
            value=interface,
            allowed=nearest(interface, interface_names()) or interface_names(),
            hint="axisrig doctor lists those that work here",
        )
    everything: dict[str, Any] = {"bitrate": bitrate, **(known.options if known else {}), **options}
    if channel is not None:
        everything["channel"] = channel
    try:
        with _quiet():
            if interface in OWN:
                return OWN[interface](**everything)
            return can.Bus(interface=interface, **everything)
    except (can.CanError, ImportError, OSError, ValueError, TypeError, TimeoutError) as error:
        where = interface if channel is None else f"{interface} {channel}"
        needs = f"needs: {known.needs}; " if known and known.needs else ""
        missing = [key for key in (known.required if known else ()) if key not in everything]
        if known and missing:
            raise UserError(
                f"the CAN interface {where} cannot be opened without {' and '.join(missing)}",
                hint="such as "
                + " ".join(_on_command_line(key, known.required[key]) for key in missing)
                + " (or in [segment.NAME] of the rig)",
            ) from error
        raise UserError(
            f"the CAN interface {where} cannot be opened: {in_one_line(error)}",
            hint=f"{needs}axisrig doctor lists what works here, docs/hardware.md how to set it up",
        ) from error


def in_one_line(error: Exception) -> str:
    """Say an error of an interface; some of python-can put a traceback into their text."""
    text = " ".join(str(error).partition(_TRACEBACK)[0].split())
    return text or type(error).__name__


def _on_command_line(key: str, value: Option) -> str:
    return f"--channel {value}" if key == "channel" else f"--option {key}={value}"


class _WithoutTracebacks(logging.Handler):
    """Shows what python-can logs, but for errors that it raises as well."""

    def emit(self, record: logging.LogRecord) -> None:
        if logging.lastResort is not None and _TRACEBACK not in record.getMessage():
            logging.lastResort.handle(record)


@cache
def _hear_python_can() -> None:
    """Take over what nobody has asked to see: without a handler it would go to the terminal."""
    if not logging.getLogger().handlers:
        logging.getLogger("can").addHandler(_WithoutTracebacks(logging.WARNING))


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep what python-can's backends log while they load out of the user's sight."""
    logger = logging.getLogger("can")
    level = logger.level
    logger.setLevel(logging.CRITICAL)  # loggers remember what they let through until it is called
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            yield
    finally:
        logger.setLevel(level)


def usable(interface: str) -> str | None:
    """Say why an interface cannot be used here, None when its software is there.

    Nothing is opened and nothing sent: whether an adapter is plugged in shows when it is opened.
    """
    if interface in OWN:
        return None
    module = BACKENDS[interface][0]
    try:
        with _quiet():
            loaded = importlib.import_module(module)
    except Exception as error:  # drivers fail in ways of their own when their library is missing
        return str(error) or type(error).__name__
    if interface == "socketcan":
        return _lacks_socketcan()
    known = known_interfaces().get(interface)
    if known and known.libraries and not any(find_library(name) for name in known.libraries):
        return "the library of its driver is not installed"
    if interface in ("slcan", "serial", "robotell") and getattr(loaded, "serial", True) is None:
        return "pyserial is not installed"
    return None


def _lacks_socketcan() -> str | None:
    import socket  # noqa: PLC0415

    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except (AttributeError, OSError) as error:
        return f"this system has no CAN sockets ({error})"
    return None
