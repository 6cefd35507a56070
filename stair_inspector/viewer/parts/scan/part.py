"""The Scan tab: which file, its unit, station, up and region, and how its points are drawn."""

import viser

from stair_inspector.viewer.bridge.widgets import File
from stair_inspector.viewer.parts.cures import Cures
from stair_inspector.viewer.parts.examination_html import examination_html
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.scan.columns import ColumnsTool
from stair_inspector.viewer.parts.scan.one_station import StationMenu
from stair_inspector.viewer.parts.scan.part_of_file import PartOfFile
from stair_inspector.viewer.parts.scan.points import PointsFolder
from stair_inspector.viewer.parts.scan.region import RegionTool
from stair_inspector.viewer.parts.scan.scan_list import ScanList
from stair_inspector.viewer.parts.scan.upright import UprightTool
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.library import upload_types


class ScanPart(PagePart):
    """Opens scans, and says what is to be measured of them."""

    title = "Scan"
    icon = viser.Icon.SCAN
    depends_on = frozenset(
        {
            PageChange.WORK,
            PageChange.RESULT,
            PageChange.SCAN,
            PageChange.CLOUD,
            PageChange.COLORS,
            PageChange.SETTLED,
            PageChange.STATUS,
            PageChange.REST,
        }
    )

    def __init__(self, context: Context) -> None:
        self._context = context
        self._desk = context.desk
        widgets, controls = context.widgets, context.editor.controls
        self._cures = Cures(context)
        self.examination = widgets.html()
        self.scans = ScanList(context, self.choose)
        self.upload = widgets.upload(
            "Upload a scan",
            upload_types(),
            self.take_upload,
            icon=viser.Icon.UPLOAD,
            hint="Kept until the server ends; only this browser sees it.",
        )
        widgets.button(
            "Look for new scans",
            self.look_for_scans,
            icon=viser.Icon.REFRESH,
            hint="Lists what has come into the folders since.",
            is_quiet=True,
        )
        controls.add_choice("method")
        controls.add_choice("unit")
        self.columns = ColumnsTool(context)
        self.part_of_file = PartOfFile(context)
        self.station = StationMenu(context)
        controls.add_choice("stations")
        controls.add_up()
        self.upright = UprightTool(context)
        self.region = RegionTool(context)
        self.points = PointsFolder(context)
        controls.add_choice("normals.source")

    def show(self, what: frozenset[PageChange]) -> None:
        """List the scans, and show what was found about the one that is open."""
        if what & {PageChange.RESULT, PageChange.SETTLED}:
            self.examination.content = examination_html(self._desk.marked, self._cures.uuid)
        if what & {PageChange.RESULT, PageChange.SCAN}:
            self.upright.show()
        if what & {PageChange.RESULT, PageChange.WORK, PageChange.SCAN}:
            self.station.show()
        if what & {PageChange.SCAN, PageChange.CLOUD, PageChange.COLORS}:
            self.points.show()
        if what & {PageChange.RESULT, PageChange.WORK, PageChange.SCAN, PageChange.STATUS}:
            self.scans.show()
        if PageChange.REST in what:
            self.scans.draw()
        if what & {PageChange.WORK, PageChange.SCAN, PageChange.CLOUD}:
            self.columns.show()
            self.region.show()

    def put_away(self) -> bool:
        """Give up picking points."""
        with self._desk.lock:
            self.upright.stop()
        return False

    def close(self) -> None:
        """End the threads."""
        self.points.close()

    def choose(self, label: str) -> None:
        """Open another scan. The page is empty until it is measured: what is done counts for it alone."""
        desk, keeper = self._desk, self._context.keeper
        with desk.lock:
            with keeper.lock:
                if not self._context.opening.choose(label):
                    return
                desk.clear()
                desk.status.begin("opening …")
                self._context.editor.ask()
            desk.changed(PageChange.RESULT, PageChange.SCAN, PageChange.WORK, PageChange.STATUS)

    def take_upload(self, file: File) -> None:
        """Open an uploaded scan."""
        self.choose(self._context.opening.keep_upload(file))

    def look_for_scans(self) -> None:
        """Look into the folders again."""
        n_new, n_all = self._context.opening.look_for_scans()
        with self._desk.lock:
            self.scans.show()
        self._desk.notices.tell("Scans", f"{n_new} new, {n_all} in the list")
