"""What a SERCOS drive says of itself before anybody speaks to it."""

from axisrig.bench.drive.ethercat.description import Description, Entry, Pdo, managers_of
from axisrig.bench.drive.sercos.profiles import SercosProfile
from axisrig.kernel.profiles.sercos.service import ident_name, ident_number
from axisrig.kernel.profiles.sercos.words import (
    CONTROL_WORD,
    STATUS_WORD,
    WORD_BITS,
    telegram_idents,
)

MDT, AT = 0x0018, 0x0010
"""What masters that think in PDOs take for their indices."""
_WORD_TYPE, _VALUE_TYPE = 0x0006, 0x0004
DEFAULT_AT, DEFAULT_MDT = ("S-0-0051",), ("S-0-0047",)


def describe(profile: SercosProfile, serial: int, mailbox_bytes: int) -> Description:
    """Describe a drive as it is at power on."""
    mdt = _telegram(MDT, "MDT", CONTROL_WORD, DEFAULT_MDT, 2)
    at = _telegram(AT, "AT", STATUS_WORD, DEFAULT_AT, 3)
    return Description(
        serial,
        managers_of(mailbox_bytes, mdt.size, at.size),
        (mdt,),
        (at,),
        product=profile.product,
        order=f"SERCOS {profile.product}",
        name="axisrig SERCOS drive",
        is_sercos=True,
        coe=(),
    )


def _telegram(index: int, name: str, word: int, idents: tuple[str, ...], manager: int) -> Pdo:
    entries = [Entry(word, 1, WORD_BITS, _WORD_TYPE, ident_name(word))]
    for ident in idents:
        number = ident_number(ident)
        bits = 8 * telegram_idents()[number].bytes
        entries.append(Entry(number, 1, bits, _VALUE_TYPE, ident))
    return Pdo(index, name, manager, tuple(entries))
