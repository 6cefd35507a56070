"""What the inspector adds: read strictly, kept as given, pictures redrawn."""

import contextlib
import dataclasses
import io
import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from stair_inspector.codes.rules import is_plain_line
from stair_inspector.errors import ConfigError
from stair_inspector.report.fields import (
    FIELD_GROUPS,
    FLIGHT_QUANTITIES,
    STEP_QUANTITIES,
    Checklist,
    Photo,
    ReportBasis,
    ReportFields,
    TapeReading,
    basis_from_dict,
    basis_to_dict,
    parse_reading,
    read_basis,
    read_logo,
    read_photo,
)

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


def picture(kind="PNG", size=(40, 20), mode="RGB", **more):
    stream = io.BytesIO()
    Image.new(mode, size, "#804020").save(stream, kind, **more)
    return stream.getvalue()


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


@pytest.mark.parametrize("quantity", sorted(STEP_QUANTITIES))
def test_only_what_has_a_direction_may_be_negative(quantity):
    if quantity in ("fall", "cross_fall", "nosing_overhang"):
        assert TapeReading(quantity, -0.01, step=1).value == -0.01
    else:
        for value, said in ((-0.01, r"-0\.01"), (0.0, r"0\.0")):
            with pytest.raises(ConfigError, match=rf"value: got {said}; give a number above 0"):
                TapeReading(quantity, value, step=1)


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


@pytest.mark.parametrize(
    ("written", "unit", "quantity", "value"),
    [
        (170.5, "mm", "rise", 0.1705),
        (17, "cm", "rise", 0.17),
        ("6 11/16", "in", "rise", 0.1698625),
        ("-1/2", "in", "nosing_overhang", -0.0127),
        (2.0, "%", "fall", math.degrees(math.atan(0.02))),
        ("2", "%", "cross_fall", math.degrees(math.atan(0.02))),
        ("32.5", "deg", "pitch", 32.5),
        (1.5, "ft", "flight_run", 0.4572),
        ("170.5 mm", "in", "rise", 0.1705),
        ("170.5mm", "in", "rise", 0.1705),
        ("17.05 CM", "mm", "rise", 0.1705),
        ('7 9/16"', "mm", "rise", 0.1920875),
        ("7⁹⁄₁₆ in", "mm", "rise", 0.1920875),
        ("7¾ in", "mm", "rise", 0.19685),
        ("7 ¾″", "mm", "rise", 0.19685),
        ("½", "in", "nosing_overhang", 0.0127),
        ("−½ inch", "mm", "nosing_overhang", -0.0127),
        ("3'", "mm", "width", 0.9144),
        ("32.5°", "%", "pitch", 32.5),
        ("2 %", "deg", "fall", math.degrees(math.atan(0.02))),
    ],
)
def test_a_reading_keeps_its_exact_size(written, unit, quantity, value):
    assert parse_reading(written, unit, quantity) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("written", "unit", "quantity", "message"),
    [
        ("-170", "mm", "rise", "value: got -170 mm; give a number above 0"),
        ("-6 11/16", "in", "going", "value: got -6 11/16 in; give a number above 0"),
        ("0", "mm", "rise", "value: got 0 mm; give a number above 0"),
        ("0°", "mm", "pitch", "value: got 0 deg; give a number above 0"),
        ("200000", "mm", "rise", "value: got 200000 mm; give a number of at most 100 m"),
        ("170,5", "mm", "rise", "value: got '170,5'; write a point, not a comma, as in 170.5"),
        ("1,205 mm", "mm", "rise", "value: got '1,205 mm'; write a point, not a comma"),
        ("170 kg", "mm", "rise", "value: unit: got 'kg'; give one of m, cm, mm, in, ft"),
        ("170°", "mm", "rise", "value: unit: got 'deg'; give one of m, cm, mm, in, ft"),
        ("5' 7\"", "mm", "rise", 'value: "5\' 7" is no number; write it as 11, 16.5, 3/8 or 7 3/4'),
        ("", "mm", "rise", "value: '' is no number"),
        ("mm", "mm", "rise", "value: 'mm' is no number"),
        ("a lot", "mm", "rise", "value: 'a lot' is no number"),
    ],
)
def test_a_reading_that_cannot_be_is_refused_as_it_was_written(written, unit, quantity, message):
    with pytest.raises(ConfigError) as caught:
        parse_reading(written, unit, quantity)
    assert str(caught.value).startswith(message)


@given(st.text(max_size=60), st.sampled_from(["m", "in", "deg", "%", "kg"]), st.sampled_from(sorted(STEP_QUANTITIES)))
def test_any_text_is_a_reading_or_a_sentence(written, unit, quantity):
    with contextlib.suppress(ConfigError):
        assert math.isfinite(parse_reading(written, unit, quantity))


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
    quantity=st.sampled_from(sorted(STEP_QUANTITIES)),
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


def test_a_photo_is_upright_small_and_tells_no_place():
    exif = Image.Exif()
    exif[0x0112] = 6
    exif[0x010E] = "secret place"
    data = picture("JPEG", (3000, 1000), exif=exif.tobytes())
    photo = read_photo(data, "x")
    shown = Image.open(io.BytesIO(photo.data))
    assert shown.size == (533, 1600)
    assert b"secret place" not in photo.data
    assert dict(shown.getexif()) == {}


def test_a_logo_keeps_what_is_transparent_and_is_made_small():
    logo = Image.open(io.BytesIO(read_logo(picture("PNG", (5000, 5000), "RGBA"))))
    assert (logo.format, logo.mode, logo.size) == ("PNG", "RGBA", (600, 600))


def test_a_picture_that_would_fill_the_memory_is_refused():
    with pytest.raises(ConfigError, match=r"pixels; give a smaller picture|is not a PNG or JPEG"):
        read_logo(picture("PNG", (12_000, 12_000), "1"))
    with pytest.raises(ConfigError, match="larger than 20 MB"):
        read_logo(b"\x89PNG" + bytes(20_000_000))
    with pytest.raises(ConfigError, match="1 x 1 pixels; give a larger picture"):
        read_logo(picture(size=(1, 1)))


def test_too_many_entries_are_refused():
    with pytest.raises(ConfigError, match="readings: 201 entries; give at most 200"):
        ReportBasis(readings=(TapeReading("rise", 0.17, step=1),) * 201)
    with pytest.raises(ConfigError, match="photos: 13 entries; give at most 12"):
        ReportBasis(photos=(Photo(b""),) * 13)


def test_every_quantity_has_a_unit():
    assert set({**STEP_QUANTITIES, **FLIGHT_QUANTITIES}.values()) == {"m", "deg"}
    assert TapeReading("width", 1.2, flight=1).unit == "m"
    assert TapeReading("fall", 1.2, step=1).unit == "deg"


def photo_of(seed, **saved):
    """A JPEG of noise, which loses some of itself whenever it is encoded."""
    picture = Image.effect_noise((90, 60), 80.0 + seed).convert("RGB")
    stream = io.BytesIO()
    picture.save(stream, "JPEG", **saved)
    return stream.getvalue()


def opened_again(basis):
    return basis_from_dict(basis_to_dict(basis))


def test_a_photo_of_a_project_is_the_same_however_often_it_is_opened():
    basis = ReportBasis(photos=(read_photo(photo_of(1), "the landing"),))
    again = opened_again(opened_again(basis))
    assert again == basis
    assert again.photos[0].data == basis.photos[0].data


def hidden():
    exif = Image.Exif()
    exif[0x010F] = "a camera"
    return {
        "exif": photo_of(2, exif=exif),
        "comment": photo_of(3, comment=b"at home"),
        "profile": photo_of(4, icc_profile=b"profile of a camera"),
        "end": photo_of(5) + b"and more",
    }


@pytest.mark.parametrize("what", ["exif", "comment", "profile", "end"])
def test_a_photo_put_into_a_project_by_hand_is_drawn_anew_and_then_stays(what):
    given = Photo(hidden()[what], "")
    kept = opened_again(ReportBasis(photos=(given,))).photos[0].data
    assert kept != given.data
    for secret in (b"a camera", b"at home", b"profile of", b"and more"):
        assert secret not in kept
    assert opened_again(ReportBasis(photos=(Photo(kept),))).photos[0].data == kept


def test_a_photo_put_into_a_project_by_hand_is_made_small_enough():
    stream = io.BytesIO()
    Image.new("RGB", (2400, 300), (90, 120, 30)).save(stream, "JPEG")
    kept = opened_again(ReportBasis(photos=(Photo(stream.getvalue()),))).photos[0].data
    with Image.open(io.BytesIO(kept)) as picture:
        assert picture.size == (1600, 200)


def test_a_photo_of_a_project_that_is_cut_off_is_refused():
    with pytest.raises(ConfigError, match="photo 1: is not a PNG or JPEG picture that can be read"):
        opened_again(ReportBasis(photos=(Photo(photo_of(6)[:-400]),)))
