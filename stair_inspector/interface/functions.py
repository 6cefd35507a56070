"""The functions of the interface: each hands on to a room below, with settings that may be given as keywords."""

import os
from collections.abc import Iterable, Mapping
from typing import Any

from stair_inspector import codes, pipeline
from stair_inspector.codes import Decision, RuleSet, overlaid
from stair_inspector.codes.findings import DECISIONS
from stair_inspector.comparison.compare import compare_scans
from stair_inspector.declarations import fields_of
from stair_inspector.errors import ConfigError, brief, one_of
from stair_inspector.files.paths import as_path, path_text
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.files.scans import read_scan
from stair_inspector.files.settings import DEFAULT_PRESET, find_preset
from stair_inspector.files.simulations import truth_of, write_simulation
from stair_inspector.files.toml import check_keys
from stair_inspector.interface.results import StairCheck, StairComparison, StairInspection
from stair_inspector.model import Scan
from stair_inspector.params import SETTINGS, FileReading, Params
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.specs import Stair

Rules = str | os.PathLike[str] | RuleSet
"""A rule set: its id, its file, or itself."""
KEYWORDS = {name.replace(".", "_"): name for name in SETTINGS}
"""Each setting by its keyword: ``levels_eps_m`` for ``levels.eps_m``."""


def measure(
    path: str | os.PathLike[str], params: Params | None = None, *, preset: str | os.PathLike[str] = "", **settings: Any
) -> StairInspection:
    """Read a scan and measure its staircase.

    Parameters
    ----------
    path : path
        A cloud or a mesh of any format that is read; see ``read_scan``.
    params : Params, optional
        All settings at once.
    preset : str or path
        Name of a preset, as ``tls``, or a TOML file, in place of ``params``.
    **settings
        Single settings, which change those of ``params`` or the preset. A keyword is a setting's name with its group
        before it: ``method="paper"``, ``unit="mm"``, ``levels_eps_m=0.015`` for ``--levels.eps-m``. Lengths are
        metres and angles degrees, as the names say.

    Returns
    -------
    StairInspection
        Without steps where there is no staircase; its notes say why.

    Raises
    ------
    ReadError
        The file is missing, damaged or of no known format.
    ConfigError
        A setting is unknown, of the wrong type or out of range, or does not fit the scan.
    CannotMeasure
        The scan is too small, has no floor, or falls into too many levels.

    Examples
    --------
    >>> import stair_inspector as si
    >>> si.measure("stair.ply", preset="tls", levels_eps_m=0.015)
    <StairInspection of stair.ply: 4 steps in 1 flight, by survey>
    >>> si.measure("stair.ply", levels_eps=0.015)
    Traceback (most recent call last):
    ...
    stair_inspector.errors.ConfigError: settings: unknown setting 'levels_eps'; did you mean 'levels_eps_m'?
    """
    chosen = _params_of(params, preset, settings)
    scan = read_scan(as_path(path, "a scan, or give what read_scan returned to inspect"), *chosen.reading)
    return StairInspection(scan, pipeline.inspect(scan, chosen))


def inspect(
    scan: Scan, params: Params | None = None, *, preset: str | os.PathLike[str] = "", **settings: Any
) -> StairInspection:
    """Measure the staircase in a scan that was read before.

    Parameters
    ----------
    scan : Scan
        As ``read_scan`` gives it.
    params, preset, **settings
        As of ``measure``, but for those with which a file is read, as ``unit``: give them to ``read_scan``.

    Raises
    ------
    ConfigError
        A setting is unknown, of the wrong type or out of range, or does not fit the scan.
    CannotMeasure
        The scan is too small, has no floor, or falls into too many levels.

    Examples
    --------
    >>> import stair_inspector as si
    >>> scan = si.read_scan("stair.ply")
    >>> scan.points.shape[1], scan.unit
    (3, 'm')
    >>> si.inspect(scan, method="paper")
    <StairInspection of stair.ply: 4 steps, by the paper's method>
    """
    if not isinstance(scan, Scan):
        raise ConfigError(f"inspect: got {brief(scan)}; give a scan as read_scan returns it, or a path to measure")
    late = [name for name in settings if name in FileReading._fields]
    if late:
        raise ConfigError(f"{late[0]}: is taken when the file is read; give it to read_scan or measure")
    return StairInspection(scan, pipeline.inspect(scan, _params_of(params, preset, settings)))


def check(
    found: StairInspection,
    rules: Rules,
    *,
    overlays: Rules | Iterable[Rules] = (),
    decision: Decision = "guarded",
) -> StairCheck:
    """Hold every value against a rule set, as ``stair-inspector check`` does.

    Parameters
    ----------
    found : StairInspection
        As ``measure`` or ``inspect`` returns it.
    rules
        Id of a rule set that comes with the program (``stair-inspector rules`` lists them), or a TOML file.
    overlays
        Rules to be held against beside those of the set: one, or several.
    decision : str
        ``guarded``: a value nearer to its limit than its uncertainty is called close; ``simple``: the value decides.

    Raises
    ------
    ConfigError
        No such rule set or decision, or a file that is none.

    Examples
    --------
    >>> import stair_inspector as si
    >>> checked = si.check(si.measure("stair.ply", preset="tls"), "us-irc-2024")
    >>> checked.is_outside, checked.is_judged
    (False, True)
    >>> si.check(checked.found, "us-irc-2042")
    Traceback (most recent call last):
    ...
    stair_inspector.errors.ConfigError: rules: unknown rule set 'us-irc-2042'; did you mean 'us-irc-2024'?
    """
    if not isinstance(found, StairInspection):
        raise ConfigError(f"check: got {brief(found)}; give an inspection as measure or inspect returns it")
    rule_set = _rule_set_of(rules)
    for overlay in _several(overlays):
        rule_set = overlaid(rule_set, _rule_set_of(overlay))
    decided = one_of(decision, DECISIONS, "decision")
    return StairCheck(found, codes.check(found.inspection, rule_set, "simple" if decided == "simple" else "guarded"))


def compare(before: StairInspection, after: StairInspection) -> StairComparison:
    """Compare two inspections of one stair, as ``stair-inspector compare`` does.

    Parameters
    ----------
    before, after : StairInspection
        As ``measure`` or ``inspect`` returns them, by survey; the scans may lie anywhere to each other.

    Returns
    -------
    StairComparison
        The later scan is laid onto the earlier one on what did not move.

    Raises
    ------
    ConfigError
        What was given is no inspection, or one by the paper's method.
    CannotMeasure
        Another stair, too little in common, or a question open in one of the scans.

    Examples
    --------
    >>> import stair_inspector as si
    >>> found = si.measure("stair.ply", preset="tls")
    >>> si.compare(found, found).changed
    ()
    """
    for given in (before, after):
        if not isinstance(given, StairInspection):
            raise ConfigError(f"compare: got {brief(given)}; give inspections as measure or inspect returns them")
    return StairComparison(compare_scans(before.scan, before.inspection, after.scan, after.inspection))


def simulate(path: str | os.PathLike[str], *, profile: str = "none", **settings: Any) -> dict[str, Any]:
    """Scan a staircase of known geometry with a simulated scanner; write the scan and its truth.

    Parameters
    ----------
    path : path
        The PLY to write; the truth goes to ``STEM.truth.json`` beside it.
    profile : str
        Scanner to start from, as ``tls_good``; ``none`` takes the defaults.
    **settings
        Of the staircase and of the scanner, by the names of ``stair-inspector simulate --help`` without their group:
        ``n_risers=12`` for ``--stair.n-risers``, ``noise_m=0.002`` for ``--scanner.noise-m``. Lengths are metres,
        angles degrees.

    Returns
    -------
    dict
        The truth, schema ``stair-inspector/truth-1``: lengths in metres, ``steps`` from bottom to top.

    Raises
    ------
    ConfigError
        Unknown profile or setting, a value out of range, a name that does not end in ``.ply``, or a scanner that sees
        nothing.
    WriteError
        A file cannot be written.

    Examples
    --------
    >>> import stair_inspector as si
    >>> truth = si.simulate("known.ply", n_risers=3, rise_m=0.165, spacing_m=0.03)
    >>> [step["rise_m"] for step in truth["steps"]]
    [0.165, 0.165, 0.165]
    """
    from stair_inspector.simulation.scanner import scan
    from stair_inspector.simulation.staircase import build

    target = as_path(path, "the PLY to be written")
    scanner = Scanner() if profile == "none" else PROFILES[one_of(profile, PROFILES, "profile")]
    of_stair, of_scanner = fields_of(Stair), fields_of(Scanner)
    check_keys("simulate", settings, [*of_stair, *of_scanner], "setting")
    stair = Stair(**_those_of(of_stair, settings))
    simulated = scan(build(stair), Scanner(**(vars(scanner) | _those_of(of_scanner, settings))))
    write_simulation(target, simulated)
    return truth_of(simulated)


def _those_of(names: Iterable[str], settings: Mapping[str, Any]) -> dict[str, Any]:
    return {name: settings[name] for name in names if name in settings}


def _params_of(params: Params | None, preset: str | os.PathLike[str], settings: Mapping[str, Any]) -> Params:
    """Return the settings of a call: all at once or a preset, and then the single ones."""
    is_named = preset is not None and not (isinstance(preset, str) and not preset)
    name = path_text(preset, "a preset, or its name") if is_named else DEFAULT_PRESET
    if params is not None and is_named:
        raise ConfigError("settings: got params and preset, which both state every setting; give one of them")
    if params is not None and not isinstance(params, Params):
        raise ConfigError(f"params: got {brief(params)}; give Params, or settings as keywords")
    chosen = find_preset(name).params if params is None else params
    check_keys("settings", settings, KEYWORDS, "setting")
    for keyword, value in settings.items():
        chosen = chosen.replaced(KEYWORDS[keyword], value)
    return chosen


def _several(overlays: Rules | Iterable[Rules]) -> Iterable[Rules]:
    if isinstance(overlays, (str, os.PathLike, RuleSet)):
        return (overlays,)
    if not isinstance(overlays, Iterable):
        raise ConfigError(f"overlays: got {brief(overlays)}; give rule sets, or () for none")
    return overlays


def _rule_set_of(rules: Rules) -> RuleSet:
    return rules if isinstance(rules, RuleSet) else find_rule_set(path_text(rules, "a rule set, or its id"))
