"""Why there is no closed form."""


class NoClosedFormError(Exception):
    """What must hold for a closed form does not; the text says what."""
