"""Measure staircases in 3-D scans: the paper's method, exact, and a survey of real stairs beside it.

``import stair_inspector as si``, then ``si.measure(path).table()``. A name is looked up where it is declared when it is
first asked for, so that the import itself takes no time.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stair_inspector.codes import Check as Check
    from stair_inspector.codes import RuleSet as RuleSet
    from stair_inspector.errors import CannotMeasure as CannotMeasure
    from stair_inspector.errors import ConfigError as ConfigError
    from stair_inspector.errors import MissingLibrary as MissingLibrary
    from stair_inspector.errors import ReadError as ReadError
    from stair_inspector.errors import StairError as StairError
    from stair_inspector.errors import WriteError as WriteError
    from stair_inspector.files.scans import read_scan as read_scan
    from stair_inspector.interface.functions import check as check
    from stair_inspector.interface.functions import compare as compare
    from stair_inspector.interface.functions import inspect as inspect
    from stair_inspector.interface.functions import measure as measure
    from stair_inspector.interface.functions import simulate as simulate
    from stair_inspector.interface.plain_table import PlainTable as PlainTable
    from stair_inspector.interface.results import StairCheck as StairCheck
    from stair_inspector.interface.results import StairComparison as StairComparison
    from stair_inspector.interface.results import StairInspection as StairInspection
    from stair_inspector.model import Inspection as Inspection
    from stair_inspector.model import Measured as Measured
    from stair_inspector.model import Scan as Scan
    from stair_inspector.params import Params as Params

__version__ = "0.1.0"
_NAMES = {
    "codes": ("Check", "RuleSet"),
    "errors": ("CannotMeasure", "ConfigError", "MissingLibrary", "ReadError", "StairError", "WriteError"),
    "files.scans": ("read_scan",),
    "interface.functions": ("check", "compare", "inspect", "measure", "simulate"),
    "interface.plain_table": ("PlainTable",),
    "interface.results": ("StairCheck", "StairComparison", "StairInspection"),
    "model": ("Inspection", "Measured", "Scan"),
    "params": ("Params",),
}
"""The names of the interface by the module that declares them."""
_MODULE_OF = {name: module for module, names in _NAMES.items() for name in names}
__all__ = sorted(_MODULE_OF)


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
    # Next time Python finds it without coming here.
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
