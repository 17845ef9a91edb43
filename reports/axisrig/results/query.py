"""`axisrig query`: SQL over a results folder."""

import pandas as pd

from axisrig.kernel.errors import UserError
from axisrig.results.loading import Results

TABLES = ("cases", "checks", "signals")


def query(results: Results, sql: str) -> pd.DataFrame:
    """Carry out one statement of SQL (DuckDB) and return what it selects.

    Tables: `cases` and `checks` as `Results` has them, `signals` the time series of all runs with
    the column `run`, read as far as the statement needs them. Raises UserError for a statement that
    DuckDB refuses, ImportError without duckdb.
    """
    import duckdb  # noqa: PLC0415 - an extra

    with duckdb.connect(":memory:") as connection:
        for name in ("autoinstall_known_extensions", "autoload_known_extensions"):
            connection.execute(f"set {name} = false")  # nothing comes from the network
        connection.register("cases", results.cases)
        connection.register("checks", results.checks)
        files = [str(path) for path in results.traces().values()]
        if files:
            names = ", ".join(f"'{name.replace(chr(39), chr(39) * 2)}'" for name in files)
            connection.execute(
                "create view signals as select parse_filename(filename, true) as run,"
                " * exclude (filename)"
                f" from read_parquet([{names}], filename = true, union_by_name = true)"
            )
        try:
            found = connection.execute(sql)
            return found.df()
        except duckdb.Error as error:
            first = str(error).strip().splitlines()[0]
            hint = f"tables: {', '.join(TABLES)}; `describe cases` lists the columns of one"
            raise UserError(f"the query was refused: {first}", hint=hint) from error
