"""Which segment of a rig each channel of a log is."""

from collections.abc import Callable, Mapping, Sequence

from axisrig.kernel.errors import UserError


def given_channels(words: Sequence[str]) -> dict[str, str]:
    """Read `can0=can1`. Raises UserError for another form, or a channel that is given twice."""
    found: dict[str, str] = {}
    for word in words:
        channel, mark, segment = (part.strip() for part in word.partition("="))
        if not (channel and mark and segment):
            allowed = "CHANNEL=SEGMENT, as in can0=can1"
            raise UserError(
                "--segment: which channel is which segment?", value=word, allowed=allowed
            )
        if channel in found:
            raise UserError("--segment: the channel is given twice", value=word)
        found[channel] = segment
    return found


class Channels:
    """What a rig calls the channels of a log.

    segments: of the rig, in its order; empty without a rig. given: channel -> segment, as the user
    says it. all_of_log: returns all channels of the log, which takes a reading of its own.
    """

    def __init__(
        self,
        segments: Sequence[str],
        given: Mapping[str, str],
        all_of_log: Callable[[], set[object]],
    ) -> None:
        """Raises UserError for a segment that the rig does not have."""
        wrong = [name for name in given.values() if segments and name not in segments]
        if wrong:
            text = "--segment: no segment of the rig that such a log is of"
            raise UserError(text, value=wrong[0], allowed=segments)
        self._segments = list(segments)
        self._left = dict(given)
        self._given = given
        self._all_of_log = all_of_log
        self._found: dict[object, str] = {}
        self._notes: list[str] = []

    def segment(self, channel: object) -> str:
        """Return the name of a segment; logs with numbers count from 0 in the order of the rig.

        The only channel of a log is the only segment of a rig. Any other one keeps its name: it is
        of another rig, or of a tool that counts otherwise.
        """
        found = self._found.get(channel)
        if found is None:
            found = self._found[channel] = self._find(channel)
        return found

    def notes(self) -> list[str]:
        """Return what was assumed, or not known, since the last call."""
        notes, self._notes = self._notes, []
        return notes

    @property
    def unused(self) -> list[str]:
        """Channels that were given, and that the log does not have."""
        return list(self._left)

    def _find(self, channel: object) -> str:
        name = "" if channel is None else str(channel)
        if name in self._given:
            self._left.pop(name, None)
            return self._given[name]
        if isinstance(channel, int) and 0 <= channel < len(self._segments):
            return self._segments[channel]
        if not self._segments or name in self._segments:
            return name
        if len(self._segments) == 1:
            (only,) = self._segments
            if channel is None:
                return only
            # A BLF of channel 0, which counts as -1 here, is of any channel
            is_one = not (isinstance(channel, int) and channel < 0)
            if is_one and len(self._all_of_log()) == 1:
                self._notes.append(f"channel {name} of the log is taken for segment {only}")
                return only
        names = ", ".join(self._segments)
        self._notes.append(
            f"channel {name or 'without a name'} of the log is no segment of the rig ({names});"
            f" --segment {name or 'NAME'}={self._segments[0]} says which one it is"
        )
        return name
