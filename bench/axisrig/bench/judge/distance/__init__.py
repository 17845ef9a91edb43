"""What a finished run shows of distance control, beside what closed forms expect of it."""
