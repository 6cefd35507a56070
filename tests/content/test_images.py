"""Logo and photographs: small, upright, nothing hidden in them, and the same however often they are opened."""

import io

import pytest
from PIL import Image

from stair_inspector.content.basis_files import basis_from_dict, basis_to_dict
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.images import Photo, read_logo, read_photo
from stair_inspector.errors import ConfigError


def picture(kind="PNG", size=(40, 20), mode="RGB", **more):
    stream = io.BytesIO()
    Image.new(mode, size, "#804020").save(stream, kind, **more)
    return stream.getvalue()


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


@pytest.mark.slow
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
        "end twice": photo_of(5) + b"and more\xff\xd9",
    }


@pytest.mark.parametrize("what", ["exif", "comment", "profile", "end", "end twice"])
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
