"""What is mended of viser's server."""

import zipfile

from tests.viewer.wire_page import WirePage


def test_a_second_page_opens_no_archive_of_icons(app, page, monkeypatch):
    opened = []

    class Counted(zipfile.ZipFile):
        def __init__(self, file, *args, **options):
            opened.append(str(file))
            super().__init__(file, *args, **options)

    monkeypatch.setattr(zipfile, "ZipFile", Counted)
    second = WirePage(app)
    try:
        assert second.session is not page.session
        assert opened == []
    finally:
        second.close()
