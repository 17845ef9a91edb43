"""Changes of the text of an EDS."""

import re


def changed(text: str, section: str, **keys: str) -> str:
    """Set keys of a section; a key that is not there is added."""
    begin = text.index(f"[{section}]\n")
    end = text.find("\n[", begin) + 1 or len(text)
    body = text[begin:end].rstrip("\n")
    for key, value in keys.items():
        body, count = re.subn(rf"(?m)^{key}=.*$", f"{key}={value}", body)
        body += "" if count else f"\n{key}={value}"
    return f"{text[:begin]}{body}\n\n{text[end:]}"


def without(text: str, *indices: str) -> str:
    """Take out objects by the begin of their index, with all their sub-indices."""
    parts = re.split(r"(?m)^(?=\[)", text)
    return "".join(part for part in parts if not part.startswith(tuple(f"[{i}" for i in indices)))
