"""Section of the report about distance control: words, tables, signals, tool over surface."""
