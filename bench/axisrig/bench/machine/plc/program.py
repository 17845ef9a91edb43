"""Loads the PLC program of a rig, and runs its cycles so that a mistake in it is named by line."""

import ast
import inspect
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from axisrig.bench.machine.plc.elements import UnknownNameError
from axisrig.bench.machine.plc.hli import Hli, Inputs, unknown_element
from axisrig.kernel.cosim.fmi import journal
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

_HINT = "a class with cycle(self, inputs, hli), see docs/plc.md"


class PlcProgram:
    """The one class of a file that has a method `cycle`, made without arguments.

    Its attributes, all optional: `probe_on` (the supply of the switched probe),
    `outlives_program` and `is_idle` (whether the run goes on after the NC program, and until when).
    Where calls into FMUs are watched, so that one may take its time only (--call-timeout), those
    into the program are too. time_ns: of the cycle. Raises UserError with file and line for a file
    that cannot be loaded.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.time_ns: TimeNs = 0
        self._program = self._guarded(self._watched(self._load, "its start"))
        self._cycle = self._watched(self._program.cycle, "cycle")
        self.outlives_program = bool(self._attribute("outlives_program", False))

    def _watched(self, call: Callable[..., Any], name: str) -> Callable[..., Any]:
        return journal.watched(call, str(self._path), "", name, self)

    def _load(self) -> Any:
        text = self._path.read_bytes()
        # Anew for each run, and without a cache: a run must not find what another one has left
        module = ModuleType(f"axisrig_plc_{self._path.stem}")
        module.__file__ = str(self._path)
        sys.modules[module.__name__] = module  # where dataclasses look their types up
        exec(compile(text, str(self._path), "exec"), module.__dict__)
        found = [
            each
            for each in vars(module).values()
            if isinstance(each, type)
            and each.__module__ == module.__name__
            and callable(getattr(each, "cycle", None))
        ]
        if len(found) != 1:
            names = ", ".join(each.__name__ for each in found) or "none"
            raise UserError(
                "the PLC program must have one class with a method cycle",
                file=self._path,
                value=names,
                hint=_HINT,
            )
        self._check_made_without_arguments(found[0], text)
        return found[0]()

    def _check_made_without_arguments(self, program: type, text: bytes) -> None:
        try:
            inspect.signature(program).bind()
        except TypeError as error:
            (written,) = (
                each
                for each in ast.parse(text).body
                if isinstance(each, ast.ClassDef) and each.name == program.__name__
            )
            made = [
                each.lineno
                for each in written.body
                if isinstance(each, ast.FunctionDef) and each.name == "__init__"
            ]
            raise UserError(
                f"the class of the PLC program is made without arguments: {error}",
                file=self._path,
                line=made[-1] if made else written.lineno,
                value=program.__name__,
                hint="give each parameter a value of its own",
            ) from error

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Run one cycle. Raises UserError with file and line for an exception of the program, and
        for a `cycle` that gives something back, as one with yield or async does in place of acting.
        """
        self.time_ns = inputs.time_ns
        given = self._guarded(lambda: self._cycle(inputs, hli))
        if given is not None:
            if inspect.iscoroutine(given):
                given.close()
            raise UserError(
                "cycle of the PLC program gives something back",
                file=self._path,
                line=self._line_of_cycle(),
                value=type(given).__name__,
                hint="end it without a value, and without yield or async",
            )
        self._guarded(hli.check)

    @property
    def probe_on(self) -> bool:
        """Whether the program switches the supply of the probe on."""
        return bool(self._attribute("probe_on", True))

    @property
    def is_idle(self) -> bool:
        """Whether the program has nothing left to do after the NC program."""
        return bool(self._attribute("is_idle", True))

    def _attribute(self, name: str, otherwise: bool) -> Any:
        return self._guarded(lambda: getattr(self._program, name, otherwise))

    def _guarded(self, action: Callable[[], Any]) -> Any:
        try:
            return action()
        except UserError as error:
            if error.file is None:
                error.file, error.line = str(self._path), self._line(error)
            raise
        except (Exception, SystemExit) as error:  # sys.exit ends the run, not axisrig
            raise self._blamed(error) from error

    def _blamed(self, error: BaseException) -> UserError:
        line = self._line(error)
        if isinstance(error, SyntaxError) and error.filename == str(self._path):
            line = error.lineno  # else it is of a text that the program has read
        if isinstance(error, UnknownNameError):
            return UserError(
                f"the PLC program asks for an unknown {error.what}",
                file=self._path,
                line=line,
                value=error.name,
                allowed=error.known or "none",
            )
        if isinstance(error, AttributeError) and (unknown := unknown_element(error)) is not None:
            unknown.file, unknown.line = str(self._path), line
            return unknown
        return UserError(
            f"the PLC program has failed: {type(error).__name__}: {error}",
            file=self._path,
            line=line,
        )

    def _line_of_cycle(self) -> int | None:
        code = getattr(self._program.cycle, "__code__", None)
        return None if code is None else code.co_firstlineno

    def _line(self, error: BaseException) -> int | None:
        """Return the innermost line of the program that an exception went through."""
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if Path(frame.filename) == self._path]
        return lines[-1] if lines else None
