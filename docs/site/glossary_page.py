"""Makes docs/glossary.md from docs/glossary.csv: `python docs/site/glossary_page.py`."""

import csv
from pathlib import Path

DOCS = Path(__file__).parents[1]
HEAD = """# Glossary

Made from `docs/glossary.csv` by `python docs/site/glossary_page.py`; a test keeps it equal to the
table. The report shows the same words. *Object*: CANopen index ([drive.md](drive.md),
[drive-communication.md](drive-communication.md)) or parameter ([parameters.md](parameters.md)).
*German*: the word that CNC manuals use.

| term | meaning | unit | object | German |
|---|---|---|---|---|
"""


def page() -> str:
    """Return the text of docs/glossary.md."""
    with (DOCS / "glossary.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    lines = []
    for term, meaning, unit, objects, german in rows:
        codes = " ".join(f"`{code}`" for code in objects.split())
        lines.append(f"| {term} | {meaning} | {unit} | {codes} | {german} |".replace("  ", " "))
    return HEAD + "\n".join(lines) + "\n"


if __name__ == "__main__":
    (DOCS / "glossary.md").write_text(page(), encoding="utf-8")
