"""The folder of the Checks tab for a user's own rule files."""

import dataclasses
from pathlib import Path

import viser

from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules, RuleFile, with_fitting, with_set
from stair_inspector.files.rule_sets import rule_set_path
from stair_inspector.files.toml import read_toml_bytes
from stair_inspector.viewer.bridge.widgets import File
from stair_inspector.viewer.parts.checks.rule_choice import RuleChoice
from stair_inspector.viewer.parts.checks.rule_menus import overlays_beside
from stair_inspector.viewer.parts.part import Context


class OwnRules:
    """The folder "Own rule file"."""

    def __init__(self, context: Context, choice: RuleChoice) -> None:
        self._client = context.desk.client
        self._choice = choice
        widgets = context.widgets
        with widgets.folder("Own rule file", is_open=False):
            self.load = widgets.upload(
                "Load a rule file",
                ".toml",
                self.take_file,
                icon=viser.Icon.FOLDER_OPEN,
                hint="A TOML file as those of the program; it is kept in the project.",
            )
            widgets.button(
                "Save the file of this set",
                self.save_copy,
                icon=viser.Icon.DOWNLOAD,
                hint="To copy, change and load; without changes.",
            )
            widgets.button(
                "Forget this own set",
                self.forget_file,
                icon=viser.Icon.TRASH,
                hint="Takes the chosen file of your own out of the menu; can be undone.",
                is_quiet=True,
            )

    def take_file(self, upload: File) -> None:
        """Keep a user's own rule file and choose its set; a file of the same id takes the place of the old one."""
        file = RuleFile.of(str(upload.name), upload.content)
        new = file.rule_set

        def changed(rules: ChosenRules) -> ChosenRules:
            files = (*(each for each in rules.files if each.rule_set.set_id != new.set_id), file)
            newer = dataclasses.replace(rules, files=files)
            if not new.is_overlay:
                return with_set(newer, new.set_id, overlays_beside(newer, new.set_id))
            overlay_ids = (new.set_id,) if rules.set_id else ()
            return with_fitting(dataclasses.replace(newer, overlay_ids=overlay_ids), rules.edits)

        self._choice.change_and_tell(f"rule file {file.name[:40]}", changed)

    def forget_file(self) -> None:
        """Take the chosen own set, or else the chosen own overlay, out of the project."""

        def changed(rules: ChosenRules) -> ChosenRules:
            own = {file.rule_set.set_id for file in rules.files}
            gone = next((set_id for set_id in (rules.set_id, *rules.overlay_ids) if set_id in own), None)
            if gone is None:
                raise ConfigError("forget: the chosen set comes with the program; choose an own one first")
            files = tuple(file for file in rules.files if file.rule_set.set_id != gone)
            if gone == rules.set_id:
                return dataclasses.replace(rules, set_id="", overlay_ids=(), edits=(), files=files)
            overlay_ids = tuple(overlay_id for overlay_id in rules.overlay_ids if overlay_id != gone)
            return with_fitting(dataclasses.replace(rules, overlay_ids=overlay_ids, files=files), rules.edits)

        self._choice.change_and_tell("forgot an own rule file", changed)

    def save_copy(self) -> None:
        """Send the file of the chosen set, as it is without changes."""
        rules = self._choice.rules
        if not rules.set_id:
            raise ConfigError("save the file: choose a rule set first")
        own = next((file for file in rules.files if file.rule_set.set_id == rules.set_id), None)
        data = own.text.encode("utf-8") if own is not None else read_toml_bytes(rule_set_path(rules.set_id))
        name = own.name if own is not None else f"{rules.set_id}.toml"
        self._client.send_file_download(Path(name).name, data, save_immediately=True)
