"""The job of an inspector from a scan to the report with a name under it, click by click."""

from dataclasses import dataclass

from tests.browser.inspector_page import SETTLE_MS

CLIENT, INSPECTOR = "Northgate Holdings", "J. Alder"
_COUNT = """() => { window.__clicks = 0;
    addEventListener('pointerdown', (event) => { if (event.isTrusted) window.__clicks += 1; }, true); }"""
_LIES_STILL = "(element) => !element.closest('[style*=\"will-change\"]')"


@dataclass(frozen=True, slots=True)
class JobDone:
    """The report and how many times the mouse was pressed for it, what the browser's dialog for files takes aside."""

    pdf: bytes
    n_clicks: int


def do_job(page, name, content, rules, *, before_report=lambda: None):
    """Upload a scan, hold it against rules, look at a step, say for whom and by whom, and take the report.

    Parameters
    ----------
    page : InspectorPage
        Where nothing was done yet.
    name, content : str, bytes
        The scan.
    rules : str
        Of the menu of rule sets.
    before_report : callable
        Called when all but the report is done.
    """
    page.page.evaluate(_COUNT)
    with page.page.expect_file_chooser() as waiting:
        _button(page, "Upload a scan").click()
    waiting.value.set_files({"name": name, "mimeType": "application/octet-stream", "buffer": content})
    page.page.locator("[data-testid=scan]", has_text=name).wait_for()
    page.await_result()
    _tab(page, "Checks")
    page.choose("Rule set", rules)
    page.page.locator("[data-testid=check]:not([data-set=''])").wait_for()
    page.by_id("step-row").first.click()
    _tab(page, "Export")
    _open(page, "Who, where, with what")
    _field(page, "Client", CLIENT)
    _open(page, "Survey")
    _field(page, "Inspector", INSPECTOR)
    before_report()
    with page.page.expect_download(timeout=SETTLE_MS) as made:
        _button(page, "PDF").click()
    with open(made.value.path(), "rb") as stream:
        return JobDone(stream.read(), page.page.evaluate("() => window.__clicks"))


def _button(page, name):
    # The head of a folder is a button too, to who cannot see it.
    return page.page.get_by_role("button", name=name, exact=True).and_(page.page.locator("button")).first


def _tab(page, name):
    page.page.get_by_role("tab", name=name, exact=True).click()


def _open(page, folder):
    page.page.locator("[data-dock-root]").get_by_text(folder, exact=True).last.click()


def _field(page, label, words):
    name = page.page.get_by_text(label, exact=True).and_(page.page.locator("label")).first
    name.wait_for()
    field = name.locator("xpath=ancestor::*[.//input][1]").locator("input").first
    # While a folder opens, what it holds moves.
    page.page.wait_for_function(_LIES_STILL, arg=field.element_handle())
    field.click()
    field.press_sequentially(words)
    field.press("Enter")
