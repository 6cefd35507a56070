"""The PDF: typeset, tagged, fonts inside, every text as text, the same bytes for the same content."""

import dataclasses
import io
from datetime import timedelta

import pypdf
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from stair_inspector.content.document import Bullets, Document, Facts, Figure, Paragraph, Section, Signatures, Table
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.errors import MissingLibrary, WriteError
from stair_inspector.pictures import fonts
from stair_inspector.writers import pdf
from stair_inspector.writers.pdf import page_pngs, pdf_bytes
from stair_inspector.writers.report import make_report
from tests.codes.flights import even, inspection_of
from tests.writers.samples import (
    HOSTILE,
    MADE_AT,
    checked,
    document,
    formats,
    pdf_pages,
    pdf_text,
    plain_document,
    scanned,
)

pytestmark = pytest.mark.slow


def words_of(text):
    """A text as the PDF gives it back: one blank for any number."""
    return " ".join(text.split())


def made_of(*blocks):
    return Document("Title", (), "", None, "", MADE_AT, "a4", (), (Section("1", "Section", blocks),))


@pytest.fixture(scope="module")
def reader():
    return pypdf.PdfReader(io.BytesIO(formats()["_report.pdf"]))


def fonts_of(reader):
    found = {}
    for page in reader.pages:
        for font in page["/Resources"].get("/Font", {}).values():
            base = font.get_object()
            descriptor = base["/DescendantFonts"][0].get_object()["/FontDescriptor"].get_object()
            found[base["/BaseFont"]] = any(f"/FontFile{kind}" in descriptor for kind in ("", "2", "3"))
    return found


def test_every_font_is_embedded(reader):
    found = fonts_of(reader)
    assert found
    assert all(found.values())
    assert {name.split("+")[1].split("-")[0] for name in found} == {"SourceSans3", "NotoSansKR"}


def test_headings_are_tagged_and_the_language_is_said(reader):
    root = reader.trailer["/Root"]
    assert root["/MarkInfo"]["/Marked"]
    assert root["/Lang"] == "en"
    kinds = []

    def walk(node):
        node = node.get_object()
        if isinstance(node, list):
            for child in node:
                walk(child)
        elif isinstance(node, dict):
            kinds.append(node.get("/S"))
            if "/K" in node:
                walk(node["/K"])

    walk(root["/StructTreeRoot"]["/K"])
    assert {"/H1", "/H2", "/Table", "/TH", "/TD", "/Figure"} <= set(kinds)
    sections = document().sections
    outline = [entry["/Title"] for entry in reader.outline if not isinstance(entry, list)]
    assert outline == [f"{section.number}  {section.title}" for section in sections]


def test_every_picture_has_words_for_those_who_do_not_see_it(reader):
    alts = []

    def walk(node):
        node = node.get_object()
        if isinstance(node, list):
            for child in node:
                walk(child)
        elif isinstance(node, dict):
            if node.get("/S") == "/Figure" and "/Alt" in node:
                alts.append(str(node["/Alt"]))
            if "/K" in node:
                walk(node["/K"])

    walk(reader.trailer["/Root"]["/StructTreeRoot"]["/K"])
    assert sorted(alts) == sorted(figure.alt for figure in document().figures())


def test_every_page_says_which_of_how_many_it_is(reader):
    n = len(reader.pages)
    assert n > 5
    for number, page in enumerate(reader.pages, 1):
        assert f"Page {number} of {n}" in page.extract_text()


def test_the_signatures_stand_on_one_page_with_what_is_signed(reader):
    (page,) = [page.extract_text() for page in reader.pages if "The measurements were made with" in page.extract_text()]
    assert page.count("Signature") == 2


def test_title_firm_and_date_are_those_of_the_report(reader):
    assert reader.metadata.title == "Stair survey report"
    assert reader.metadata.author == "Alder & Finch"
    assert reader.metadata.creation_date == MADE_AT


def test_the_same_content_gives_the_same_bytes_and_the_date_is_all_that_differs():
    made = plain_document(scanned()[1], checked())
    later = dataclasses.replace(made, made_at=MADE_AT + timedelta(days=40))
    assert pdf_bytes(made) == pdf_bytes(made)
    before, after = pdf_text(made), pdf_text(later)
    assert before != after
    assert before.replace("2026-11-22", "2027-01-01") == after


@pytest.mark.parametrize("text", [HOSTILE, "#panic()", "]#[", "\\", "$", '"', "= no heading", '#include "/etc/passwd"'])
def test_text_is_never_read_as_markup(text):
    fields = ReportFields(**dict.fromkeys(ReportFields.__dataclass_fields__, text))
    shown = pdf_text(plain_document(scanned()[1], None, ReportBasis(fields=fields)))
    assert shown.replace(" ", "").count(text.replace(" ", "")) >= 30


@given(text=st.text(st.characters(categories=("L", "N", "P", "S", "Zs"), max_codepoint=0x17F), min_size=1, max_size=60))
@settings(max_examples=25)
def test_latin_text_comes_back_letter_for_letter(text):
    shown = "".join(pdf_pages(pdf_bytes(made_of(Paragraph(f"BEGIN{text}END")))))
    kept = "".join(shown.split("BEGIN")[1].split("END")[0].split()).replace("\xad", "")
    assert kept == "".join(text.split()).replace("\xad", "")


def test_korean_and_japanese_are_drawn():
    words = "단높이 건축물의 피난ㆍ방화구조 등의 기준에 관한 규칙 제15조 蹴上げ 踏面 幅 hauteur Größe Ελλάδα"
    shown = pdf_text(made_of(Paragraph(words)))
    assert words in shown
    assert "U+" not in shown


@pytest.mark.parametrize("letter", ["\U0001f642", "\u1780", "\uf8ff", "\u0378"])
def test_a_letter_that_no_font_has_is_spelt_out(letter):
    shown = pdf_text(made_of(Paragraph(f"before {letter} after")))
    assert f"before ⟨U+{ord(letter):04X}⟩ after" in shown


def test_a_mark_that_joins_to_the_letter_before_it_is_drawn_with_it():
    assert "⟨U+" not in pdf_text(made_of(Paragraph("re\u0301sume\u0301")))


@pytest.mark.parametrize("letter", ["\U0001f642", "\u1780", "\uf8ff"])
def test_a_letter_in_a_drawing_that_no_font_has_is_spelt_out(letter):
    words = f'<text y="12" font-size="8">a{letter}b</text>'
    drawn = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 20">{words}</svg>'
    shown = pdf_text(made_of(Figure("f", "caption", "words", "svg", drawn.encode())))
    assert f"a⟨U+{ord(letter):04X}⟩b" in shown


def test_any_number_of_new_letters_is_tried_at_once(monkeypatch):
    """A field may hold thousands of letters; to typeset a page for each of them takes minutes."""
    import typst

    compiled = []
    monkeypatch.setattr(pdf, "_IS_DRAWN", {})
    whole = typst.compile
    monkeypatch.setattr(typst, "compile", lambda *args, **wanted: compiled.append(1) or whole(*args, **wanted))
    korean, unknown = map(chr, range(0xAC00, 0xAC00 + 2000)), map(chr, range(0x1780, 0x1790))
    words = "".join(korean) + "o\u0301\u200d\u2029" + "".join(unknown)
    spelt = pdf._spelt({"words": [words, 3, None], "more": words})
    expected = words[:2004] + "".join(f"⟨U+{ord(letter):04X}⟩" for letter in words[2004:])
    assert spelt == {"words": [expected, 3, None], "more": expected}
    assert pdf._spelt(words) == expected
    assert len(compiled) == 1


def test_a_picture_that_is_none_is_told_in_one_sentence():
    with pytest.raises(WriteError, match="the report cannot be typeset") as caught:
        pdf_bytes(made_of(Figure("f", "caption", "words", "png", b"no picture")))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("paper", ["a4", "us-letter"])
@pytest.mark.parametrize("words", [3, 60])
def test_pictures_of_a_tall_stair_stand_on_the_first_page_whole(paper, words):
    def tall(shade):
        stream = io.BytesIO()
        Image.new("RGB", (300, 900), (shade, 90, 160)).save(stream, "PNG")
        return Figure(f"f{shade}", "caption " * words, "words", "png", stream.getvalue(), 0.5)

    made = dataclasses.replace(
        made_of(Paragraph("words")), paper=paper, front=(Paragraph("lead " * 60, "lead"), tall(10), tall(200))
    )
    pages = pypdf.PdfReader(io.BytesIO(pdf_bytes(made))).pages
    assert [len(page.images) for page in pages] == [2, 0]
    assert pages[0].extract_text().count("caption") == 2 * words


def test_pages_as_pictures_are_those_of_the_pdf():
    made = plain_document(scanned()[1], checked())
    pages = page_pngs(made, 40.0)
    assert len(pages) == len(pypdf.PdfReader(io.BytesIO(pdf_bytes(made))).pages)
    # A4 at forty pixels for an inch.
    assert {Image.open(io.BytesIO(page)).size for page in pages} == {(331, 468)}


def test_long_words_are_broken_and_do_not_leave_the_page():
    word = "w" * 400
    table = Table("t", "Table", document().tables()[0].columns[:2], ((1, word),))
    made = made_of(Paragraph(word), Facts("f", "Facts", (("Label", word),)), table)
    lines = [line for page in pdf_pages(pdf_bytes(made)) for line in page.splitlines()]
    of_words = [line for line in lines if "www" in line]
    # A hundred and twenty of these letters are as wide as the page's text.
    assert max(len(line) for line in of_words) <= 120
    assert sum(line.count("w") for line in of_words) == 3 * len(word)


def test_a_hash_a_clause_and_a_name_are_copied_as_they_are(reader):
    pages = [page.extract_text() for page in reader.pages]
    assert any(scanned()[0].sha256 in page for page in pages)
    assert any(checked().rule_set.sha256 in page for page in pages)
    assert any("uncertainty.scale_percent" in page for page in pages)
    assert not any("\u200b" in page for page in pages)


def test_a_group_of_facts_stands_on_one_page_with_its_head(reader):
    pages = [words_of(page.extract_text()) for page in reader.pages]
    groups = [block for block in document().blocks() if isinstance(block, Facts)]
    assert len(groups) > 8
    for group in groups:
        words = words_of(" ".join((group.title, *(f"{label} {value}" for label, value in group.items))))
        assert any(words in page for page in pages), group.title


@pytest.mark.parametrize("n", range(29, 36))
def test_no_bullet_stands_alone_on_a_page(n):
    items = tuple(f"bullet {k}" for k in range(8))
    pages = pdf_pages(pdf_bytes(made_of(*[Paragraph(f"line {k}") for k in range(n)], Bullets(items))))
    counts = [page.count("bullet") for page in pages]
    assert sum(counts) == 8
    assert 1 not in counts


def test_the_sign_off_has_no_page_of_its_own_where_there_is_room():
    lines = (("Inspector", (("Name", ""), ("Date", ""))), ("Reviewer", (("Name", ""), ("Date", ""))))
    sections = [Section("1", "Section", (Paragraph("words"),)), Section("2", "Sign-off", (Signatures(lines),))]
    made = dataclasses.replace(made_of(), sections=tuple(sections))
    assert len(pdf_pages(pdf_bytes(made))) == 1
    full = dataclasses.replace(sections[0], blocks=tuple(Paragraph(f"line {k}") for k in range(30)))
    after = pdf_pages(pdf_bytes(dataclasses.replace(made, sections=(full, sections[1]))))
    assert [page.count("Signature") for page in after] == [0, 2]
    (signing,) = [section for section in document().sections if section.title == "Sign-off"]
    assert not signing.starts_page


@pytest.mark.parametrize("word", ["Survey of the northern stairs ", "건축물의 피난계단 "])
def test_a_long_title_leaves_the_pictures_on_the_first_page_and_the_head_on_one_line(word):
    stair = "Stair C-2 in the northern core behind the second fire door"
    fields = ReportFields(title=word * 12, stair=stair, firm="Alder & Finch " * 8)
    made = make_report(*scanned(), ReportBasis(fields=fields, paper="us-letter"), MADE_AT, checked())
    first, second, *_ = pdf_pages(pdf_bytes(made))
    captions = [block.caption for block in made.front if isinstance(block, Figure)]
    assert captions
    for caption in captions:
        assert caption in words_of(first)
    head = second.splitlines()[:3]
    assert sum("…" in line for line in head) == 1
    assert head[0].count("…") == 3
    # The whole title stands where the report is identified.
    whole = words_of(" ".join(pdf_pages(pdf_bytes(made))))
    assert "".join(word.split()) * 12 in whole.replace(" ", "")


def test_a_field_longer_than_a_page_is_all_there():
    text = " ".join(f"word{k}" for k in range(440))
    shown = pdf_text(made_of(Facts("f", "Facts", (("Label", text), ("Other", "")))))
    assert all(f"word{k} " in shown for k in range(440))
    pages = pdf_pages(pdf_bytes(made_of(Facts("f", "Facts", (("Label", text), ("Other", ""))))))
    assert len(pages) > 1


def test_sixty_steps_are_all_there_and_each_page_of_the_table_has_its_head():
    steps = even(60, u=0.0004)
    pages = pdf_pages(pdf_bytes(plain_document(inspection_of(steps))))
    of_table = [page for page in pages if "Diagonal" in page and "165.0 ± 0.4" in page]
    assert len(of_table) > 1
    lines = [line for page in pages for line in page.splitlines()]
    for step in range(1, 61):
        assert sum(line.startswith(f"{step} 1 165.0 ± 0.4") for line in lines) == 1


def test_an_empty_field_is_a_blank_behind_its_label():
    shown = pdf_text(plain_document(scanned()[1]))
    assert "Client Site Building" in shown
    assert "None" not in shown


def test_what_is_missing_is_said_in_one_sentence(monkeypatch):
    monkeypatch.setattr(fonts, "_PACKAGES", ("no_such_fonts",))
    fonts.font_folders.cache_clear()
    try:
        with pytest.raises(MissingLibrary, match=r"no-such-fonts is not installed.*pip install"):
            pdf_bytes(made_of(Paragraph("words")))
    finally:
        monkeypatch.undo()
        fonts.font_folders.cache_clear()
