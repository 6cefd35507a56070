"""Is a scan good enough to judge a rule? The largest U that was found against the tolerance."""

import functools
from collections.abc import Sequence

from stair_inspector.codes.findings import FIT_SHARE, Finding, Fit
from stair_inspector.codes.limits import LENGTH_UNITS, LIMIT_UNITS
from stair_inspector.codes.rules import Rule
from stair_inspector.quantities import quantity_of

DIFFERENCES = ("flight_range", "adjacent_difference")
"""Statistics of which what is one error of the whole scan cancels."""
_SIZE_SHARE = 0.1
"""A size is held against this share of its limit, the smaller of two, and against the room between two where that is
less. A convention of this program: the room alone, 3 in for a riser of 4 to 7 in, would call any scan good enough."""


def fit_of(rule: Rule, findings: Sequence[Finding], registration_m: float) -> Fit:
    """Say whether the scan is good enough to judge a rule: its largest U against the tolerance.

    In a difference all that is left is what moves single steps, of which no scan shows its own registration: where
    the user has stated none, a U that looks small enough says nothing.
    """
    doubts = [u for found in findings if (u := found.u if found.u_fit is None else found.u_fit) is not None]
    made = functools.partial(Fit, rule.rule_id, rule.quantity)
    if rule.from_scan == "no":
        return made("not assessed from a scan", None)
    if not doubts:
        return made("nothing was measured or judged", None)
    u = max(doubts)
    if rule.severity == "report_only":
        return made("reported only, U up to {u}", None, u)
    if rule.quantity == "n_risers":
        return made("fit: a count", True, u)
    tolerance = _tolerance(rule)
    if tolerance == 0.0:
        return made("not fit: what is intended lies on the limit, where no measurement decides", False, u, 0.0)
    is_fit: bool | None = u <= FIT_SHARE * tolerance
    words = "U up to {u}; this check needs at most {most}"
    if rule.statistic in DIFFERENCES and LIMIT_UNITS[rule.quantity] == LENGTH_UNITS:
        stated = f"is stated as {1000.0 * registration_m:g} mm" if registration_m else "is not stated"
        words += f"; registration from step to step {stated}"
        if is_fit and not registration_m:
            is_fit = None
    if rule.from_scan == "partly":
        words += "; the scan shows only a part of what the clause limits"
    answer = {True: "fit", False: "not fit", None: "cannot be said"}[is_fit]
    return made(f"{answer}: {words}", is_fit, u, tolerance)


def _tolerance(rule: Rule) -> float:
    """Return what U is held against: the room between the limits, for a size at most a tenth of the smaller limit."""
    low, high = (None if limit is None else limit.value for limit in (rule.minimum, rule.maximum))
    if rule.statistic in DIFFERENCES or not quantity_of(rule.quantity).is_size:
        return (low or 0.0) if high is None else high - (low or 0.0)
    limits = [limit for limit in (low, high) if limit is not None]
    share = _SIZE_SHARE * min(limits)
    return share if low is None or high is None else min(share, high - low)
