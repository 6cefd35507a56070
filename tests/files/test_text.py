"""Text as people export it: how rows are written, names, units, titles; what cannot be told is asked."""

import copy
import tracemalloc

import numpy as np
import pytest

from stair_inspector import cli
from stair_inspector.columns import parse_columns
from stair_inspector.errors import ColumnsUnclear, ConfigError, ReadError
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import read_scan
from stair_inspector.files.text_scan import read_text
from stair_inspector.params import Params
from tests.files.damage import N_DAMAGED, check_form, n_read_of_damaged

POINTS = np.array([[1.125, 2.25, -0.5], [1.5, 2.75, 0.25], [10.25, 3.0, 1.75], [4.125, 3.5, 2.0]])


def rows(separator=" ", comma=False, before=(), behind=(), end="\n", quote=""):
    """The points as text, with cells before and behind them that are made from the number of the row."""
    lines = []
    for k, point in enumerate(POINTS.tolist()):
        cells = [f"{quote}{value:.3f}{quote}" for value in point]
        cells = [cell.replace(".", ",") for cell in cells] if comma else cells
        lines.append(separator.join([*(made(k) for made in before), *cells, *(made(k) for made in behind)]) + end)
    return "".join(lines)


def called(k):
    return f"P{k + 1}"


def called_with_blank(k):
    return f"Point {k + 1}"


def code(k):
    return ("FL", "", "ST", "FL")[k]


READ = {
    "unit in brackets": ("X [m],Y [m],Z [m]\n" + rows(","), "m"),
    "unit in parentheses": ("x(mm) y(mm) z(mm)\n" + rows(), "mm"),
    "unit after blanks": ("X [mm]   Y [mm]   Z [mm]\n" + rows("   "), "mm"),
    "unit after underscores": ("x_cm;y_cm;z_cm\n" + rows(";", comma=True), "cm"),
    "row of units": ("E,N,H\n[ft],[ft],[ft]\n" + rows(","), "ft"),
    "unit in a remark": ("# exported today\n# units: inches\n" + rows(), "in"),
    "easting": ("Easting,Northing,Elevation\n" + rows(","), None),
    "german": ("Punkt;Rechtswert;Hochwert;Höhe\n" + rows(";", comma=True, before=[called]), None),
    "in Latin-1": (("X;Y;Höhe [m]\n" + rows(";", comma=True)).encode("latin-1"), "m"),
    "names first": ("Name X Y Z\n" + rows(before=[called]), None),
    "names first, unnamed": (rows(before=[called]), None),
    "names with blanks": (rows("\t", before=[called_with_blank]), None),
    "names and codes": (rows(",", before=[called_with_blank], behind=[code]), None),
    "names that are mixed": ("id,x,y,z\n" + rows(",", before=[lambda k: ("7", "8A", "", "9")[k]]), None),
    "trailing separators": (rows(",", end=",\n"), None),
    "trailing separators below names": ("x;y;z\n" + rows(";", comma=True, end=";\n"), None),
    "trailing separators of all": ("x;y;z;\n" + rows(";", comma=True, end=";\n"), None),
    "titles": ("Scan of the stair, 2024-05-01\nHouse 12\n\nX;Y;Z\n" + rows(";"), None),
    "remarks everywhere": ("# a\n// b\n; c\n! d\n" + rows(end="\n# between\n") + "! end\n; end\n% end\n// end", None),
    "remarks behind rows": (rows(end=" # a\n") + "9 9 9 // last\n", None),
    "quoted": (rows(",", quote='"'), None),
    "quoted decimal commas": (rows(",", quote='"', comma=True), None),
    "quoted names": (
        '"Name","X","Y","Z"\n' + rows(",", quote='"', before=[lambda k: f'"Stair, {k}"']),
        None,
    ),
    "blanks and tabs": ("  1.125 \t 2.25   -0.5\n\t1.5\t2.75 0.25\n 10.25 3  1.75\n4.125\t\t3.5 2\n", None),
    "decimal commas between blanks": (rows(comma=True), None),
    "decimal commas between tabs": (rows("\t", comma=True), None),
    "Fortran": (
        "".join(
            "  ".join(f"{v / 10:.9E}".replace("E-0", "D-0").replace("E+0", "D+0") for v in p) + "\n"
            for p in POINTS * 10
        ),
        None,
    ),
    "rows without a name": (",x,y,z\n" + rows(",", before=[str]), None),
    "rows with one name less": ('"x" "y" "z"\n' + rows(before=[lambda k: f'"{k + 1}"']), None),
    "ParaView": ('"Points:0","Points:1","Points:2"\n' + rows(","), None),
    "DOS end": (rows() + "\x1a", None),
    "bars": ("x|y|z\n" + rows("|"), None),
    "semicolon rows with an empty first cell": (rows(";", comma=True, before=[lambda k: ""]), None),
}


def read(tmp_path, content, columns="auto", name="a.txt", unit="auto"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_scan(path, unit, columns=columns)


@pytest.mark.parametrize("name", READ)
def test_text_is_read(tmp_path, name):
    content, unit = READ[name]
    scan = read(tmp_path, content, unit="auto" if unit else "m")
    metres = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}[unit or "m"]
    assert np.array_equal(scan.points[:4], POINTS * metres)
    assert scan.unit == (unit or "m")
    assert ("unit_in_header" in [note.code for note in scan.notes]) == (unit is not None)
    assert ("title_skipped" in [note.code for note in scan.notes]) == (name == "titles")


def test_columns_say_what_the_file_does_not(tmp_path):
    content = "".join(f"{k} {x} {y} {z} 7 1 2 3\n" for k, (x, y, z) in enumerate(POINTS.tolist()))
    scan = read(tmp_path, content, "-,z,x,y,i,r,g,b")
    assert np.array_equal(scan.points, POINTS[:, [1, 2, 0]])
    assert scan.colors.tolist() == [[1, 2, 3]] * 4
    assert scan.notes[0].code == "unit_guessed"
    # Columns behind those that are named are not read, and names in the file do not count.
    assert np.array_equal(read(tmp_path, "a b c d e f g h\n" + content, "skip,x,y,z").points, POINTS)
    normals = read(tmp_path, "1 0 0 1 2 3\n", "nx,ny,nz,x,y,z").normals
    assert normals.tolist() == [[1.0, 0.0, 0.0]]
    six = read(tmp_path, "1,125,2,25,3,5\n", "x,y,z")
    assert six.points.tolist() == [[1.0, 125.0, 2.0]]
    with pytest.raises(ReadError, match=r"lines have 8 columns .* but --columns names 9; name as many or fewer"):
        read(tmp_path, content, "x,y,z,-,-,-,-,-,-")
    with pytest.raises(ReadError, match="line 1 holds 'P1' where a number is expected"):
        read(tmp_path, rows(before=[called]), "x,y,z")


UNCLEAR = {
    "numbered": ("".join(f"{k} {k / 7} 1.5 2.5\n" for k in range(12)), ("x,y,z", "-,x,y,z")),
    "numbered with gaps": ("".join(f"{(7 * k) % 13} {k / 7} {k / 3} 2.5\n" for k in range(12)), ("x,y,z", "-,x,y,z")),
    "times": ("".join(f"{k / 9} {k % 5} {k % 4} {k % 3}\n" for k in range(12)), ("x,y,z", "-,x,y,z")),
    "unknown names": ("across along up\n" + rows(), ("x,y,z",)),
    "two heights": ("E,N,H,Elevation\n" + rows(",", behind=[str]), ("x,y,z", "x,y,-,z")),
    "too few names": ("x y z\n" + rows(behind=[lambda k: str(k * k)]), ("x,y,z", "-,x,y,z")),
    "text between": ("".join(f"{x} m {y} m {z} m\n" for x, y, z in POINTS.tolist()), ("x,-,y,-,z",)),
}


def cloud(scale=1.0, digits=3):
    """Points of a stair at random, with as many decimals, in a unit of which so many are a metre."""
    across, along = np.random.default_rng(4).uniform((-0.6, 0.0), (0.6, 1.4), (60, 2)).T
    return np.round(np.column_stack([across, along, 0.17 * np.floor(along / 0.28)]) * scale, digits)


def written(*parts):
    return "".join(" ".join(f"{value:.10g}" for value in row) + "\n" for row in np.column_stack(parts))


N = np.arange(60)
WHOLE = np.random.default_rng(5).integers(0, 255, (60, 3))
BEFORE_POINTS = {
    "a time that repeats": ((N // 5 / 10, cloud()), 1),
    "a time and an intensity": ((N // 5 / 10, cloud(), WHOLE[:, 0]), 1),
    "row and column": ((N // 8, N % 8, cloud()), 2),
    "row, column and colours": ((N // 8, N % 8, cloud(), WHOLE), 2),
    "scan and number": ((0 * N + 1, N, cloud()), 2),
    "colours": ((WHOLE, cloud()), 3),
    "colours before millimetres": ((WHOLE, cloud(1000.0, 0)), 3),
    "intensity": ((WHOLE[:, 0] / 255, cloud()), 1),
    "numbers that fall": ((60 - N, cloud(1000.0, 0)), 1),
    "numbers in any order": ((np.random.default_rng(6).permutation(60), cloud(1000.0, 0)), 1),
    "a column that is the same": ((0 * N + 0.5, cloud()), 1),
}


@pytest.mark.parametrize("name", BEFORE_POINTS)
def test_columns_before_the_points_are_asked_for(tmp_path, name):
    parts, place = BEFORE_POINTS[name]
    content = written(*parts)
    with pytest.raises(ColumnsUnclear, match="so it is not clear which columns are x, y and z") as caught:
        read(tmp_path, content)
    answer = caught.value.proposals[1]
    assert answer == "-," * place + "x,y,z"
    assert len(read(tmp_path, content, answer).points) == 60


def test_two_coordinates_behind_a_number_are_asked_for(tmp_path):
    with pytest.raises(ColumnsUnclear, match="first column numbers the lines"):
        read(tmp_path, written(N, cloud()[:, :2]))


BEHIND_POINTS = {
    "nothing": (),
    "an intensity": (WHOLE[:, 0],),
    "colours": (WHOLE,),
    "an intensity and colours": (WHOLE[:, 0], WHOLE),
    "normals": (np.tile([0.0, 0.6, 0.8], (60, 1)),),
}


@pytest.mark.parametrize("scale", [1.0, 1000.0])
@pytest.mark.parametrize("name", BEHIND_POINTS)
def test_points_without_names_are_read_in_any_order(tmp_path, name, scale):
    points = cloud(scale, 3 if scale == 1.0 else 0)
    in_order = points[np.argsort(points[:, 0])]
    is_told = scale == 1.0 or name not in ("an intensity", "an intensity and colours")
    for each in (points, in_order) if is_told else (points,):
        scan = read(tmp_path, written(each, *BEHIND_POINTS[name]), unit="m")
        assert np.allclose(scan.points + scan.origin_m, each)
        assert (scan.colors is not None) == ("colours" in name)
        assert (scan.normals is not None) == (name == "normals")


@pytest.mark.parametrize("name", UNCLEAR)
def test_what_cannot_be_told_is_asked(tmp_path, name):
    content, proposals = UNCLEAR[name]
    with pytest.raises(ColumnsUnclear) as caught:
        read(tmp_path, content)
    check_form(tmp_path / "a.txt", str(caught.value))
    assert f"give --columns {' or --columns '.join(proposals)}" in str(caught.value)
    assert caught.value.proposals == proposals
    assert content.splitlines()[0] in caught.value.lines
    # It comes out of the process that reads.
    again = copy.copy(caught.value)
    assert (str(again), again.lines, again.proposals) == (str(caught.value), caught.value.lines, proposals)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("X [m],Y [m],Z [mm]\n" + rows(","), "axes in different units (m, m, mm)"),
        ("X [px],Y [px],Z [px]\n" + rows(","), "coordinates in 'px', which is not read"),
        ("1.12x 2.25 -0.5\n" + rows(), "line 1 holds '1.12x' where a number is expected"),
        ("x y z\n1.12x 2.25 -0.5\n" + rows(), "line 2 holds '1.12x'"),
        ("1 2 3 4\n5 six 7 8\n", "line 2 holds 'six'"),
        ("1,125,2,25,3,5\n" * 3, "seems to have decimal commas between commas"),
        ("x,y,z\n" + "1,125,2,25,3,5\n" * 3, "its header names 3 columns but its lines have 6"),
        ('"1.234,5","2","3"\n"2","3","4"\n', "line 1 holds"),
        ("x,y,z,r,g,r\n1,2,3,4,5,6\n", "names the column 'red' twice"),
        ("title\n" * 2000 + rows(), "line 1 ('title') is neither numbers nor a header"),
    ],
)
def test_text_that_is_refused(tmp_path, content, words):
    with pytest.raises(ReadError) as caught:
        read(tmp_path, content)
    check_form(tmp_path / "a.txt", str(caught.value))
    assert words in str(caught.value)


THOUSANDS = ((1098, 950, 170), (2950, 1000, 0), (999, -1001, 340))


@pytest.mark.parametrize("columns", ["auto", "x,y,z"])
@pytest.mark.parametrize(
    ("mark", "separator", "quote"), [(",", ",", '"'), (",", "\t", ""), (".", ";", ""), (",", ";", ""), (".", " ", "")]
)
def test_marks_between_thousands_are_no_decimals(tmp_path, mark, separator, quote, columns):
    cells = [[f"{value:,}".replace(",", mark) for value in row] for row in THOUSANDS]
    quoted = [[f"{quote}{cell}{quote}" if mark in cell else cell for cell in row] for row in cells]
    content = "".join(separator.join(row) + "\n" for row in quoted)
    shown = cells[0][0]
    with pytest.raises(ReadError, match=rf"part the thousands of its coordinates \('{shown}' beside whole"):
        read(tmp_path, content, columns)
    # Metres to the millimetre have the mark in every cell, and metres without trailing zeros fewer digits somewhere.
    metres = "".join(f"{x / 1000:.3f}\t{y / 1000:.3f}\t{z / 1000:.3f}\n" for x, y, z in THOUSANDS)
    for readable in (metres, metres.replace("0.170", "1.700"), "1.125 2 3\n2 3.5 1\n", "1.125 2 3\n4 2 1000\n"):
        assert len(read(tmp_path, readable, columns).points) in (2, 3)


@pytest.mark.parametrize("columns", ["x,y", "x,y,z,x", "x,y,z,w", "x;y;z", "-", "x,y,z,r,g,b,red", "x" * 5000])
def test_impossible_columns_are_a_sentence(columns):
    with pytest.raises(ConfigError, match=r"columns: got .* name x, y and z once each"):
        Params(columns=columns)
    assert parse_columns("") == parse_columns(" auto ") == ()


def test_the_command_line_takes_columns_that_begin_with_a_dash(tmp_path, capsys):
    numbered = tmp_path / "a.xyz"
    numbered.write_text("".join(f"{k} {k / 7} 1.5 2.5\n" for k in range(12)))
    assert cli.main(["measure", str(numbered), "-o", str(tmp_path / "out")]) == 3
    assert "give --columns x,y,z or --columns -,x,y,z" in capsys.readouterr().err
    # Read, and nothing is warned of; that these twelve points are no stair is another matter.
    cli.main(["measure", str(numbered), "-o", str(tmp_path / "out"), "--columns", "-,x,y,z"])
    assert "columns" not in capsys.readouterr().err
    assert cli.main(["measure", str(numbered), "-o", str(tmp_path / "out"), "--columns", "x,y"]) == 2
    assert "name x, y and z once each" in capsys.readouterr().err


def test_columns_for_a_format_that_names_its_own_are_said_to_change_nothing(tmp_path):
    (tmp_path / "a.ply").write_bytes(ply_bytes(np.random.default_rng(1).random((50, 3))))
    for columns, is_said in (("auto", False), ("z,y,x", True)):
        scan = read_scan(tmp_path / "a.ply", "m", columns=columns)
        assert ("columns_not_asked" in [note.code for note in scan.notes]) is is_said
    again = read_scan(tmp_path / "a.ply", "m")
    assert np.array_equal(scan.points, again.points)


DAMAGED = ("german", "remarks behind rows", "quoted decimal commas", "Fortran", "titles", "blanks and tabs")


@pytest.mark.parametrize("name", DAMAGED)
def test_two_hundred_damaged_texts_give_a_sentence_or_a_scan(name):
    assert 0 < n_read_of_damaged("a.csv", READ[name][0].encode(), seed=9) < N_DAMAGED


@pytest.mark.parametrize("separator", [" ", ";"])
def test_text_takes_a_bounded_multiple_of_its_size(tmp_path, separator):
    content = ("x y z\n".replace(" ", separator) + rows(separator, comma=separator == ";") * 2000).encode()
    (tmp_path / "a.csv").write_bytes(content)
    tracemalloc.start()
    read_text(content)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # Three doubles a line of 18 bytes or more, and the same again while they are put side by side.
    assert peak < 8 * len(content)
