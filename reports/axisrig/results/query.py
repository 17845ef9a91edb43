"""`axisrig query`: SQL over a results folder, and over nothing else."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import pandas as pd

from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError
from axisrig.results.loading import Results

TABLES = ("cases", "checks", "signals")
_SHUT = (
    "set autoinstall_known_extensions = false",  # nothing comes from the network
    "set autoload_known_extensions = false",
    "set python_enable_replacements = false",  # names are tables, never variables of this program
    "set temp_directory = ''",  # what is too large for the memory is not written somewhere else
    "set enable_external_access = false",
    "set lock_configuration = true",
)
"""What a statement may not do, whatever it says. Source: DuckDB, Securing DuckDB."""


def query(results: Results, sql: str) -> pd.DataFrame:
    """Carry out one statement of SQL (DuckDB) and return what it selects.

    Tables: `cases` and `checks` as `Results` has them, `signals` the time series of all runs with
    the column `run`, read as far as the statement needs them. No other file is read, none written.
    Raises UserError for a statement that is none, or that DuckDB refuses, and for a damaged time
    series; ImportError without duckdb.
    """
    import duckdb  # noqa: PLC0415 - an extra

    files = [path.absolute() for path in results.traces().values()]
    with duckdb.connect(":memory:") as connection:
        connection.register("cases", results.cases)
        connection.register("checks", results.checks)
        names = ", ".join(_quoted(str(path)) for path in files)
        if files:
            connection.execute(f"set allowed_paths = [{names}]")
        for text in _SHUT:
            connection.execute(text)
        try:
            _refuse_others(connection.extract_statements, sql, duckdb)
            if files:
                connection.execute(
                    "create view signals as select parse_filename(filename, true) as run,"
                    " * exclude (filename)"
                    f" from read_parquet([{names}], filename = true, union_by_name = true)"
                )
            return connection.execute(sql).df()
        except (duckdb.Error, ValueError, OverflowError) as error:
            _refuse_damaged(files)
            first = str(error).strip().splitlines()[0]
            hint = f"tables: {', '.join(TABLES)}; `describe cases` lists the columns of one"
            raise UserError(f"the query was refused: {first}", hint=hint) from error


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


def _refuse_others(parse: Callable[[str], Sequence[Any]], sql: str, duckdb: Any) -> None:
    """Raise UserError unless there is one statement, which selects.

    parse: cuts a text into statements. A PIVOT looks for the values first: DuckDB 1 makes two
    statements without a text of it, DuckDB 2 one of the kind MULTI, whatever the whole does. What
    selects can stand in brackets as a table, and nothing else can.
    """
    statements, kinds = parse(sql), duckdb.StatementType
    texts = [statement.query for statement in statements if statement.query]
    selects = bool(statements) and statements[-1].type == kinds.SELECT
    if len(texts) == 1 and not selects and statements[-1].type == getattr(kinds, "MULTI", None):
        for text in (texts[0], texts[0].rpartition(";")[0]):
            with suppress(duckdb.Error):
                selects = selects or len(parse(f"from (\n{text}\n)")) == 1
    if len(texts) > 1 or not selects:
        raise UserError(
            "a query is one statement that selects",
            value=" ".join(" ".join(texts).split())[:80] or "nothing",
            hint="axisrig query DIR 'select run, verdict from cases'",
        )


def _refuse_damaged(files: Sequence[Path]) -> None:
    """Raise UserError for the first file that is no time series."""
    for path in files:
        _ = Series(path).names
