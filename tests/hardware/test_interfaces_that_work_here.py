"""Which CAN interfaces can be used on a computer, and why another one cannot."""

import importlib
import socket
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can import hardware


@pytest.fixture
def computer(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A computer with the libraries and the modules of python-can that are given."""

    def make(*libraries: str, module: Any = None) -> None:
        def load(_name: str) -> Any:
            if isinstance(module, Exception):
                raise module
            return module or SimpleNamespace()

        monkeypatch.setattr(importlib, "import_module", load)
        monkeypatch.setattr(
            hardware, "find_library", lambda name: f"lib{name}" if name in libraries else None
        )

    return make


@pytest.mark.parametrize("interface", ["pcan", "kvaser", "ixxat"])
def test_one_of_the_names_of_a_driver_is_enough(computer: Any, interface: str) -> None:
    """A driver has another name on each system (column `library` of `interfaces.csv`)."""
    libraries = hardware.known_interfaces()[interface].libraries
    assert len(libraries) > 1
    for library in libraries:
        computer(library)
        assert hardware.usable(interface) is None
    computer("another")
    assert hardware.usable(interface) == "the library of its driver is not installed"


def test_what_needs_pyserial_cannot_be_used_without_it(computer: Any) -> None:
    for interface in ("slcan", "serial", "robotell"):
        computer(module=SimpleNamespace(serial=None))
        assert hardware.usable(interface) == "pyserial is not installed"
        computer(module=SimpleNamespace(serial=object()))
        assert hardware.usable(interface) is None
    computer(module=SimpleNamespace(serial=None))
    assert hardware.usable("gs_usb") is None  # it does not need it
    assert hardware.usable("axisrig_tcp") is None


@pytest.mark.parametrize(
    ("error", "reason"), [(OSError("no driver"), "no driver"), (ImportError(), "ImportError")]
)
def test_a_module_that_cannot_be_loaded_says_why(
    computer: Any, error: Exception, reason: str
) -> None:
    computer(module=error)
    assert hardware.usable("vector") == reason


def test_socketcan_needs_can_sockets(computer: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    computer()
    closed: list[bool] = []

    monkeypatch.setattr(
        socket, "socket", lambda *_: SimpleNamespace(close=lambda: closed.append(True))
    )
    for name in ("AF_CAN", "SOCK_RAW", "CAN_RAW"):
        monkeypatch.setattr(socket, name, 1, raising=False)
    assert hardware.usable("socketcan") is None
    assert closed == [True]

    def refused(*_: int) -> Any:
        raise OSError("not supported")

    monkeypatch.setattr(socket, "socket", refused)
    assert hardware.usable("socketcan") == "this system has no CAN sockets (not supported)"
    monkeypatch.setattr(socket, "socket", lambda *_: SimpleNamespace(close=lambda: None))
    monkeypatch.delattr(socket, "AF_CAN")
    reason = hardware.usable("socketcan") or ""
    assert reason.startswith("this system has no CAN sockets (")
    assert "AF_CAN" in reason
