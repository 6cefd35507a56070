"""``stair-inspector simulate``: a scan of a known staircase by a simulated scanner, and its truth."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli.arguments import Debug, check_folder, parse_arguments, value_of
from stair_inspector.cli.output import say
from stair_inspector.errors import ConfigError
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.specs import Stair


@dataclass(frozen=True)
class Simulate:
    """Scan a staircase of known geometry with a simulated scanner; write the scan and its truth."""

    out: Annotated[
        tyro.conf.Positional[Path],
        tyro.conf.arg(metavar="OUT"),
        Doc("PLY file to write, with OUT.truth.json beside it; with --samples a folder."),
    ] = tyro.MISSING
    samples: Annotated[
        tyro.conf.FlagCreatePairsOff[bool], Doc("Write the bundled sample scans, bit for bit, into the folder OUT.")
    ] = False
    profile: Annotated[str, Doc("Start from a scanner profile: its name, or 'none' for the scanner's defaults.")] = (
        "none"
    )
    debug: Debug = False
    stair: Stair = field(default_factory=Stair)
    scanner: Scanner = field(default_factory=Scanner)


def run(args: list[str]) -> int:
    """Write a scan and its truth, or the samples; return the exit code."""
    profile = value_of(args, "--profile") or "none"
    if profile != "none" and profile not in PROFILES:
        raise ConfigError(f"--profile: got {profile[:60]!r}; give one of none, {', '.join(PROFILES)}")
    start = Simulate(scanner=PROFILES.get(profile, Scanner()))
    simulate = parse_arguments(Simulate, "simulate", args, start)
    from stair_inspector.files.simulations import simulate_to_file, write_samples

    check_folder(simulate.out if simulate.samples else simulate.out.parent)
    written = write_samples(simulate.out) if simulate.samples else []
    if not simulate.samples:
        written = simulate_to_file(simulate.out, simulate.stair, simulate.scanner)
    say("wrote " + "\n      ".join(str(path) for path in written))
    return 0
