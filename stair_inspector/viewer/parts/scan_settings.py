"""Settings that a scan comes to in one press: those of its last session, those that are suggested, the server's own."""

import dataclasses

from stair_inspector.errors import ConfigError
from stair_inspector.params import Params
from stair_inspector.stages.suggest import Suggestion, suggest_settings
from stair_inspector.viewer.parts.part import Context


def of_scan(params: Params, preset: Params) -> Params:
    """Return a preset's settings with what belongs to the scan and not to a kind of scanner."""
    return dataclasses.replace(preset, overrules=params.overrules, up=params.up, **params.reading._asdict())


class ScanSettings:
    """Takes settings for the scan that is open, each in one change that can be undone."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._editor = context.editor
        self._keeper = context.keeper
        self._making = context.making

    def suggest(self) -> Suggestion:
        """Return what is proposed from the heights of the scan, and why.

        Raises
        ------
        ConfigError
            There is no result yet, or nothing can be proposed.
        """
        self._desk.result("suggest settings")
        heights = self._desk.heights
        if heights is None:
            raise ConfigError("suggest settings: the scan is not prepared yet; wait for the first result")
        return self._making.make("the suggestion", lambda _: suggest_settings(heights, self._editor.work.params))

    def take_suggested(self, suggestion: Suggestion) -> None:
        """Use what was proposed."""

        def take(params: Params) -> Params:
            for reason in suggestion.reasons:
                params = params.replaced(reason.name, suggestion.params.value(reason.name))
            return params

        self._editor.adjust(take, "suggested settings")

    def take_last(self) -> None:
        """Use the settings that the last session left this scan with; its overrules stay.

        Raises
        ------
        ConfigError
            No session before this one has worked on the scan.
        """
        last = self._keeper.last
        if last is None:
            raise ConfigError(
                f"as last time: no saved work of an earlier session on {self._keeper.label} was taken up; "
                "choose a preset, or As suggested"
            )
        self._editor.adjust(lambda params: dataclasses.replace(last, overrules=params.overrules), "as last time")

    def take_started(self) -> None:
        """Use the settings that the server was started with; what belongs to the scan stays."""
        self._editor.adjust(lambda params: of_scan(params, self._editor.started), "settings as started")
