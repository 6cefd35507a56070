"""What the inspector adds: read strictly, kept as given, pictures redrawn."""

import dataclasses
import io
import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from stair_inspector.codes.texts import is_plain_line
from stair_inspector.content.basis_files import basis_from_dict, basis_to_dict, read_basis
from stair_inspector.content.fields import FIELD_GROUPS, Checklist, ReportBasis, ReportFields
from stair_inspector.content.images import Photo
from stair_inspector.content.readings import FLIGHT_READINGS, STEP_READINGS, TapeReading
from stair_inspector.errors import ConfigError
from tests.content.test_images import picture

WHOLE = """
logo = "logo.png"
paper = "us-letter"
[fields]
client = " Northgate "
site = "서울 — 12 “Main” Street"
[checklist]
slip_resistance = "pendulum test, 42"
[[readings]]
quantity = "rise"
step = 3
value = "6 11/16"
unit = "in"
u = "1/16"
instrument = "steel tape"
[[readings]]
quantity = "pitch"
flight = 1
value = 32.5
unit = "deg"
[[photos]]
file = "photo.jpg"
caption = "from below"
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "logo.png").write_bytes(picture())
    (tmp_path / "photo.jpg").write_bytes(picture("JPEG"))
    return tmp_path


def basis_of(folder, text):
    path = folder / "fields.toml"
    path.write_bytes(text.encode("utf-8"))
    return read_basis(path)


def test_a_file_gives_every_part(folder):
    basis = basis_of(folder, WHOLE)
    assert basis.fields == ReportFields(client="Northgate", site="서울 — 12 “Main” Street")
    assert basis.checklist == Checklist(slip_resistance="pendulum test, 42")
    assert basis.readings == (
        TapeReading("rise", 0.1698625, step=3, u=0.0015875, instrument="steel tape"),
        TapeReading("pitch", 32.5, flight=1),
    )
    assert Image.open(io.BytesIO(basis.logo)).size == (40, 20)
    assert [photo.caption for photo in basis.photos] == ["from below"]
    assert basis.paper == "us-letter"


def test_a_date_or_time_without_quotes_is_taken_as_text(folder):
    text = "[fields]\nsurvey_date = 2026-11-22\nsurvey_time = 09:30:00\nsigned_on = 2026-11-23T08:15:00Z"
    fields = basis_of(folder, text).fields
    assert (fields.survey_date, fields.survey_time) == ("2026-11-22", "09:30:00")
    assert fields.signed_on == "2026-11-23T08:15:00+00:00"


def test_an_empty_file_leaves_all_blank(folder):
    assert basis_of(folder, "") == ReportBasis()


def test_every_field_stands_in_one_group_and_has_a_label():
    names = [field.name for field in dataclasses.fields(ReportFields)]
    assert sorted(itertools.chain.from_iterable(FIELD_GROUPS.values())) == sorted(names)
    labels = [ReportFields.label_of(name) for name in names]
    assert all(labels)
    assert ReportFields.hint_of("levelling_source")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[fields]\nclinet = 'x'", r"unknown key 'clinet'; did you mean 'client'\?"),
        ("[feilds]\n", r"unknown key 'feilds'; did you mean 'fields'\?"),
        ("[checklist]\nslip = 'x'", r"unknown key 'slip'"),
        ("[fields]\nclient = 3", r"\[fields\] client: got 3; give a text in quotes"),
        ("fields = 3", r"\[fields\]: got 3; give a table"),
        ('[fields]\nclient = "a\\u0007b"', "control character"),
        ("[fields]\nclient = '" + "x" * 4001 + "'", "4,001 characters; give at most 4,000"),
        ("readings = 3", r"\[\[readings\]\]: got 3; give one table for each"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = 170", "readings.*1: unit is missing"),
        ("[[readings]]\nquantity = 'rize'\nstep = 1\nvalue = 170\nunit = 'mm'", "'rize'; did you mean 'rise'"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = 170\nunit = 'deg'", "unit: got 'deg'; give one of m, cm"),
        ("[[readings]]\nquantity = 'rise'\nvalue = 170\nunit = 'mm'", "either step or flight"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nflight = 1\nvalue = 1\nunit = 'mm'", "either step or flight"),
        ("[[readings]]\nquantity = 'rise'\nstep = 0\nvalue = 170\nunit = 'mm'", "step: got 0; give a whole number"),
        ("[[readings]]\nquantity = 'rise'\nstep = true\nvalue = 170\nunit = 'mm'", "step: got True"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = nan\nunit = 'mm'", "value: got nan mm; give"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = 1e9\nunit = 'mm'", "at most 100 m"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = '6 11/0'\nunit = 'in'", "is no number; write it as"),
        ("[[readings]]\nquantity = 'width'\nstep = 1\nvalue = 1\nunit = 'm'\nline = 'left'", "only rise and going"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = 1\nunit = 'm'\nline = 'top'", "line: got 'top'"),
        ("[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = 170\nunit = 'mm'\nu = -1", "u: got -1 mm; give a"),
        (
            "[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = -178\nunit = 'mm'",
            "value: got -178 mm; give a number above 0",
        ),
        ("[[readings]]\nquantity = 'fall'\nstep = 1\nvalue = 1\nunit = '%'\nu = 0", "u: got 0 %; give a"),
        (
            "[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = '170 mm'\nunit = 'in'",
            "got '170 mm' and the unit 'in'; give the same",
        ),
        (
            f"[[readings]]\nquantity = 'rise'\nstep = 1\nvalue = 1{'0' * 400}\nunit = 'mm'",
            r"value: got 10+\.\.\. mm; give a number of at most 100 m",
        ),
        (f"[[readings]]\nquantity = 'fall'\nstep = 1\nvalue = 1{'0' * 400}\nunit = '%'", "of at most 90 deg"),
        ('[fields]\nfirm = "Alder \u202ehcniF"', r"firm: holds a control .* direction of reading, '\\u202e'"),
        ("paper = 'a3'", "paper: got 'a3'; give one of a4, us-letter"),
        ("logo = 'none.png'", "is no file; check the name"),
        ("logo = 3", "logo: got 3; give the name of a picture"),
        ("logo = 'fields.toml'", "is not a PNG or JPEG picture"),
        ("[[photos]]\ncaption = 'x'", r"photos.* 1: file is missing"),
        ("[[photos]]\nfile = 'photo.jpg'\ncaption = 3", "caption: got 3"),
        ("x = [", "is not valid TOML"),
    ],
)
def test_a_wrong_file_is_refused_in_one_sentence(folder, text, message):
    with pytest.raises(ConfigError, match=message) as caught:
        basis_of(folder, text)
    assert str(caught.value).startswith(str(folder / "fields.toml"))
    assert "\n" not in str(caught.value)


def test_a_file_that_is_missing_or_no_text_is_refused(folder):
    with pytest.raises(ConfigError, match="cannot be read"):
        read_basis(folder / "none.toml")
    (folder / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigError, match="is not a text file"):
        read_basis(folder / "binary.toml")


@pytest.mark.parametrize("name", ["value", "u"])
def test_a_project_with_a_number_too_long_for_a_float_is_a_sentence(name):
    reading = {"quantity": "rise", "value": 0.17, "step": 1, name: 10**400}
    with pytest.raises(ConfigError, match=rf"{name}: got 10+\.\.\.; give a number of at most 100 m"):
        basis_from_dict({"readings": [reading]})


def test_a_project_keeps_what_the_user_gave(folder):
    basis = basis_of(folder, WHOLE)
    again = basis_from_dict(basis_to_dict(basis))
    assert dataclasses.replace(again, photos=(), logo=None) == dataclasses.replace(basis, photos=(), logo=None)
    assert again.logo == basis.logo
    assert [photo.caption for photo in again.photos] == ["from below"]
    assert basis_to_dict(ReportBasis()) == {"paper": "a4"}


@given(
    texts=st.dictionaries(
        st.sampled_from([field.name for field in dataclasses.fields(ReportFields)]),
        st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Zl", "Zp")).filter(is_plain_line), max_size=40),
    ),
    value=st.floats(0.0, 90.0, exclude_min=True),
    quantity=st.sampled_from(sorted(STEP_READINGS)),
)
def test_any_basis_survives_a_project(texts, value, quantity):
    basis = ReportBasis(fields=ReportFields(**texts), readings=(TapeReading(quantity, value, step=1),))
    assert basis_from_dict(basis_to_dict(basis)) == basis


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([], "give a table"),
        ({"field": 1}, "unknown key 'field'; did you mean 'fields'"),
        ({"logo_base64": "???"}, "is no picture in base64"),
        ({"logo_base64": "AAAA"}, "is not a PNG or JPEG"),
        ({"readings": [{"quantity": "rise"}]}, "reading 1: value is missing"),
        ({"readings": [{"quantity": 3, "value": 1, "step": 1}]}, "unknown quantity '3'"),
        ({"readings": [{"quantity": "rise", "value": "1", "step": 1}]}, "value: got '1'; give a number"),
        ({"photos": [{"base64": 3}]}, "photo 1: is no picture in base64"),
        ({"paper": ["a4"]}, "paper: got"),
        ({"readings": [{"quantity": "rise", "value": 1, "step": 1, "at": [1, 2]}]}, "at: got .*give x, y and z"),
        ({"readings": [{"quantity": "rise", "value": 1, "step": 1, "at": [1, 2, 10**400]}]}, "at: got .*give x, y and"),
        ({"readings": [{"quantity": "rise", "value": 1, "step": 1, "at": {"x": 1}}]}, "at: got .*give x, y and z"),
        ({"readings": [{"quantity": "width", "value": 1, "flight": 1, "at": [1, 2, 3]}]}, "at: only a step has a"),
    ],
)
def test_a_hostile_project_is_refused(values, message):
    with pytest.raises(ConfigError, match=message):
        basis_from_dict(values)


def test_too_many_entries_are_refused():
    with pytest.raises(ConfigError, match="readings: 201 entries; give at most 200"):
        ReportBasis(readings=(TapeReading("rise", 0.17, step=1),) * 201)
    with pytest.raises(ConfigError, match="photos: 13 entries; give at most 12"):
        ReportBasis(photos=(Photo(b""),) * 13)


def test_every_quantity_has_a_unit():
    assert set({**STEP_READINGS, **FLIGHT_READINGS}.values()) == {"m", "deg"}
    assert TapeReading("width", 1.2, flight=1).unit == "m"
    assert TapeReading("fall", 1.2, step=1).unit == "deg"
