"""The NC blocks of a run in the report: a table, and a lane over the plots."""
