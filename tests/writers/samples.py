"""Reports of a scan with a defective step and of made-up stairs, in all formats; made once for all tests."""

import functools
import io
from datetime import UTC, datetime
from html.parser import HTMLParser

import openpyxl
import pypdf

from stair_inspector.codes import check
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.content.order import build_document
from stair_inspector.content.readings import TapeReading
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.writers.html import html_bytes
from stair_inspector.writers.pdf import pdf_bytes
from stair_inspector.writers.report import make_report, report_bytes
from stair_inspector.writers.xlsx import xlsx_bytes
from tests.test_samples import load_sample, survey_sample

MADE_AT = datetime(2026, 11, 22, 15, 4, 5, tzinfo=UTC)
HOSTILE = (
    "<script>alert(1)</script> & \"q\" 'a' #let x = 1; $y$ *b* _i_ @ref `raw` =SUM(A1) \\u{41} http://x.y/ {{z}} ]--"
)
"""A text that means something in HTML, in typst's markup and in a workbook."""
BASIS = ReportBasis(
    fields=ReportFields(client="Northgate Holdings", stair="C-2", inspector="J. Alder", firm="Alder & Finch"),
    readings=(
        TapeReading("rise", 0.1930, step=5, u=0.001, instrument="steel tape"),
        TapeReading("rise", 0.1700, step=2, u=0.001),
        TapeReading("going", 0.28, step=1, line="left"),
        TapeReading("fall", 0.2, step=3, note="digital level"),
        TapeReading("flight_rise", 1.6165, flight=1),
        TapeReading("rise", 0.17, step=77),
    ),
)


def scanned(name="defective_step"):
    """A sample and what is measured of it, made once for all tests of a process."""
    return load_sample(name)[0], survey_sample(name)


@functools.cache
def by_the_paper():
    """The first sample, measured by the paper's method."""
    scan, memo = load_sample("defective_step")
    return inspect(scan, Params(method="paper"), memo)


def checked(name="defective_step", rules="us-ibc-2021"):
    return _checked(name, rules)


def document(name="defective_step"):
    return _document(name)


def formats(name="defective_step"):
    """The PDF, the HTML page and the workbook, by suffix."""
    return _formats(name)


# Kept by their arguments, which a default left out would be another set of.


@functools.cache
def _checked(name, rules):
    return check(scanned(name)[1], find_rule_set(rules))


@functools.cache
def _document(name):
    scan, inspection = scanned(name)
    return make_report(scan, inspection, BASIS, MADE_AT, checked(name))


@functools.cache
def _formats(name):
    return report_bytes(document(name))


@functools.cache
def html():
    """The page alone: to typeset the PDF takes longest."""
    return html_bytes(document())


def plain_document(inspection, found=None, basis=None):
    """A report without pictures."""
    return build_document(inspection, found, basis or ReportBasis(), MADE_AT)


def pdf_pages(data):
    return [page.extract_text() for page in pypdf.PdfReader(io.BytesIO(data)).pages]


def pdf_text(document):
    """The words of a report's PDF, one blank between two, whatever the lines and pages."""
    return " ".join(" ".join(pdf_pages(pdf_bytes(document))).split())


def workbook(document):
    return openpyxl.load_workbook(io.BytesIO(xlsx_bytes(document)))


class Page(HTMLParser):
    """What a browser would make of a page: tags with their attributes, the text, and the cells of each table."""

    def __init__(self, data):
        super().__init__(convert_charrefs=True)
        self.tags, self.words, self.tables, self.values = [], [], {}, {}
        self._open, self._table, self._cell = [], None, None
        self.feed(data.decode("utf-8"))
        self.close()
        assert self._open == [], "every tag is closed"

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.tags.append((tag, given))
        if tag not in ("meta", "img", "br"):
            self._open.append(tag)
        if tag == "table":
            self._table = given["id"]
            self.tables[self._table], self.values[self._table] = [], []
        elif tag == "tr" and self._table:
            self.tables[self._table].append([])
            self.values[self._table].append([])
        elif tag == "td":
            self.tables[self._table][-1].append("")
            self.values[self._table][-1].append(None)
        elif tag == "data":
            self.values[self._table][-1][-1] = float(given["value"])

    def handle_endtag(self, tag):
        assert self._open.pop() == tag, f"</{tag}> closes another"
        if tag == "table":
            self._table = None

    def handle_data(self, words):
        if "style" in self._open:
            return
        self.words.append(words)
        if "td" in self._open and self._table:
            self.tables[self._table][-1][-1] += words

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


def html_page(document):
    return Page(html_bytes(document))
