"""Uploads are checked before they are received, and one that is refused is not called a success."""

import pytest

from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import STAIR, WirePage, await_that


class UploadingPage(WirePage):
    def __init__(self, app):
        self.taken = []
        super().__init__(app)

    def _take(self, message):
        self.taken.append(message)
        super()._take(message)


@pytest.fixture
def page(app):
    page = UploadingPage(app)
    page.await_result(STAIR)
    yield page
    page.close()


def offer(page, name, size, button="button"):
    page._send(
        {
            "type": "FileTransferStartUpload",
            "source_component_uuid": button,
            "transfer_uuid": "one",
            "filename": name,
            "mime_type": "",
            "size_bytes": size,
            "part_count": 1,
        }
    )


def test_a_refused_upload_frees_its_button_and_takes_the_word_of_success_back(page):
    offer(page, "virus.exe", 2)
    await_that(lambda: any("is no scan by its name" in words for words in page.told()), "nothing is said")
    kinds = [(each["type"], each.get("transfer_uuid") or each.get("uuid")) for each in page.taken]
    assert ("FileTransferPartAck", "one") in kinds
    # viser shows the upload in a notification of this name.
    assert ("RemoveNotificationMessage", "upload-one") in kinds[kinds.index(("FileTransferPartAck", "one")) :]


@pytest.mark.parametrize(
    ("name", "size", "words"),
    [
        ("empty.{}", 0, "upload: 'empty.{}' is empty; give another file"),
        ("huge.{}", 20_000_001, "upload: 'huge.{}' has 20.0 MB and 20 MB are allowed; give a smaller file"),
        ("stair.ply", 10, "upload: 'stair.ply' does not belong here; give a file that ends in .{}"),
        ("a.svg", 10, "upload: 'a.svg' does not belong here; give a file that ends in .{}"),
    ],
)
def test_a_button_for_small_files_says_what_it_takes(page, name, size, words):
    export = part_of(page.session, "export")
    for button, suffix in (
        (export.report.load_logo, "png"),
        (export.open, "json"),
        (part_of(page.session, "tune").presets.load, "toml"),
    ):
        offer(page, name.format(suffix), size, button._impl.uuid)
        wanted = words.format(suffix)
        await_that(lambda wanted=wanted: any(wanted in said for said in page.told()), f"{wanted} is not said")
    assert not any("is no scan" in said for said in page.told())


def test_the_button_of_scans_takes_scans_alone(page):
    upload = part_of(page.session, "scan").upload
    offer(page, "rules.toml", 10, upload._impl.uuid)
    await_that(lambda: any("'rules.toml' is no scan by its name" in said for said in page.told()), "nothing is said")
