"""Uploads are checked before they are received, and one that is refused is not called a success."""

import pytest

from stair_inspector.files.simulations import simulate_to_file
from stair_inspector.params import Params
from stair_inspector.simulate.specs import Scanner, Stair
from stair_inspector.viewer.app import App
from tests.viewer.wire_page import WirePage, await_that

SCANNER = Scanner(max_points=6_000, azimuth_step_deg=0.3, elevation_step_deg=0.3, spacing_m=0.01, noise_m=0.002)


class UploadingPage(WirePage):
    def __init__(self, app):
        self.taken = []
        super().__init__(app)

    def _take(self, message):
        self.taken.append(message)
        super()._take(message)


@pytest.fixture
def page(tmp_path):
    simulate_to_file(tmp_path / "stair.ply", Stair(n_risers=3), SCANNER)
    app = App([tmp_path / "stair.ply"], Params(), port=0, saves_projects=False)
    page = UploadingPage(app)
    page.await_result()
    yield page
    page.close()
    app.stop()


def test_a_refused_upload_frees_its_button_and_takes_the_word_of_success_back(page):
    page._send(
        {
            "type": "FileTransferStartUpload",
            "source_component_uuid": "button",
            "transfer_uuid": "one",
            "filename": "virus.exe",
            "mime_type": "",
            "size_bytes": 2,
            "part_count": 1,
        }
    )
    await_that(lambda: any("is no scan by its name" in words for words in page.told()), "nothing is said")
    kinds = [(each["type"], each.get("transfer_uuid") or each.get("uuid")) for each in page.taken]
    assert ("FileTransferPartAck", "one") in kinds
    # viser shows the upload in a notification of this name.
    assert ("RemoveNotificationMessage", "upload-one") in kinds[kinds.index(("FileTransferPartAck", "one")) :]
