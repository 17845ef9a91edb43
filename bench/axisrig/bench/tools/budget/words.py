"""A budget in lines for a reader and as a table."""

from axisrig.bench.tools.budget.budget import Budget, Share
from axisrig.reports.budget.section import COLUMNS, COMBINED, DIFFERS, TERM

LEFT = "left with all causes off"


def budget_lines(budget: Budget) -> list[str]:
    """Say a budget in lines: a table of the causes, their sum, and the largest."""
    is_combined = bool(budget.interacting)
    mean = f" {'mean um':>11}" if is_combined else ""
    lines = [
        f"{budget.run}, axis {budget.axis}: published value {budget.error_um:+z.4f} um from the"
        f" contact, at {abs(budget.velocity_mm_s):g} mm/s towards"
        f" {'smaller' if budget.velocity_mm_s < 0 else 'larger'} positions",
        "",
        f"{'cause':<20} {'setting':<44} {'alone um':>10} {'in turn um':>11} {'closed form um':>15}"
        f"{mean}",
    ]
    lines += [_line(budget, share) for share in budget.shares]
    total_um = sum(share.in_turn_um for share in budget.shares)
    lines += [
        f"{'all causes':<65} {'':>10} {total_um:>+z11.4f}",
        f"{LEFT:<65} {'':>10} {budget.left_um:>+z11.4f}",
        "",
    ]
    if not budget.is_explained:
        lines.append(not_explained(budget))
    largest = budget.largest
    lines.append(
        f"largest: {largest.cause.cause}, {largest.cause.meaning} ({largest.setting})"
        if largest
        else f"no cause is larger than an increment ({budget.increment_um:.4f} um)"
    )
    if budget.differing:
        names = ", ".join(share.cause.cause for share in budget.differing)
        lines.append(f"differs from its closed form, by more than 1 % and an increment: {names}")
    if is_combined:
        names = ", ".join(share.cause.cause for share in budget.interacting)
        lines.append(
            f"these act on each other, more than an increment; mean = over all orders: {names}"
        )
    return lines + left_out_notes(budget)


def left_out_notes(budget: Budget) -> list[str]:
    """Say which causes were not switched off, or not in combination."""
    notes = []
    if budget.kept_on:
        notes.append(f"not switched off, as there is no value without: {', '.join(budget.kept_on)}")
    if budget.not_combined:
        names = ", ".join(budget.not_combined)
        notes.append(f"not combined, only in turn; --combinations allows more runs: {names}")
    return notes


def _line(budget: Budget, share: Share) -> str:
    form = "" if share.expected_um is None else f"{share.expected_um:+z.4f}"
    if share.bound_um is not None:
        form = f"+- {share.bound_um:.4f}"
    mean = "" if share.combined_um is None else f" {share.combined_um:>+z11.4f}"
    differs_um = share.differs_um(budget.increment_um)
    mark = "" if differs_um is None else f"  differs by {differs_um:+z.4f}"
    return (
        f"{share.cause.cause:<20} {share.setting:<44} {share.alone_um:>+z10.4f}"
        f" {share.in_turn_um:>+z11.4f} {form:>15}{mean}{mark}"
    )


def not_explained(budget: Budget) -> str:
    """Say what is left and against what; empty where all is explained."""
    if budget.is_explained:
        return ""
    what = "an increment"
    if budget.quantum_um > budget.increment_um:
        what = "the way in a cycle of the PLC and one of the CNC"
    return (
        f"not explained: {budget.left_um:+z.4f} um are left with all causes off, more than {what}"
        f" ({max(budget.quantum_um, budget.increment_um):.4f} um): something acts that is none of"
        " the causes"
    )


def budget_table(budget: Budget) -> list[dict[str, object]]:
    """Return the table of a budget, a row for each cause and one for what is left."""
    of_run: dict[str, object] = {"run": budget.run, "axis": budget.axis}
    rows: list[dict[str, object]] = [
        {
            **of_run,
            "cause": share.cause.cause,
            "setting": share.setting,
            "effect": share.cause.effect,
            "alone_um": share.alone_um,
            "in_turn_um": share.in_turn_um,
            "closed_form_um": share.expected_um,
            "bound_um": share.bound_um,
            "meaning": share.cause.meaning,
            "frame_log_sha256": budget.frame_log_sha256,
            TERM: share.cause.term,
            COMBINED: share.combined_um,
            DIFFERS: share.differs_um(budget.increment_um),
        }
        for share in budget.shares
    ]
    left: dict[str, object] = dict.fromkeys((*COLUMNS, TERM, COMBINED, DIFFERS))
    left |= {**of_run, "cause": LEFT}
    left["meaning"] = "; ".join(filter(None, [not_explained(budget), *left_out_notes(budget)]))
    left |= {"in_turn_um": budget.left_um, "frame_log_sha256": budget.frame_log_sha256}
    return [*rows, left]
