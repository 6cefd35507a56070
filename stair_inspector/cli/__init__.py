"""The command line: the only room that prints and exits.

A file per command, each with ``run(args) -> exit code``; ``arguments`` and ``headless`` are what they share, ``output``
is how they print. A command is imported when it is called, and what is slow to import inside the functions that need
it. To add a command, add its file, and its name to :data:`COMMANDS` and to the usage below.
"""

import importlib
import io
import sys
import traceback
from collections.abc import Callable, Sequence

from stair_inspector import __version__
from stair_inspector.cli.output import internal_words, report_error
from stair_inspector.errors import CannotMeasure, ConfigError, StairError

COMMANDS = ("view", "measure", "check", "compare", "verify", "rules", "simulate", "presets", "quantities", "completion")

_USAGE = """\
usage: stair-inspector [COMMAND] [OPTIONS]

Measures staircases in 3-D scans (PLY, PCD, LAS, LAZ, E57, PTX, XYZ, PTS, CSV, NPY; meshes: PLY, OBJ, STL, OFF, GLB).

commands:
  view SCAN ...             the web inspector; without a SCAN, or without any command, a bundled sample scan
  measure SCAN ... -o DIR   headless: DIR/STEM.json, STEM.csv and STEM_debug.ply for every scan;
                            with --project FILE the numbers of a project saved by the web inspector;
                            with --report the survey report as PDF, HTML and XLSX, and drawings as DXF
  check SCAN ... --rules ID measure, then hold every value against a rule set; -o DIR writes the files of measure too
  compare BEFORE AFTER      what changed between two scans of one stair, beyond the uncertainty of both;
                            -o DIR writes DIR/BEFORE_AFTER_comparison.json and .csv
  verify DIR                whether the results in a folder belong together, or what was changed since
  rules                     list the rule sets; --show ID prints one, --toml ID its file, to copy and change
  simulate OUT.ply          a scan of a known staircase by a simulated scanner, and OUT.truth.json
  presets                   list the presets
  quantities                list what is measured: names, units, definitions, terms of building codes
  completion                print what bash needs to complete all this

  stair-inspector COMMAND --help lists a command's options; --version prints the version.

exit codes: 0 done; 1 check found a value outside a limit, or verify files that do not belong together;
            2 wrong usage or settings, or an output that cannot be written;
            3 a scan could not be read or measured, nothing in it be judged, or two be compared (the others are done)
            0 from check is no pass by itself: values that were not measured are listed as such
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; by default those of the process.

    Returns
    -------
    int
        Exit code: 0 done; 1 a value outside a limit, or results that do not belong together; 2 wrong usage, settings
        or output folder; 3 a scan could not be read, measured or judged.
    """
    args = list(sys.argv[1:] if argv is None else argv)
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A file name or a degree sign that the terminal cannot show must not end the program.
        sys.stdout.reconfigure(errors="backslashreplace")
    if args and args[0] in ("-h", "--help"):
        print(_USAGE, end="")
        return 0
    if args and args[0] == "--version":
        print(f"stair-inspector {__version__}")
        return 0
    # Without a command, options are those of view.
    name = "view" if not args or args[0].startswith("-") else args.pop(0)
    try:
        if name not in COMMANDS:
            raise ConfigError(f"{name[:60]!r} is no command; give one of {', '.join(COMMANDS)} (see --help)")
        run: Callable[[list[str]], int] = importlib.import_module(f"{__name__}.{name}").run
        return run(args)
    except StairError as error:
        if "--debug" in args:
            traceback.print_exc()
        return report_error(error)
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # noqa: BLE001 - whatever it is, the user gets one line
        if "--debug" in args:
            traceback.print_exc()
        return report_error(CannotMeasure(f"{internal_words(error)}; run again with --debug and report what it prints"))
