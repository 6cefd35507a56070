"""Uploads are checked before they are received, and one that is refused is not called a success."""

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.bridge.uploads import UnfinishedUploads
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


def offer(page, name, size, button="button", transfer="one", n_parts=1):
    page._send(
        {
            "type": "FileTransferStartUpload",
            "source_component_uuid": button,
            "transfer_uuid": transfer,
            "filename": name,
            "mime_type": "",
            "size_bytes": size,
            "part_count": n_parts,
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


def test_unfinished_uploads_have_a_bound_together_and_leave_it_when_their_page_goes(app, page):
    limit = app._library.upload_limit_bytes
    other = WirePage(app)
    try:
        for sender, transfer in ((page, "a"), (other, "b"), (page, "c")):
            upload = part_of(sender.session, "scan").upload
            offer(sender, "large.ply", limit, upload._impl.uuid, transfer, 900)
            assert sender.session.opening._is_answering()
        words = "upload: other files of 1,000 MB are being uploaded, and 1,000 MB may be at a time"
        await_that(lambda: any(words in said for said in page.told()), "nothing is said")
        states = [each.session.desk.client.gui._current_file_upload_states for each in (page, other)]
        assert [list(each) for each in states] == [["a"], ["b"]]
    finally:
        other.close()
    await_that(lambda: len(app._sessions) == 1, "the page is still open")
    upload = part_of(page.session, "scan").upload
    offer(page, "large.ply", limit, upload._impl.uuid, "d", 900)
    await_that(lambda: "d" in states[0], "the room is not there again")
    offer(page, "large.ply", 1000, upload._impl.uuid, "e", 1000)
    await_that(lambda: any("too many parts" in said for said in page.told()), "nothing is said of the parts")
    states[0].clear()


def test_an_upload_of_which_nothing_comes_makes_room(monkeypatch):
    now = 0.0
    monkeypatch.setattr("time.monotonic", lambda: now)
    unfinished, states = UnfinishedUploads(100), {}

    def begin(transfer):
        unfinished.begin(1, states, transfer, 60)
        states[transfer] = {"total_bytes": 60}

    begin("slow")
    now = 50.0
    unfinished.heard(1, "slow")
    # Of another page of the same name.
    unfinished.heard(2, "next")
    now = 100.0
    with pytest.raises(ConfigError, match="try again when they have come"):
        begin("next")
    now = 111.0
    begin("next")
    assert list(states) == ["next"]
    # One that is alone may be as large as any.
    states.clear()
    unfinished.begin(1, states, "large", 1000)


def test_uploads_of_two_pages_under_one_name_are_both_counted():
    unfinished, states = UnfinishedUploads(100), ({}, {})
    unfinished.begin(1, states[0], "same", 90)
    states[0]["same"] = {"total_bytes": 90}
    with pytest.raises(ConfigError, match="try again when they have come"):
        unfinished.begin(2, states[1], "same", 90)
    # A page that begins its own anew is not held to what it had.
    unfinished.begin(1, states[0], "same", 95)
