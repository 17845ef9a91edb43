"""When blocks are decoded: ahead of the machine, and not before what they need of it is there."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program

Make = Callable[..., Any]


class Decoding:
    """Runs a program text on a bench and notes in which cycle each command was decoded.

    decoded: instant and command. changes: V.E. values by the set position of Z from which on the
    PLC side gives them.
    """

    def __init__(self, bench: Any, text: str, **external: float) -> None:
        self.bench = bench
        self.decoded: list[tuple[int, canon.Command]] = []
        self.changes: dict[float, dict[str, float]] = {}
        program = parse_program(text, axes=tuple(bench.axes))
        self._values = bench.channel.plc.values
        self._values.update(external)
        interpreter = Interpreter(program, tuple(bench.axes), bench.channel, external=self._values)
        self._commands = interpreter.commands()

    def run(self) -> "Decoding":
        self.bench.channel.observers.append(self._change)
        self.bench.run(self._noted())
        assert self.bench.alarm_ids == []
        return self

    def _change(self, channel: Any) -> None:
        for from_mm, values in self.changes.items():
            if channel.position_acs_mm("Z") >= from_mm:
                self._values.update(values)

    def _noted(self) -> Iterator[canon.Command]:
        for command in self._commands:
            self.decoded.append((self.bench.channel._clock.now_ns, command))
            yield command

    def at_ns(self, line: int) -> int:
        """When the first command of a line was decoded."""
        return next(time_ns for time_ns, command in self.decoded if command.block.line == line)

    def moves_ns(self, line: int) -> int:
        """When the last command of a line was decoded: the move behind its wait."""
        return [time_ns for time_ns, command in self.decoded if command.block.line == line][-1]

    def reaches_ns(self, position_mm: float) -> int:
        """The first cycle in which Z was told to be there."""
        return next(s.time_ns for s in self.bench.samples if s.set_mm[0] == position_mm)


@pytest.mark.long
def test_without_a_reason_nothing_waits(channel_bench: Make, words: Any) -> None:
    """All blocks are decoded in the first cycle, and the axis never stands between them."""
    bench = channel_bench(words.axis("Z"))
    done = Decoding(bench, 'G1 F600 Z1\nP1=2\n$IF P1==2\nZ=P1\n$ENDIF\nZ3\n#MSG ["all"]').run()
    assert {time_ns for time_ns, _ in done.decoded} == {bench.channel.start_ns}
    assert [bench.set_mm("Z").count(z) for z in (1.0, 2.0)] == [1, 1]


@pytest.mark.long
def test_a_value_of_the_plc_side_is_read_when_the_machine_got_there(
    channel_bench: Make, words: Any
) -> None:
    """The PLC side changes it while Z moves to 2; read ahead it would still be 5."""
    bench = channel_bench(words.axis("Z"))
    decoding = Decoding(bench, "G1 F600 Z2\nZ=V.E.TARGET", TARGET=5.0)
    decoding.changes[1.0] = {"TARGET": 3.0}
    decoding.run()
    assert bench.final_mm("Z") == 3.0
    assert decoding.at_ns(2) == bench.channel.start_ns  # the wait itself is decoded ahead
    assert decoding.moves_ns(2) > decoding.reaches_ns(2.0)


@pytest.mark.long
def test_blocks_behind_a_synchronous_message_are_decoded_when_it_is_out(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z"))
    done = Decoding(bench, 'G1 F600 Z2\n#MSG SYN ["two"]\nZ3').run()
    ((told_ns, _),) = bench.messages
    assert done.at_ns(3) == told_ns > done.reaches_ns(2.0)


@pytest.mark.long
def test_a_measured_value_waits_for_all_that_was_programmed_before(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=10.0), plane_mm=5.0)
    done = Decoding(bench, "G100 F600 Z2\nG1 Z6\nZ=V.A.MESS.Z+2").run()
    assert done.moves_ns(3) > done.reaches_ns(6.0)
    assert abs(bench.final_mm("Z") - 7.0) < 1e-3


@pytest.mark.long
def test_a_value_for_the_plc_side_is_given_out_between_the_moves(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z"))
    done = Decoding(bench, "G1 F600 Z2\nV.E.DONE=1\nZ3", DONE=0.0).run()
    ((time_ns, write, _),) = bench.channel.plc.events
    assert (write.name, write.value) == ("DONE", 1.0)
    assert time_ns >= done.reaches_ns(2.0) > done.at_ns(2)
    assert bench.channel.plc.values["DONE"] == 1.0
    without = channel_bench(words.axis("Z"))
    Decoding(without, "G1 F600 Z2\nZ3").run()
    assert bench.set_mm("Z") == without.set_mm("Z")  # giving out a value stops nothing


@pytest.mark.long
def test_blocks_behind_a_programmed_stop_are_decoded_when_the_program_goes_on(
    channel_bench: Make, words: Any
) -> None:
    settings = ChannelSettings(start_after_ns=50_000_000)
    bench = channel_bench(words.axis("Z"), settings=settings)
    done = Decoding(bench, "G1 F600 Z2\nM0\nZ3").run()
    assert done.at_ns(3) >= done.reaches_ns(2.0) + 50_000_000


def test_a_loop_that_asks_the_plc_side_goes_on_when_the_value_comes(
    channel_bench: Make, words: Any
) -> None:
    """One question in each cycle; the PLC side answers while Z stands."""
    bench = channel_bench(words.axis("Z"))
    decoding = Decoding(bench, "G1 F600 Z1\n$WHILE V.E.GO==0\n$ENDWHILE\nZ2", GO=0.0)
    cycles = 0

    def answer(channel: Any) -> None:
        nonlocal cycles
        cycles += channel.position_acs_mm("Z") == 1.0
        if cycles == 30:
            channel.plc.values["GO"] = 1.0

    bench.channel.observers.append(answer)
    decoding.run()
    assert bench.final_mm("Z") == 2.0
    assert 30 <= bench.set_mm("Z").count(1.0) <= 33


def test_an_actual_position_is_read_when_the_machine_got_there(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z"))
    done = Decoding(bench, 'G1 F600 Z2\n#MSG ["%f", V.A.ACT_POS.Z]').run()
    ((time_ns, text),) = bench.messages
    assert time_ns > done.reaches_ns(2.0)
    assert 1.5 < float(text) < 2.0  # behind its set position by its following error
