"""The house keeps its order: read from the imports themselves."""

import ast
import functools
import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import stair_inspector.model
from stair_inspector.quantities import PAPER_QUANTITIES, QUANTITIES

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "stair_inspector"
ROOMS = (
    ("errors", "priors"),
    ("geometry",),
    ("declarations",),
    ("overrules", "columns", "stated_uncertainty"),
    ("params",),
    ("model",),
    ("measured", "quantity_types"),
    ("quantities",),
    ("units",),
    ("stages", "codes", "simulation"),
    ("memo",),
    ("pipeline",),
    ("stability",),
    ("comparison",),
    ("files",),
    ("content",),
    ("pictures",),
    ("drawings",),
    ("writers",),
    ("interface",),
    ("viewer",),
    ("cli",),
    ("__main__",),
)
"""From the lowest floor to the highest; a room may import itself and what lies below, not its neighbours."""
RANK = {room: rank for rank, rooms in enumerate(ROOMS) for room in rooms}
CORE = {
    "errors",
    "priors",
    "geometry",
    "declarations",
    "overrules",
    "columns",
    "stated_uncertainty",
    "params",
    "model",
    "measured",
    "quantity_types",
    "quantities",
    "units",
    "stages",
    "codes",
    "simulation",
    "memo",
    "pipeline",
    "stability",
    "comparison",
}
HEAVY = {"open3d", "pandas", "trimesh", "sklearn", "scipy", "typst", "ezdxf", "xlsxwriter"}
"""Imported only inside the functions that need them: each takes up to seconds."""
TRUTH = PACKAGE / "files" / "simulations.py"
"""May list quantities: what a simulated stair truly is must not be defined by what measures it."""
FILES = sorted(PACKAGE.rglob("*.py"))
ALL_FILES = frozenset(FILES)


def room_of(file):
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


@functools.cache
def tree_of(file):
    """A file's syntax tree, parsed once for all tests."""
    return ast.parse(file.read_text(encoding="utf-8"))


def what_is_wrong(find, files):
    """What ``find`` finds in each file, by the file's name; of all files at once, as each takes a moment."""
    found = {str(file.relative_to(PACKAGE)): find(file) for file in files}
    assert found, "there is a file to look at"
    return {name: wrong for name, wrong in found.items() if wrong}


def imports_of(tree):
    """(module, imported at once, not only for the type checker) of every import in a module's tree."""

    found = []

    def walk(node, at_once):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.Import):
                found.extend((alias.name, at_once) for alias in child.names)
            elif isinstance(child, ast.ImportFrom):
                assert child.level == 0, "imports are absolute"
                found.append((child.module, at_once))
                # "from stair_inspector import files" names a room as well.
                found.extend((f"{child.module}.{alias.name}", at_once) for alias in child.names)
            is_later = isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef))
            is_for_types = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)
            # No expression holds a statement.
            if not isinstance(child, ast.expr):
                walk(child, at_once and not is_later and not is_for_types)

    walk(tree, True)
    return found


@functools.cache
def imports_in(file):
    return tuple(imports_of(tree_of(file)))


def rooms_imported(file):
    parts = (module.split(".") for module, _ in imports_in(file))
    return {part[1] for part in parts if part[0] == "stair_inspector" and len(part) > 1 and part[1] in RANK}


def libraries_imported(file):
    return {module.split(".")[0] for module, _ in imports_in(file)}


def test_imports_go_one_way():
    def too_high(file):
        room = room_of(file)
        if room == "__init__":
            # The package itself names what it offers to the type checker, and looks it up when it is asked for.
            return {module for module, at_once in imports_in(file) if at_once and module.startswith("stair_inspector")}
        assert room in RANK, f"{room} has no place in the order of rooms"
        return {other for other in rooms_imported(file) if other != room and RANK[other] >= RANK[room]}

    assert what_is_wrong(too_high, FILES) == {}


def test_the_core_knows_neither_disk_nor_page():
    core = [file for file in FILES if room_of(file) in CORE]
    assert what_is_wrong(lambda file: libraries_imported(file) & {"viser", "tyro"}, core) == {}
    assert what_is_wrong(lambda file: rooms_imported(file) & {"files", "viewer", "cli"}, core) == {}


def test_slow_libraries_are_imported_inside_functions():
    def slow(file):
        return {module for module, at_once in imports_in(file) if at_once and module.split(".")[0] in HEAVY}

    assert what_is_wrong(slow, FILES) == {}


def test_the_values_of_the_model_have_one_way_in():
    way_in = {f"stair_inspector.model.{name}" for name in stair_inspector.model.__all__}

    def other_ways(file):
        return {module for module, _ in imports_in(file) if module.startswith("stair_inspector.model.")} - way_in

    assert what_is_wrong(other_ways, [file for file in FILES if room_of(file) != "model"]) == {}


def test_only_the_viewer_knows_viser():
    others = [file for file in FILES if room_of(file) != "viewer"]
    assert what_is_wrong(lambda file: libraries_imported(file) & {"viser"}, others) == {}


def test_only_the_command_line_prints_and_exits():
    def calls(file):
        called = {ast.unparse(node.func) for node in ast.walk(tree_of(file)) if isinstance(node, ast.Call)}
        return called & {"print", "exit", "quit", "sys.exit", "os._exit", "input"}

    assert what_is_wrong(calls, [file for file in FILES if room_of(file) in CORE | {"files"}]) == {}


def names_of_quantities():
    """Every name of a quantity in code: with and without its unit, on cards, over columns."""
    names = {name for each in PAPER_QUANTITIES for name in (each.column, f"{each.name}_mm")}
    for each in QUANTITIES:
        names |= {each.name, each.label, each.words, each.head, each.column, each.lines_field, f"{each.name}_mm"}
    return names - {""}


def quantities_listed(tree, names):
    """(line, names) of every literal tuple, list, set or dict that names three quantities or more.

    A name counts as a text, as the first of a pair or triple, and as a field that is read: ``step.rise_m``.
    """
    for node in ast.walk(tree):
        if isinstance(node, ast.Dict):
            entries = node.keys
        elif isinstance(node, (ast.Tuple, ast.List, ast.Set)):
            entries = [
                each.elts[0] if isinstance(each, (ast.Tuple, ast.List)) and each.elts else each for each in node.elts
            ]
        else:
            continue
        words = [each.value for each in entries if isinstance(each, ast.Constant) and isinstance(each.value, str)]
        fields = [each.attr for each in entries if isinstance(each, ast.Attribute) and "_" in each.attr]
        said = [word for word in words + fields if re.sub("^(mean|max_adjacent|paper)_", "", word) in names]
        if len(said) >= 3:
            yield node.lineno, said


def test_quantities_are_listed_in_one_place():
    names = names_of_quantities()
    files = [file for file in FILES if file not in (PACKAGE / "quantities.py", TRUTH)]
    listed = what_is_wrong(lambda file: list(quantities_listed(tree_of(file), names)), files)
    assert listed == {}, "read them from quantities.py"


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("x = ('rise', 'going', 'width')", ["rise", "going", "width"]),
        ("x = ['rise_m', 'mean_going_m', 'paper_h_m', 'other']", ["rise_m", "mean_going_m", "paper_h_m"]),
        ("x = {'tread depth': 1, 'pitch': 2, 'fall': 3}", ["tread depth", "pitch", "fall"]),
        ("x = (('rise', 1), ('going', 2), ('pitch', 3))", ["rise", "going", "pitch"]),
        ("x = (step.rise_m, step.going_m, step.width_m)", ["rise_m", "going_m", "width_m"]),
        ("x = ('rise', 'going', 'nothing')", None),
        ("x = f('rise', 'going', 'width')", None),
    ],
)
def test_the_finder_of_lists_of_quantities_sees_every_kind(source, said):
    assert list(quantities_listed(ast.parse(source), names_of_quantities())) == ([] if said is None else [(1, said)])


def public_names(tree):
    """(kind, name) of every public type and function at the top of a module: classes, aliases of types, functions."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            found = "type", node.name
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            found = "function", node.name
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            # A name in capitals and small letters is an alias or a variable of types, unless a value is kept in it.
            if not (name[:1].isupper() and any(letter.islower() for letter in name)):
                continue
            found = "type", name
        else:
            continue
        if not found[1].startswith("_"):
            yield found


def test_every_public_name_of_a_type_or_function_means_one_thing():
    places = {}
    for file in FILES:
        for kind, name in public_names(tree_of(file)):
            # Each command is a file whose "run" runs it; the interface calls a function as what it hands on to.
            if kind == "type" or (name not in ("main", "run") and room_of(file) != "interface"):
                places.setdefault((kind, name), []).append(str(file.relative_to(PACKAGE)))
    assert {name: files for (_, name), files in places.items() if len(files) > 1} == {}


def test_the_finder_of_public_names_sees_types_aliases_and_functions():
    source = "class A: ...\ndef f(): ...\nPair = tuple[int, int]\nLIMIT = 3\n_C = int\nclass _D: ...\n"
    assert list(public_names(ast.parse(source))) == [("type", "A"), ("function", "f"), ("type", "Pair")]


def test_the_reader_of_imports_sees_every_kind_of_import():
    source = (
        "import open3d\nfrom stair_inspector import files\nif TYPE_CHECKING:\n    import viser\n"
        "def f():\n    import trimesh.util\nclass A:\n    import sklearn\n"
        "try:\n    import scipy\nexcept ImportError: ...\n"
    )
    found = dict(imports_of(ast.parse(source)))
    assert found == {
        "open3d": True,
        "stair_inspector": True,
        "stair_inspector.files": True,
        "viser": False,
        "trimesh.util": False,
        "sklearn": True,
        "scipy": True,
    }


STAGES = (
    ("coordinate_steps", "copies", "density", "layers", "reach", "thinned", "camera_frames", "readings"),
    (
        "examine",
        "station_motion",
        "known_stations",
        "station_layers",
        "order_shifts",
        "looked_through",
        "seen_through",
        "stations",
    ),
    ("up_questions", "floor_planes", "orient", "levels", "sparse", "treads", "paper"),
    ("region", "dither", "plan_cells", "patches", "bar_peaks", "bars", "rejects"),
    ("links", "pace", "gaps", "missing_feet", "runs", "run_ends", "flights"),
    ("planes", "arcs", "climbs", "foot", "runners", "thick_runners", "things", "narrow_slots", "split_flights"),
    ("undersides", "pieces", "plumb"),
    ("hidden", "pooled", "near_points", "block_layers", "edge_finder", "nosing_heights", "step_shapes", "seen_ends"),
    ("face_noise",),
    ("nosings",),
    (
        "doubt",
        "parts",
        "flight_values",
        "step_values",
        "unobserved",
        "side_shifts",
        "survey",
        "beyond",
        "blurred",
        "impossible",
    ),
    ("hopeless", "causes", "units", "verdict", "suggest", "retry", "withhold"),
)
"""In the order of the recipe: the scan, the paper, surfaces, flights, up from them, edges, values, the answer."""


def test_stages_import_only_what_comes_before_them_in_the_recipe():
    order = [stage for group in STAGES for stage in group]
    files = {file.stem: file for file in FILES if room_of(file) == "stages" and file.stem != "__init__"}
    assert set(order) == files.keys()
    for place, stage in enumerate(order):
        modules = {module.removeprefix("stair_inspector.stages.") for module, _ in imports_in(files[stage])}
        assert modules & set(order[place:]) == set(), stage


OF_STAIRS = re.compile(
    r"(RISE|GOING|PITCH|TREAD|LANDING|OVERHANG|STRIDE|HEADROOM|BARS?|SLAB|WIDTH|WINDING)S?_(M|M2|DEG)$"
)
"""Names of constants that say what staircases are like."""
MEASURES_OF_STAIRS = re.compile(r"_?(rise|going|pitch|width|depth|tread_depth|stride)s?(_m|_deg)?$")


def numbers_of_stairs(tree):
    """What says in numbers of its own what a staircase is: named constants, and limits of a rise, a going, a pitch."""
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], (ast.Name, ast.Tuple)):
            targets = getattr(node.targets[0], "elts", node.targets)
            values = node.value.elts if isinstance(node.value, ast.Tuple) and len(targets) > 1 else [node.value]
            for target, value in zip(targets, values * (len(targets) if len(values) == 1 else 1), strict=True):
                if OF_STAIRS.search(target.id) and not ast.unparse(value).startswith("priors."):
                    yield target.id
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            names = [getattr(side, "id", getattr(side, "attr", "")) for side in sides]
            numbers = [side.value for side in sides if isinstance(side, ast.Constant)]
            if any(map(MEASURES_OF_STAIRS.match, names)) and any(
                isinstance(number, float) and number for number in numbers
            ):
                yield ast.unparse(node)


def test_what_staircases_are_like_stands_in_priors():
    files = [file for file in FILES if room_of(file) in ("stages", "geometry")]
    assert what_is_wrong(lambda file: list(numbers_of_stairs(tree_of(file))), files) == {}


def test_the_finder_of_numbers_of_stairs_sees_constants_and_limits():
    source = "_LEAST, _LEAST_RISE_M = 2, 0.06\n_USUAL_GOING_M = priors.USUAL_GOING_M\nif going_m > 0.1 > x.y: ...\n"
    assert list(numbers_of_stairs(ast.parse(source))) == ["_LEAST_RISE_M", "going_m > 0.1 > x.y"]


def test_no_file_is_longer_than_350_lines():
    lengths = {str(file.relative_to(PACKAGE)): len(file.read_text(encoding="utf-8").splitlines()) for file in FILES}
    assert {file for file, length in lengths.items() if length > 350} == set()


RUN = 10
"""So many lines that stand twice, one after the other, are one thing said twice."""


def runs_of(source, length=RUN):
    """Every run of so many lines with its first line's number; imports and docstrings are no such lines."""
    left_out = set()
    for node in ast.walk(ast.parse(source)):
        is_text = (
            isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        )
        if is_text or isinstance(node, ast.Import | ast.ImportFrom):
            left_out.update(range(node.lineno, node.end_lineno + 1))
    lines = [
        (number, line.strip())
        for number, line in enumerate(source.splitlines(), 1)
        if line.strip() and number not in left_out
    ]
    for first in range(len(lines) - length + 1):
        yield tuple(line for _, line in lines[first : first + length]), lines[first][0]


def test_no_run_of_ten_lines_stands_twice():
    places = {}
    for file in FILES:
        for run, number in runs_of(file.read_text(encoding="utf-8")):
            places.setdefault(run, []).append(f"{file.relative_to(PACKAGE)}:{number}")
    assert [found for found in places.values() if len(found) > 1] == []


def test_the_finder_of_runs_leaves_out_imports_and_docstrings():
    source = 'import ast\n\n"""Text."""\n\n\ndef f():\n    """Text\n    goes on."""\n    return 1\n'
    assert list(runs_of(source, 2)) == [(("def f():", "return 1"), 6)]


def test_the_recipe_stays_under_a_hundred_lines():
    assert len((PACKAGE / "pipeline.py").read_text(encoding="utf-8").splitlines()) < 100


def test_the_top_level_holds_only_what_is_allowed():
    needed = {"pyproject.toml", "stair_inspector", "static_configs", "tests", "sample_scans", "findings", "README.md"}
    built = {line.rstrip("/") for line in (ROOT / ".gitignore").read_text().split() if "*" not in line}
    names = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    assert {name for name in names - needed - built if not name.endswith(".egg-info")} == set()
    assert needed <= names


OF_VISERS_PAGE = re.compile(
    r"\b_impl\b|_websock|\bviser\._|_live_connections|_gui_input_handle|__viser|<script|<style|\.mantine-"
    r"|\bon(click|key\w+|load|error|pointer\w+)=|\bdocument\.(add|body|get|query|title)|\bevent\.(key|target)\b"
)
"""Private names of viser and its client, and scripts, styles and event handlers of the page."""


def test_only_the_bridge_knows_what_is_private_to_viser_and_its_page():
    assert OF_VISERS_PAGE.search("handle._impl.uuid")
    assert OF_VISERS_PAGE.search('<b onclick="f()">')
    outside = [file for file in (PACKAGE / "viewer").rglob("*.py") if "bridge" not in file.parts]
    assert len(outside) > 40
    found = {
        f"{file.relative_to(PACKAGE)}: {line.strip()}"
        for file in outside
        for line in file.read_text(encoding="utf-8").splitlines()
        if OF_VISERS_PAGE.search(line)
    }
    assert found == set()


VIEWER = ("bridge", "compute", "state", "scene", "parts", "page", "app")
"""The rooms of the viewer, from the lowest: each may import what lies below it."""


def place_in_viewer(module):
    """(floor, part) of a module of the viewer: what the parts share lies below them, and no part knows another."""
    names = module.split(".")[2:]
    if not names:
        return -1, ""
    is_single = names[0] == "parts" and (PACKAGE / "viewer" / "parts" / (names[1:] or [""])[0]).is_dir()
    is_single = is_single and len(names) > 1
    return 2 * VIEWER.index(names[0]) + is_single, names[1] if is_single else ""


def test_the_viewer_has_few_names_at_its_top():
    names = {path.name for path in (PACKAGE / "viewer").iterdir() if path.name != "__pycache__"}
    assert names == {"__init__.py", *VIEWER[:5], "page.py", "app.py"}
    assert len(names) <= 8


def test_imports_go_one_way_inside_the_viewer():
    def wrong_ways(file):
        name = ".".join(("stair_inspector", *file.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
        floor, part = place_in_viewer(name)
        for module, _ in imports_in(file):
            if module.startswith("stair_inspector.viewer."):
                other_floor, other_part = place_in_viewer(module)
                if other_floor > floor:
                    yield f"{module}: lies above"
                if other_part not in ("", part) and file.name != "page.py":
                    yield f"{module}: a part knows no other part"

    files = [file for file in FILES if room_of(file) == "viewer"]
    assert what_is_wrong(lambda file: list(wrong_ways(file)), files) == {}


def files_imported(file):
    """The files of the package that a file imports, by name; the package itself looks up later what it offers."""
    for module, at_once in imports_in(file):
        if not at_once and file == PACKAGE / "__init__.py":
            continue
        place = ROOT.joinpath(*module.split("."))
        for found in (place.with_suffix(".py"), place / "__init__.py"):
            if found != file and found in ALL_FILES:
                yield found


def test_no_files_import_each_other_in_a_circle():
    imported = {file: set(files_imported(file)) for file in FILES}
    assert sum(map(len, imported.values())) > 1000
    # A package that hands on what its files hold imports them, and they do not import it.
    try:
        TopologicalSorter(imported).prepare()
    except CycleError as error:
        circle = [str(file.relative_to(PACKAGE)) for file in error.args[1]]
        pytest.fail(" imports ".join(circle[::-1]))


def test_the_viewer_says_what_its_values_are():
    said = [
        f"{file.relative_to(PACKAGE)}:{node.lineno}"
        for file in FILES
        if room_of(file) == "viewer"
        for node in ast.walk(tree_of(file))
        if isinstance(node, ast.Name) and node.id == "Any"
    ]
    assert len(said) < 20, said


def test_the_page_is_short_and_has_few_attributes():
    file = PACKAGE / "viewer" / "page.py"
    source = file.read_text(encoding="utf-8")
    assert len(source.splitlines()) <= 350
    kept = {
        node.attr
        for node in ast.walk(tree_of(file))
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and isinstance(node.value, ast.Name)
        and node.value.id == "self"
    }
    assert 5 < len(kept) <= 15


def test_tests_mirror_the_package():
    folders = {
        path.name for path in (ROOT / "tests").iterdir() if path.is_dir() and not path.name.startswith(("_", "."))
    }
    rooms = {path.name for path in PACKAGE.iterdir() if path.is_dir() and not path.name.startswith("_")}
    assert folders <= rooms | {"benchmarks", "browser"}
    assert {"geometry", "stages", "files"} <= folders


def test_no_file_names_a_machine():
    # Written so that this file does not contain what it looks for.
    places = re.compile("|".join(f"/{top}/" for top in ("work", "opt/venv", "root")))
    files = [*FILES, *(ROOT / "tests").rglob("*.py"), *(ROOT / "static_configs").rglob("*.*"), ROOT / "README.md"]
    assert [str(file) for file in files if places.search(file.read_text(encoding="utf-8"))] == []
