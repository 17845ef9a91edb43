"""The report generator: a results folder in, one self-contained HTML page out."""
