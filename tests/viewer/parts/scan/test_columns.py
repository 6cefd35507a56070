"""The page asks which columns are x, y and z where a text does not say it, with its first lines."""

import pytest

from stair_inspector.errors import ColumnsUnclear, ConfigError
from stair_inspector.params import Params
from stair_inspector.viewer.app import App
from stair_inspector.viewer.bridge.markup import list_key
from stair_inspector.viewer.parts.scan.columns import columns_html
from tests.synthetic import Stair
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import WirePage, await_that


def test_lines_of_a_file_are_no_markup():
    html = columns_html(ColumnsUnclear("a", ("<b>1</b> 2 3",), ("x,y,z", "-,x,y,z")), "uuid")
    assert "&lt;b&gt;1&lt;/b&gt; 2 3" in html
    assert html.count('data-testid="columns-answer"') == 2
    assert ">-,x,y,z</button>" in html


@pytest.fixture
def asked(tmp_path):
    """A page with a numbered list of points open."""
    points, _ = Stair(noise=0.002, risers=True).sample()
    path = tmp_path / "numbered.csv"
    path.write_text("".join(f"{k},{x:.4f},{y:.4f},{z:.4f}\n" for k, (x, y, z) in enumerate(points.tolist())))
    app = App([path], Params(), port=0, saves_projects=False)
    page = WirePage(app)
    try:
        await_that(lambda: part_of(page.session, "scan").columns.asked.content, "nothing is asked")
        yield page
    finally:
        page.close()
        app.stop()


def test_the_page_asks_shows_the_first_lines_and_measures_with_the_answer(asked):
    session = asked.session
    tool = part_of(session, "scan").columns
    assert "\n1,-" in tool.asked.content
    assert ">-,x,y,z</button>" in tool.asked.content
    with pytest.raises(ConfigError, match="the list has changed since"):
        tool.take("columns 5 1:0")
    tool.take(f"columns {list_key(('x,y,z', '-,x,y,z'))} 2:0")
    shown = asked.await_result()
    assert session.editor.work.params.columns == "-,x,y,z"
    assert len(shown.inspection.steps) == 5
    assert tool.asked.content == ""
    # Another answer is written, and counts when it is applied.
    session.editor.controls._controls["columns"].value = "x,y,z,-"
    tool.apply()
    assert session.editor.work.params.columns == "x,y,z,-"
