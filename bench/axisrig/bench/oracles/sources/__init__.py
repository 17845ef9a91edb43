"""From an edge of a probe to the NC cycle that sees it, over terminal and PLC: closed forms."""
