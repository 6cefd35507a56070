"""What the report's table of settings calls them."""

import pytest

from stair_inspector.content.settings_tables import settings_table
from stair_inspector.params import Params


@pytest.mark.parametrize(
    ("setting", "meaning"),
    [
        ("levels.eps_m", "vertical reach ε_z"),
        ("edges.front_percentile", "front edge, paper's α_f"),
        ("edges.back_percentile", "back edge, paper's α_b"),
        ("edges.side_percentile", "paper's side"),
        ("method", ""),
    ],
)
def test_the_meaning_of_a_setting_is_its_title_and_the_papers_symbol(setting, meaning):
    (row,) = [row for row in settings_table(Params()).rows if row[0] == setting]
    assert row[1] == meaning
