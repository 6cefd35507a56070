#!/usr/bin/env bash
# viser 1.1.1: a panel with more than 32 different icons reads all of them from the archive again for each page.
#
# The icons are kept in a cache of 32. Pages make their buttons in the same order, so that with 33 icons every one has
# just been dropped when it is asked for again: the archive of some 6,000 icons is opened, and its directory read, once
# for every button of every page. With 32 icons a second page opens it never.
#
# Seen: "viser 1.1.1, archive opened for the first and the second page: 32 icons 32 and 0, 33 icons 33 and 33".
# Fails when a later run of this version behaves otherwise.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet "viser==1.1.1"
"$folder/venv/bin/python" - <<'PYTHON'
import string
import sys
import zipfile

import viser

NAMES = [f"{kind}LETTER_{letter}" for kind in ("", "SQUARE_", "CIRCLE_") for letter in string.ascii_uppercase]
opened = 0


class Counted(zipfile.ZipFile):
    def __init__(self, *args, **options):
        global opened
        opened += 1
        super().__init__(*args, **options)


zipfile.ZipFile = Counted
server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)


def opened_for_page(names):
    before = opened
    for name in names:
        server.gui.add_button("button", icon=getattr(viser.Icon, name)).remove()
    return opened - before


fits = opened_for_page(NAMES[:32]), opened_for_page(NAMES[:32])
exceeds = opened_for_page(NAMES[32:65]), opened_for_page(NAMES[32:65])
server.stop()
print(
    f"viser {viser.__version__}, archive opened for the first and the second page: "
    f"32 icons {fits[0]} and {fits[1]}, 33 icons {exceeds[0]} and {exceeds[1]}"
)
sys.exit(0 if (fits, exceeds) == ((32, 0), (33, 33)) else "viser behaves otherwise than was seen")
PYTHON
