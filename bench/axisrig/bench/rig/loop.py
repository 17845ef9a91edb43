"""What a list says of a position loop that is closed outside of the position loop of a drive."""

from typing import Final

from axisrig.bench.rig.settings import Settings
from axisrig.kernel.parameters import Origin

KV: Final = "getriebe[0].kv"
OF_LOOP: Final = (
    KV, "vorsteuer.vorsteuerung", "vorsteuer.vs_v_faktor", "vorsteuer.vs_v_nenner",
    "vorsteuer.default_active", "vorsteuer.global_disable",
)  # fmt: skip
"""Parameters of such a loop."""
_SPEED_FORWARD: Final = 0x001  # of P-AXIS-00223


def kv_per_s(settings: Settings, name: str) -> float:
    """Return the gain of the loop, P-AXIS-00099."""
    return settings.axis[name].integer(KV) / 100


def feed_forward(settings: Settings, name: str) -> float:
    """Return the share of the set speed that is fed forward (P-AXIS-00223, 00228, 00229, 00255).

    G135 to G137 are no words of this version, so that it is on by P-AXIS-00255 only.
    """
    parameters = settings.axis[name]
    is_on = parameters.flag("vorsteuer.default_active") and not parameters.flag(
        "vorsteuer.global_disable"
    )
    if not (is_on and parameters.integer("vorsteuer.vorsteuerung") & _SPEED_FORWARD):
        return 0.0
    numerator, denominator = (
        parameters.integer(f"vorsteuer.vs_v_{part}") for part in ("faktor", "nenner")
    )
    return numerator / denominator


def check_gain(
    settings: Settings, name: str, limit: float, dead: float, period_s: float, where: str, hint: str
) -> None:
    """Refuse a gain at which a loop is unstable. Raises UserError.

    limit: of Kv T. dead: dead cycles. period_s: T. where: who closes the loop.
    """
    gain = kv_per_s(settings, name) * period_s
    if gain < limit:
        return
    place = settings.axis[name].origin(KV) or Origin(KV)
    raise place.error(
        f"axis {name}: the position loop of the {where} is unstable with Kv ="
        f" {gain / period_s:g} 1/s (P-AXIS-00099): Kv T is {gain:.4g} and must be below"
        f" {limit:.4g} with {dead:.4g} dead cycles",
        value=settings.axis[name].integer(KV),
        allowed=f"below {limit / period_s * 100:.6g} 0.01/s",
        hint=hint,
    )
