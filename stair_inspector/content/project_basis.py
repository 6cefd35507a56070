"""What a project keeps for its report and of its findings, as values: read strictly wherever a project is opened."""

import dataclasses
from collections.abc import Callable
from typing import TypeVar

from stair_inspector.content.basis_files import basis_from_dict
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.pin_values import pinned_from_dict
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.errors import ConfigError
from stair_inspector.files.projects import Project

_Kept = TypeVar("_Kept")


def basis_of(project: Project, place: str = "") -> ReportBasis:
    """Return what the user gave for the report of a project; ``place`` names its file, for the messages.

    Raises
    ------
    ConfigError
        Unknown keys, or values that are not possible.
    """
    return _read(lambda: basis_from_dict(dict(project.report)), place, "report")


def pinned_of(project: Project, place: str = "") -> PinnedFindings:
    """Return the pins of a project and what was said of findings; ``place`` names its file, for the messages.

    Raises
    ------
    ConfigError
        Unknown keys, or values that are not possible.
    """
    return _read(lambda: pinned_from_dict(dict(project.findings)), place, "findings")


def titled(basis: ReportBasis, title: str) -> ReportBasis:
    """Return the basis whose report bears the inspection's title, unless the fields have one of their own."""
    fields: ReportFields = basis.fields
    return basis if fields.title else dataclasses.replace(basis, fields=dataclasses.replace(fields, title=title))


def _read(read: Callable[[], _Kept], place: str, what: str) -> _Kept:
    try:
        return read()
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}" if place else str(error)) from error
    except RecursionError as error:
        # What JSON's reader just manages may be too deep for the message that shows it.
        raise ConfigError(f"{place or what}: is nested too deeply; give another file") from error
