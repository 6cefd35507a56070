"""The benchmark runs, prints every row, and its two comparisons agree; its times are not judged here."""

import pytest

from tests.benchmarks.speed import HEAD, main


@pytest.mark.slow
def test_the_table_has_every_row_and_both_comparisons_agree(capsys):
    assert main(["--points", "50000", "--heights", "4000", "--repeats", "3"]) == 0
    title, head, *rows = capsys.readouterr().out.splitlines()
    assert title.startswith("50,000 points, 11 levels with risers, noise 2 mm;")
    assert head == HEAD
    names = ["run from scratch", "alpha_f change", "eps_z change", "m change", "theta_th change"]
    names += ["survey from scratch, up auto", "survey from scratch, up z"]
    names += ["edge source change, survey", "largest gap change, survey", "outer lines change, survey"]
    names += ["eps_z change, survey", "unit and up by the stair", "normals", "clustering 4,000 heights"]
    assert [row[:30].rstrip() for row in rows] == names
    assert all(float(row[30:42].replace(",", "")) > 0.0 for row in rows)
    assert [row[42:51].strip() for row in rows] == [
        *("", "5", "60", "60", "120"),
        *("", "", "150", "150", "150", ""),
        *("500", "", ""),
    ]
    assert all(float(row[51:63].replace(",", "")) > 0.0 for row in rows[1:])
    assert "found 11 levels" in rows[0]
    assert rows[-2].endswith("identical: True")
    assert rows[-1].endswith("same clusters: True")


@pytest.mark.slow
def test_the_comparison_with_scikit_learn_can_be_left_out(capsys):
    assert main(["--points", "20000", "--heights", "0", "--repeats", "1"]) == 0
    assert "clustering" not in capsys.readouterr().out
