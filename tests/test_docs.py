"""README and reference pages: their links lead somewhere, their examples run, and the README stays short and plain."""

import doctest
import re
import shlex
import tomllib
from pathlib import Path

import pytest

from stair_inspector.cli import main
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.rule_sets import list_rule_sets
from tests.synthetic import Stair

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
PAGES = sorted((ROOT / ".github" / "docs").glob("*.md"))
EACH_PAGE = pytest.mark.parametrize("page", [README, *PAGES], ids=lambda page: page.stem)
MOST_WORDS = 1500
MOST_WORDS_A_SENTENCE = 18.0


def blocks(page, language):
    """The code blocks of a page in one language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def commands(page):
    """The lines of a page's console blocks that begin with a prompt, without comments."""
    lines = [line for block in blocks(page, "console") for line in block.splitlines()]
    return [line[2:].partition("  #")[0].strip() for line in lines if line.startswith("$ ")]


def prose_of(page):
    """The sentences of a page: no code, no tables, no headings; each point of a list ends one."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    lines = [line for line in text.splitlines() if not line.startswith(("|", "#", "!"))]
    joined = re.sub(r"\n(?=- |\n)", ".\n", "\n".join(lines))
    sentences = re.split(r"(?<=[.:;?])\s+", re.sub(r"\]\([^)]*\)", "]", joined))
    return [sentence for sentence in sentences if len(sentence.split()) > 1]


def test_the_readme_is_short_and_plain():
    words = README.read_text(encoding="utf-8").split()
    assert len(words) <= MOST_WORDS
    lengths = [len(sentence.split()) for sentence in prose_of(README)]
    assert len(lengths) > 30
    assert sum(lengths) / len(lengths) < MOST_WORDS_A_SENTENCE


def test_every_reference_page_is_linked_from_the_readme():
    text = README.read_text(encoding="utf-8")
    assert len(PAGES) >= 7
    assert [page.name for page in PAGES if f"(.github/docs/{page.name})" not in text] == []


@EACH_PAGE
def test_links_and_pictures_lead_somewhere(page):
    targets = [
        target for target in re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8")) if "://" not in target
    ]
    assert [target for target in targets if not (page.parent / target).exists()] == []


@EACH_PAGE
def test_files_and_modules_that_are_named_exist(page):
    text = page.read_text(encoding="utf-8")
    named = re.findall(r"`((?:stair_inspector|tests|static_configs|sample_scans)/[\w./-]+)`", text)
    assert [name for name in named if not (ROOT / name).exists()] == []
    modules = re.findall(r"python -m\s+((?:tests|stair_inspector)[\w.]*)", text)
    assert [name for name in modules if not _is_module(name)] == []


def _is_module(name):
    path = ROOT.joinpath(*name.split("."))
    return path.with_suffix(".py").exists() or (path / "__main__.py").exists()


def test_the_readme_counts_the_rule_sets():
    counted = re.search(r"one of (\d+) rule sets", README.read_text(encoding="utf-8"))
    assert int(counted[1]) == len(list_rule_sets())


@EACH_PAGE
def test_toml_examples_can_be_read(page):
    for block in blocks(page, "toml"):
        assert tomllib.loads(block)


@pytest.mark.parametrize(
    "page", [page for page in (README, *PAGES) if blocks(page, "python")], ids=lambda page: page.stem
)
def test_python_examples_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stair.ply").write_bytes(ply_bytes(Stair(n_steps=4, noise=0.002).sample()[0]))
    examples = doctest.DocTestParser().get_doctest("\n".join(blocks(page, "python")), {}, page.stem, str(page), 0)
    done = doctest.DocTestRunner().run(examples)
    assert done.attempted > 0
    assert done.failed == 0


def console_examples():
    for page in (README, *PAGES):
        for command in commands(page):
            words = shlex.split(command)
            # The page itself is opened by the browser tests; the report has its own.
            is_slow = "--report" in words
            if words[1] != "view":
                yield pytest.param(command, id=f"{page.stem}: {command}", marks=[pytest.mark.slow] if is_slow else [])


@pytest.mark.parametrize("command", list(console_examples()))
def test_console_examples_run(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("straight.ply", "scan.ply"):
        (tmp_path / name).write_bytes(ply_bytes(Stair(n_steps=4, noise=0.002).sample()[0]))
    line, _, target = command.partition(" > ")
    if "mine.toml" in line:
        assert main(["rules", "--toml", "us-irc-2024"]) == 0
        (tmp_path / "mine.toml").write_text(capsys.readouterr().out.replace('"us-irc-2024"', '"mine"', 1))
    words = shlex.split(line)
    assert words[0] == "stair-inspector"
    # 1 is an answer of check: a value is outside.
    assert main(words[1:]) in ((0, 1) if words[1] == "check" else (0,))
    printed = capsys.readouterr()
    assert printed.err == ""
    assert printed.out
    assert not target or target == "mine.toml"


def rows_of(page, first):
    """The rows of the table whose head begins so, by their first cell, each cell without its margin."""
    text = page.read_text(encoding="utf-8")
    (table,) = re.findall(rf"^\| {first} \|.*\n\|[-|]+\n((?:\|.*\n)+)", text, re.MULTILINE)
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in table.splitlines()]
    return {row[0]: row[1:] for row in cells}


def test_the_readme_is_as_exact_as_the_reference_page_says():
    # Of the page: scans, exact, false, missed, then 95th percentile / worst / share of each quantity.
    wanted = {}
    for name, row in rows_of(ROOT / ".github" / "docs" / "accuracy.md", "scanner").items():
        parts = [row[place].split(" / ") for place in (4, 5, 7)]
        wanted[name] = [row[0], *(f"{p95}, {share.partition(' (')[0]}" for p95, _, share in parts)]
    assert len(wanted) == 6
    assert rows_of(README, "scanner") == wanted


def test_the_readme_makes_of_difficult_scans_what_the_reference_page_says():
    page = rows_of(ROOT / ".github" / "docs" / "accuracy.md", "kind")
    found = rows_of(README, "kind")
    everything = found.pop("**all**")
    assert found == {name: row[1:6] for name, row in page.items()}
    assert everything == [str(sum(int(row[place]) for row in found.values())) for place in range(5)]
    assert all(row[6] == "0" for row in page.values())
