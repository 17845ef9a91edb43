"""What the options of `axisrig run` mean for a campaign."""

from typing import TYPE_CHECKING, Any

from axisrig.bench.cli.beside.waiting import Line
from axisrig.bench.cli.options import on_engine
from axisrig.bench.cli.outside import hardware, time_of_day, to_stderr

if TYPE_CHECKING:
    from axisrig.bench.campaign.campaign import Choice
    from axisrig.bench.campaign.hardware_runs import Outside
    from axisrig.bench.campaign.resuming import GoingOn
    from axisrig.bench.campaign.talk import Manner, Talk


def going_on_of(is_resumed: bool, is_failed: bool, is_fresh: bool) -> "GoingOn":
    """Return which runs of the folder stay."""
    from axisrig.bench.campaign.resuming import GoingOn

    return GoingOn.of(is_resumed=is_resumed, is_failed=is_failed, is_fresh=is_fresh)


def manner_of(talk: "Talk", ends_at_first: bool, line: Line, info: list[str] | None) -> "Manner":
    """Return how a campaign goes on, and what is noted of it."""
    from axisrig.bench.campaign.talk import Manner

    return Manner(talk, ends_at_first, line.say, info or (), time_of_day)


def outside_of(may_move: bool, *said: Any) -> "Outside":
    """Return what the options of interfaces mean; `said` as `Outside` takes them."""
    from axisrig.bench.campaign.hardware_runs import Outside

    return Outside(hardware, may_move, to_stderr, *said)


def choice_of(
    select: str | None, shard: str | None, engine: str | None, scheduler: str | None
) -> "Choice":
    """Return which runs a call is about, and who runs them."""
    from axisrig.bench.campaign.campaign import Choice
    from axisrig.bench.campaign.sharing import Shard

    return Choice(select, Shard.of(shard) if shard else None, on_engine(engine, scheduler))


def talk_of(is_quiet: bool, is_verbose: bool) -> "Talk":
    """Return how much is printed of the runs."""
    from axisrig.bench.campaign.talk import Talk

    return Talk.NONE if is_quiet else Talk.ALL if is_verbose else Talk.SHORT
