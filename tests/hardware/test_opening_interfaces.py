"""How a CAN interface is opened, and what a user reads when that fails."""

import logging
from functools import partial
from typing import Any

import can
import pytest

from axisrig.bench.bus.can import hardware
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

TRACEBACK = "Traceback (most recent call last):\n  File x, line 1"


def refuse(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    """Let python-can open nothing."""

    def fail(**_: Any) -> None:
        raise error

    monkeypatch.setattr(can, "Bus", fail)


@pytest.mark.parametrize(
    ("interface", "wait_ms"),
    [
        ("socketcan", 0), ("pcan", 0), ("vector", 0), ("gs_usb", 5), ("slcan", 50), ("serial", 50),
        ("socketcand", 50), ("axisrig_tcp", 50), ("robotell", 0), ("axisrig", 0), ("no such", 0),
    ],
)  # fmt: skip
def test_a_cycle_waits_on_slow_lines_only(interface: str, wait_ms: int) -> None:
    """50 ms on serial lines and TCP (docs/hardware.md); what is not in the table has none."""
    assert hardware.wait_ns(interface) == wait_ms * MS


def test_what_an_interface_does_not_open_without_has_an_example() -> None:
    known = hardware.known_interfaces()
    assert known["socketcand"].required == {
        "channel": "can0", "host": "127.0.0.1", "port": 29536
    }  # fmt: skip
    assert known["socketcand"].options == {"tcp_tune": True}
    assert known["slcan"].required == {"channel": "/dev/ttyACM0"}
    assert (known["pcan"].required, known["pcan"].options) == ({}, {})
    assert known["kvaser"].required == {"channel": 0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True), ("TRUE", True), ("False", False), ("7", 7), ("-3", -3), ("0.5", 0.5),
        ("1e3", 1000.0), ("can0", "can0"), ("a=b", "a=b"), ("0x10", "0x10"),
    ],
)  # fmt: skip
def test_the_value_of_an_option_keeps_its_kind(text: str, value: Any) -> None:
    (found,) = hardware.parse_options(f"Key={text}").items()
    assert found == ("Key", value)
    assert type(found[1]) is type(value)


@pytest.mark.parametrize("bad", ["key", "key=", "=value", "="])
def test_an_option_without_name_or_value_is_refused(bad: str) -> None:
    with pytest.raises(UserError) as caught:
        hardware.parse_options(f"first=1 {bad} last=2")
    assert (caught.value.message, caught.value.value) == ("an option is key=value", bad)
    assert hardware.parse_options("  ") == {}


@pytest.mark.parametrize("channel", [None, 0, 1, "can0", ""])
def test_a_channel_goes_to_the_interface_where_one_is_given(
    monkeypatch: pytest.MonkeyPatch, channel: int | str | None
) -> None:
    """Channel 0 is the first one of an adapter."""
    given: list[dict[str, Any]] = []
    monkeypatch.setattr(can, "Bus", lambda **options: given.append(options))
    hardware.open_bus("kvaser", channel, 250_000, {"single_handle": True})
    expected = {"interface": "kvaser", "bitrate": 250_000, "single_handle": True}
    assert given == [expected if channel is None else {**expected, "channel": channel}]


@pytest.mark.parametrize(
    "error",
    [
        can.CanError("refused"), can.CanInitializationError("refused"), ImportError("refused"),
        OSError("refused"), ValueError("refused"), TypeError("refused"), TimeoutError("refused"),
    ],
    ids=lambda error: type(error).__name__,
)  # fmt: skip
@pytest.mark.parametrize(
    ("interface", "channel", "where", "needs"),
    [
        ("pcan", "PCAN_USBBUS1", "pcan PCAN_USBBUS1", "needs: PEAK driver (PCAN-Basic); "),
        ("kvaser", 0, "kvaser 0", "needs: Kvaser CANlib; "),
        ("pcan", None, "pcan", "needs: PEAK driver (PCAN-Basic); "),
        ("virtual", "one", "virtual one", ""),
        ("robotell", "one", "robotell one", ""),
    ],
)
def test_an_interface_that_fails_is_named_with_the_reason_and_what_it_needs(
    monkeypatch: pytest.MonkeyPatch,
    interface: str,
    channel: str | int | None,
    where: str,
    needs: str,
    error: Exception,
) -> None:
    refuse(monkeypatch, error)
    with pytest.raises(UserError) as caught:
        hardware.open_bus(interface, channel, 1_000_000, {})
    assert caught.value.message == f"the CAN interface {where} cannot be opened: refused"
    assert caught.value.hint == (
        f"{needs}axisrig doctor lists what works here, docs/hardware.md how to set it up"
    )


@pytest.mark.parametrize(
    ("options", "channel", "lacks", "examples"),
    [
        ({}, None, "channel and host and port", "--channel can0 --option host=127.0.0.1"
         " --option port=29536"),
        ({}, "can1", "host and port", "--option host=127.0.0.1 --option port=29536"),
        ({"host": "there"}, "can1", "port", "--option port=29536"),
        ({"port": 1}, "can1", "host", "--option host=127.0.0.1"),
        ({"host": "there", "port": 1}, None, "channel", "--channel can0"),
    ],
)  # fmt: skip
def test_examples_are_of_what_is_missing_alone(
    monkeypatch: pytest.MonkeyPatch,
    options: dict[str, Any],
    channel: str | None,
    lacks: str,
    examples: str,
) -> None:
    refuse(monkeypatch, TypeError("missing an argument"))
    with pytest.raises(UserError) as caught:
        hardware.open_bus("socketcand", channel, 1_000_000, options)
    assert caught.value.message.endswith(f"socketcand{f' {channel}' if channel else ''}"
                                         f" cannot be opened without {lacks}")  # fmt: skip
    assert caught.value.hint == f"such as {examples} (or in [segment.NAME] of the rig)"


def test_an_interface_that_lacks_nothing_says_its_own_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    refuse(monkeypatch, OSError("no route"))
    with pytest.raises(UserError, match="cannot be opened: no route"):
        hardware.open_bus("socketcand", "can0", 1_000_000, {"host": "there", "port": 1})


def test_an_unknown_interface_has_its_name_and_those_near_it_or_all() -> None:
    with pytest.raises(UserError) as near:
        hardware.open_bus("kvasr", "0", 1_000_000, {})
    assert (near.value.value, near.value.message) == ("kvasr", "no such CAN interface")
    assert "did you mean: kvaser;" in str(near.value)
    with pytest.raises(UserError) as far:
        hardware.open_bus("?!", "0", 1_000_000, {})
    names = hardware.interface_names()
    assert ", ".join(names) in str(far.value)
    assert names == ["axisrig", *sorted({*names} - {"axisrig"})]
    assert {"axisrig_tcp", "socketcan", "virtual"} <= {*names}


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (OSError("one\n  two\t three "), "one two three"),
        (can.CanError(f"Failed:\n{TRACEBACK}"), "Failed:"),
        (can.CanError(TRACEBACK), "CanError"),
        (TimeoutError(), "TimeoutError"),
        (ValueError("  "), "ValueError"),
    ],
)
def test_an_error_of_an_interface_is_one_line(error: Exception, line: str) -> None:
    assert hardware.in_one_line(error) == line


@pytest.mark.parametrize("level", [logging.NOTSET, logging.DEBUG, logging.ERROR])
@pytest.mark.parametrize("is_refused", [False, True])
def test_python_can_is_silent_while_it_opens_and_logs_as_before_afterwards(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    request: pytest.FixtureRequest,
    level: int,
    is_refused: bool,
) -> None:
    """Its backends have loggers of their own below that of python-can."""
    logger, backend = logging.getLogger("can"), logging.getLogger("can.of_this_test")
    logged: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: logged.append(record.getMessage())  # type: ignore[method-assign]

    def chatty(**_: Any) -> str:
        print("loading")
        for one in (logger, backend):
            one.error("while it opens")
        if is_refused:
            raise OSError("refused")
        return "bus"

    monkeypatch.setattr(logger, "handlers", [handler])
    request.addfinalizer(partial(logger.setLevel, logger.level))
    logger.setLevel(level)
    monkeypatch.setattr(can, "Bus", chatty)
    if is_refused:
        with pytest.raises(UserError):
            hardware.open_bus("virtual", "one", 1_000_000, {})
    else:
        assert hardware.open_bus("virtual", "one", 1_000_000, {}) == "bus"  # type: ignore[comparison-overlap]
    assert (capsys.readouterr().out, logged, logger.level) == ("", [], level)
    for one in (logger, backend):
        one.error("afterwards")
    assert logged == ["afterwards", "afterwards"]


@pytest.mark.parametrize("is_heard", [False, True])
def test_what_python_can_logs_is_shown_once_and_without_tracebacks(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], is_heard: bool
) -> None:
    """Nothing is taken over where somebody has asked for the log."""
    logger, shown, elsewhere = logging.getLogger("can"), logging.StreamHandler(), logging.Handler()
    elsewhere.emit = lambda _record: None  # type: ignore[method-assign]
    monkeypatch.setattr(logger, "handlers", [])
    monkeypatch.setattr(logging.getLogger(), "handlers", [elsewhere] if is_heard else [])
    monkeypatch.setattr(logging, "lastResort", shown)
    monkeypatch.setattr(can, "Bus", lambda **_: "bus")
    hardware._hear_python_can.cache_clear()
    for _ in range(2):
        hardware.open_bus("virtual", "one", 1_000_000, {})
    logger.warning("the queue is full")
    logger.info("a frame has come")
    logger.error("receiving has failed: %s", TRACEBACK)
    hardware._hear_python_can.cache_clear()
    assert capsys.readouterr().err == ("" if is_heard else "the queue is full\n")
