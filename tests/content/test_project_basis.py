"""What a project keeps for its report comes back as it was given, or is a sentence."""

import dataclasses
import io

import pytest
from PIL import Image

from stair_inspector.content.basis_files import basis_to_dict
from stair_inspector.content.fields import Checklist, ReportBasis, ReportFields
from stair_inspector.content.images import read_logo
from stair_inspector.content.project_basis import basis_of, titled
from stair_inspector.content.readings import TapeReading
from stair_inspector.errors import ConfigError
from stair_inspector.files.project_files import parse_project, project_bytes
from stair_inspector.files.projects import Project

SHA = "0123456789abcdef" * 4


def logo():
    stream = io.BytesIO()
    Image.new("RGB", (40, 20), (10, 90, 160)).save(stream, "PNG")
    return read_logo(stream.getvalue())


BASIS = ReportBasis(
    fields=ReportFields(client="Halle ß", purpose="two\nlines"),
    checklist=Checklist(lighting="two lamps are out"),
    readings=(
        TapeReading("rise", 0.171, step=2, u=0.0005, at=(1.0, -2.5, 0.34)),
        TapeReading("flight_run", 2.5, flight=1, note="tape 7"),
    ),
    logo=logo(),
    paper="us-letter",
)


@pytest.mark.parametrize("basis", [BASIS, ReportBasis()], ids=["full", "empty"])
def test_the_basis_comes_back_from_a_project_file(basis):
    project = Project("a.ply", SHA, report=basis_to_dict(basis))
    assert basis_of(parse_project(project_bytes(project), "a")) == basis


def test_the_reports_title_is_the_inspections_unless_it_has_its_own():
    assert titled(BASIS, "Hall, north stair").fields.title == "Hall, north stair"
    own = dataclasses.replace(BASIS, fields=ReportFields(title="Survey"))
    assert titled(own, "Hall, north stair") == own


@pytest.mark.parametrize(
    ("report", "words"),
    [
        ({"field": {}}, "a.stair.json: report: unknown key 'field'; did you mean 'fields'?"),
        ({"fields": {"cliend": "x"}}, "a.stair.json: report: fields: unknown key 'cliend'; did you mean 'client'?"),
        (
            {"readings": [{"quantity": "rise", "value": "x", "step": 1}]},
            "a.stair.json: reading of 'rise': value: got 'x'",
        ),
        ({"logo_base64": "x"}, "a.stair.json: report: logo: is no picture in base64; take it out"),
        ({"logo_base64": "QUJD"}, "a.stair.json: report: logo: is not a PNG or JPEG picture that can be read"),
        ({"paper": "a3"}, "a.stair.json: paper: got 'a3'; give one of a4, us-letter"),
    ],
)
def test_what_is_wrong_is_a_sentence(report, words):
    with pytest.raises(ConfigError) as error:
        basis_of(Project("a.ply", SHA, report=report), "a.stair.json")
    assert str(error.value).startswith(words)


def test_what_is_nested_too_deeply_is_a_sentence():
    deep = []
    for _ in range(100_000):
        deep = [deep]
    with pytest.raises(ConfigError, match=r"a\.stair\.json: (is nested too deeply|report: )"):
        basis_of(Project("a.ply", SHA, report={"fields": deep}), "a.stair.json")
