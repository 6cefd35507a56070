"""The type checker reads the recipe: two arguments that stand in each other's place are an error."""

import ast
import copy
import re
from pathlib import Path

import pytest
from mypy import api

ROOT = Path(__file__).parent.parent
RECIPE = ROOT / "stair_inspector" / "pipeline.py"


def swaps(recipe):
    """(words, copy) of a function for each pair of neighbouring arguments of each of its calls, the two exchanged."""
    for number, call in enumerate(ast.walk(recipe)):
        if not isinstance(call, ast.Call):
            continue
        assert not any(isinstance(argument, ast.Starred) for argument in call.args), "nothing is hidden behind a star"
        for place in range(len(call.args) - 1):
            swapped = copy.deepcopy(recipe)
            arguments = list(ast.walk(swapped))[number].args
            arguments[place], arguments[place + 1] = arguments[place + 1], arguments[place]
            yield f"line {call.lineno}: {ast.unparse(arguments[place + 1])}, {ast.unparse(arguments[place])}", swapped


def module_of(recipes, imports):
    """A module of many recipes, and the lines of each."""
    text, lines = "\n".join(ast.unparse(line) for line in imports) + "\n", []
    for number, recipe in enumerate(recipes):
        recipe.name, recipe.decorator_list = f"recipe_{number}", []
        start = text.count("\n") + 1
        text += ast.unparse(recipe) + "\n"
        lines.append(range(start, text.count("\n") + 1))
    return text, lines


def errors_of(path):
    """(line, message) of what the type checker says about a file."""
    config = ("--config-file", str(ROOT / "pyproject.toml"), "--no-error-summary", "--hide-error-context")
    out, err, _ = api.run([*config, "--cache-dir", str(path.parent / "cache"), str(path)])
    assert err == ""
    found = [re.match(rf".*{path.name}:(\d+): error: (.*)", line) for line in out.splitlines()]
    return [(int(match[1]), match[2]) for match in found if match]


@pytest.mark.slow
def test_every_pair_of_arguments_of_the_recipe_that_is_swapped_fails_under_the_type_checker(tmp_path, monkeypatch):
    tree = ast.parse(RECIPE.read_text(encoding="utf-8"))
    (recipe,) = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    words, copies = zip(*swaps(recipe), strict=True)
    assert len(words) > 100
    text, lines = module_of([copy.deepcopy(recipe), *copies], imports)
    path = tmp_path / "swapped.py"
    path.write_text(text, encoding="utf-8")
    monkeypatch.chdir(ROOT)
    wrong = {line for line, _ in errors_of(path)}
    assert not wrong & set(lines[0]), "the recipe as it is has no error"
    assert [name for name, own in zip(words, lines[1:], strict=True) if not wrong & set(own)] == []


def test_swaps_are_of_neighbours_in_every_call():
    recipe = ast.parse("def f(): g(a, b, h(c, d), k=e)").body[0]
    assert {ast.unparse(copied.body[0]) for _, copied in swaps(recipe)} == {
        "g(b, a, h(c, d), k=e)",
        "g(a, h(c, d), b, k=e)",
        "g(a, b, h(d, c), k=e)",
    }
