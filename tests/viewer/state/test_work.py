"""What an inspector has done is kept: in memory for pages that come back, and as project files."""

import dataclasses
import json
import threading

import pytest

from stair_inspector.errors import ConfigError, StairError
from stair_inspector.files.project_files import read_project
from stair_inspector.files.projects import KeptRun, Measurement, SavedView
from stair_inspector.params import Params
from stair_inspector.viewer.state import keeper as keeper_module
from stair_inspector.viewer.state.keeper import Keeper
from stair_inspector.viewer.state.library import Library
from stair_inspector.viewer.state.wishes import KeptWishes, OpenPage, Wish
from stair_inspector.viewer.state.work import Work, work_of

SHA = "0" * 63 + "1"
OTHER = Params().replaced("levels.eps_m", 0.03)


@pytest.fixture
def library(tmp_path):
    for name in ("a.ply", "b.ply"):
        (tmp_path / name).write_bytes(b"x")
    return Library([tmp_path])


@pytest.fixture
def keeper(library):
    keeper = Keeper(library, lambda words, is_failure: None)
    scan = library.path("a.ply")
    path, project, _ = library.claim_project(scan)
    assert project is None
    keeper.begin("a.ply", scan, Work(Params()), path)
    yield keeper
    keeper.close()


def page():
    return OpenPage(lambda: False, lambda: True, lambda: None)


def test_a_browser_takes_up_each_of_its_closed_pages_once_and_nobody_elses():
    kept = KeptWishes(lambda upload: None)
    first, second, other = Wish("a"), Wish("b"), Wish("c")
    kept.leave("mine", page(), first)
    kept.leave("theirs", page(), other)
    kept.leave("mine", page(), second)
    assert [kept.take_up("mine"), kept.take_up("mine"), kept.take_up("mine")] == [second, first, None]
    assert kept.take_up("theirs") == other


def test_a_page_that_does_not_answer_is_closed_and_one_that_does_is_not():
    kept, ended = KeptWishes(lambda upload: None), []

    def end_dead():
        ended.append("dead")
        kept.leave("mine", dead, Wish("a"))

    dead = OpenPage(lambda: False, lambda: False, end_dead)
    living = OpenPage(lambda: False, lambda: True, lambda: ended.append("living"))
    kept.arrive("mine", dead)
    kept.arrive("mine", living)
    assert kept.take_up("mine") == Wish("a")
    assert kept.take_up("mine") is None
    assert ended == ["dead"]
    assert kept.has_open("mine")
    kept.leave("mine", living, Wish("b"))
    assert not kept.has_open("mine")


def test_a_page_that_is_loaded_again_waits_for_its_own_work():
    kept = KeptWishes(lambda upload: None)
    kept.leave("mine", page(), Wish("long gone"))
    leaving = OpenPage(lambda: True, lambda: False, lambda: None)
    kept.arrive("mine", leaving)
    threading.Timer(0.2, kept.leave, ("mine", leaving, Wish("just now"))).start()
    assert kept.take_up("mine") == Wish("just now")


def test_what_is_kept_is_bounded():
    freed = []
    kept = KeptWishes(freed.append)
    for k in range(200):
        kept.leave(f"browser {k}", page(), Wish("a", uploads=(f"{k}.ply",)))
        kept.leave("many", page(), Wish(str(k)))
    assert freed == [f"{k}.ply" for k in range(200 - 99)]
    assert kept.take_up("browser 0") is None
    assert kept.take_up("browser 199") is not None
    assert len([each for each in iter(lambda: kept.take_up("many"), None) if each]) == 10


def test_changes_are_undone_in_turn_and_a_drag_is_one(keeper):
    start = keeper.work
    for eps_m in (0.021, 0.022, 0.03):
        keeper.change("eps_z", "levels.eps_m", params=Params().replaced("levels.eps_m", eps_m))
    keeper.change("title", title="Hall")
    assert keeper.work == Work(OTHER, title="Hall")
    assert keeper.undo() == Work(OTHER)
    assert keeper.undo() == start
    assert keeper.redo() == Work(OTHER)


def test_work_is_saved_once_the_scan_is_known_and_comes_back_whole(keeper, library, tmp_path):
    measured = (Measurement("Distance 1", ((0.0, 0.0, 0.0), (1.0, 0.0, 0.5))),)
    keeper.change("all", params=OTHER, title="Hall", measurements=measured, runs=(KeptRun("A", Params()),))
    keeper.save()
    assert not (tmp_path / "a.stair.json").exists()
    keeper.know_scan("a.ply", SHA)
    keeper.save()
    project = read_project(tmp_path / "a.stair.json")
    assert (project.scan_file, project.scan_sha256) == ("a.ply", SHA)
    assert work_of(project) == keeper.work
    assert not [path for path in tmp_path.iterdir() if path.suffix not in (".ply", ".json")]


def test_more_measurements_than_a_project_holds_are_refused_where_they_are_made(keeper):
    measured = tuple(Measurement(f"Point {k}", ((0.0, 0.0, float(k)),)) for k in range(501))
    keeper.change("most", measurements=measured[:500])
    with pytest.raises(ConfigError, match="measurements: got 501; keep at most 500, delete some"):
        keeper.change("one more", measurements=measured)
    assert len(keeper.work.measurements) == 500


def test_other_work_is_taken_up_in_one_change(keeper):
    start = keeper.work
    keeper.replace(Work(OTHER, title="Hall"), "opened hall.stair.json")
    assert keeper.work == Work(OTHER, title="Hall")
    assert keeper.undo() == start


def test_a_save_that_failed_is_tried_again(keeper, tmp_path):
    keeper.know_scan("a.ply", SHA)
    keeper.change("title", title="Hall")
    in_the_way = tmp_path / "a.stair.json"
    in_the_way.mkdir()
    keeper.save()
    in_the_way.rmdir()
    keeper.save()
    assert read_project(in_the_way).title == "Hall"


def test_a_change_that_is_made_while_the_project_is_saved_is_saved_by_the_next(keeper, tmp_path, monkeypatch):
    keeper.know_scan("a.ply", SHA)
    keeper.change("title", title="before")
    save = keeper_module.save_project

    def save_slowly(path, project):
        keeper.change("title", title="meanwhile")
        return save(path, project)

    monkeypatch.setattr(keeper_module, "save_project", save_slowly)
    keeper.save()
    monkeypatch.setattr(keeper_module, "save_project", save)
    assert read_project(tmp_path / "a.stair.json").title == "before"
    keeper.save()
    assert read_project(tmp_path / "a.stair.json").title == "meanwhile"


def test_a_project_file_that_somebody_else_has_changed_is_not_written_over(library, tmp_path):
    told = []
    keeper = Keeper(library, lambda words, is_failure: told.append((words, is_failure)))
    scan = library.path("a.ply")
    keeper.begin("a.ply", scan, Work(Params()), library.claim_project(scan)[0])
    keeper.know_scan("a.ply", SHA)
    keeper.change("title", title="mine")
    keeper.save()
    (tmp_path / "a.stair.json").write_text("theirs")
    keeper.change("title", title="mine, again")
    keeper.close()
    assert (tmp_path / "a.stair.json").read_text() == "theirs"
    assert read_project(tmp_path / "a.2.stair.json").title == "mine, again"
    assert [is_failure for _, is_failure in told] == [False, False]
    assert "left as it is; this work is in a.2.stair.json" in told[-1][0]


@pytest.mark.parametrize("name", ["none", "A"])
def test_a_name_that_a_menu_could_not_list_is_refused(keeper, name):
    keeper.change("run", runs=(KeptRun("A", Params()),))
    for field, made in (
        ("runs", (KeptRun("A", Params()), KeptRun(name, OTHER))),
        ("measurements", tuple(Measurement(each, ((0.0, 0.0, 0.0),)) for each in ("A", name))),
        ("views", tuple(SavedView(each, (0, 0, 0), (1, 0, 0), (0, 0, 1), 40.0) for each in ("A", name))),
    ):
        with pytest.raises(ConfigError, match=f"{field}: .*(taken|a word of the menu)"):
            keeper.change("again", **{field: made})
    assert keeper.work.runs == (KeptRun("A", Params()),)


@pytest.mark.parametrize("title", ["a\x00b", "x" * 201])
def test_a_title_that_cannot_stand_in_a_project_is_refused(keeper, title):
    with pytest.raises(ConfigError, match="title: "):
        keeper.change("title", title=title)


def test_nothing_is_written_for_a_scan_that_was_only_looked_at(keeper, tmp_path):
    keeper.know_scan("a.ply", SHA)
    keeper.save()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.ply", "b.ply"]


def test_two_pages_on_one_scan_have_files_of_their_own(keeper, library, tmp_path):
    scan = library.path("a.ply")
    path, project, _ = library.claim_project(scan)
    assert (path, project) == (tmp_path / "a.2.stair.json", None)
    library.release_project(path)
    assert library.claim_project(scan)[0] == path


def test_what_was_saved_is_found_again_by_the_next_server(keeper, tmp_path):
    keeper.change("eps", params=OTHER)
    keeper.know_scan("a.ply", SHA)
    keeper.close()
    path, project, words = Library([tmp_path]).claim_project(tmp_path / "a.ply")
    assert path == tmp_path / "a.stair.json"
    assert project.params == OTHER
    assert words == ""


def test_a_project_that_cannot_be_read_is_left_alone_and_said(library, tmp_path):
    (tmp_path / "a.stair.json").write_text("{")
    path, project, words = library.claim_project(tmp_path / "a.ply")
    assert (path, project) == (tmp_path / "a.2.stair.json", None)
    assert "not valid JSON" in words
    assert "left as it is" in words


def test_the_project_of_another_scan_with_the_same_stem_is_passed_over(keeper, tmp_path):
    keeper.change("eps", params=OTHER)
    keeper.know_scan("a.ply", SHA)
    keeper.close()
    (tmp_path / "a.pcd").write_bytes(b"y")
    path, project, words = Library([tmp_path]).claim_project(tmp_path / "a.pcd")
    assert (path, project, words) == (tmp_path / "a.2.stair.json", None, "")


def test_projects_go_where_they_are_told_or_nowhere(tmp_path):
    (tmp_path / "a.ply").write_bytes(b"x")
    library = Library([tmp_path / "a.ply"], tmp_path / "projects")
    assert library.claim_project(tmp_path / "a.ply")[0] == tmp_path / "projects" / "a.stair.json"
    library = Library([tmp_path / "a.ply"], saves_projects=False)
    assert library.claim_project(tmp_path / "a.ply") == (None, None, "")


def test_nothing_is_written_beside_the_programs_own_samples():
    from stair_inspector.files.paths import sample_scans

    assert Library([sample_scans()]).claim_project(sample_scans() / "straight.ply") == (None, None, "")


def test_a_scan_that_appears_in_the_folder_is_found(library, tmp_path):
    assert library.labels() == ("a.ply", "b.ply")
    (tmp_path / "c.ply").write_bytes(b"x")
    library.refresh()
    assert library.labels() == ("a.ply", "b.ply", "c.ply")


def test_a_name_that_was_given_out_stands_for_its_file_ever_after(tmp_path):
    for name in ("f1", "f2"):
        (tmp_path / name).mkdir()
    first, second = tmp_path / "f1" / "a.ply", tmp_path / "f2" / "a.ply"
    first.write_bytes(b"x")
    (tmp_path / "f2" / "b.ply").write_bytes(b"x")
    library = Library([first.parent, second.parent])
    assert library.labels() == ("a.ply", "b.ply")
    second.write_bytes(b"x")
    (tmp_path / "f2" / "b.ply").unlink()
    upload = library.add_upload("f2_a.ply", b"x")
    library.refresh()
    assert library.labels() == ("a.ply", "f2/a.ply")
    assert (library.path("a.ply"), library.path("f2/a.ply")) == (first, second)
    # Who has it open goes on with what was read of it.
    assert library.path("b.ply") == tmp_path / "f2" / "b.ply"
    second.unlink()
    library.refresh()
    second.write_bytes(b"x")
    library.refresh()
    assert library.labels((upload,)) == ("a.ply", "f2/a.ply", upload)
    library.close()


def test_an_upload_is_kept_until_the_end_under_a_name_of_its_own(library):
    label = library.add_upload("../../a.ply", b"ply...")
    assert label == "a (2).ply"
    path = library.path(label, (label,))
    assert path.read_bytes() == b"ply..."
    with pytest.raises(ConfigError, match="is none of the files"):
        library.path(label)
    assert library.labels() == ("a.ply", "b.ply")
    assert library.labels((label,)) == ("a.ply", "b.ply", label)
    library.close()
    assert not path.exists()


@pytest.mark.parametrize("name", ["a\0.ply", "a\n.ply", "\ud800.ply", "\U0001d11e" * 200 + ".ply"])
def test_an_upload_that_cannot_be_kept_takes_no_place(library, name):
    for _ in range(60):
        with pytest.raises(StairError, match=r"holds what no name of a file may hold|cannot be written"):
            library.add_upload(name, b"ply")
    assert library.labels(tuple(library._uploads)) == ("a.ply", "b.ply")
    assert not library.is_full()
    assert library.add_upload("c.ply", b"ply") == "c.ply"
    library.close()


def test_an_upload_that_fails_for_whatever_reason_takes_no_place(library, monkeypatch):
    monkeypatch.setattr("stair_inspector.viewer.state.library.write_atomically", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        library.add_upload("c.ply", b"ply")
    assert library._uploads == {}
    library.close()


@pytest.mark.parametrize(
    ("name", "size", "words"),
    [
        ("a.exe", 10, "is no scan by its name"),
        ("a.ply", 0, "is empty"),
        ("a.ply", 500_000_001, "500 MB are allowed"),
        ("<b>", 10, "is no scan by its name"),
    ],
)
def test_an_upload_that_is_no_scan_or_too_large_is_a_sentence(library, name, size, words):
    with pytest.raises(ConfigError, match=words):
        library.check_upload(name, size)


def test_a_project_holds_every_part_of_the_work():
    fields = {field.name for field in dataclasses.fields(Work)}
    assert fields == {"params", "title", "measurements", "views", "runs", "rules", "basis", "findings", "second"}


def test_the_project_of_a_page_is_the_file_that_measure_takes(keeper, tmp_path):
    keeper.change("eps", params=OTHER)
    assert keeper.project() is None
    keeper.know_scan("a.ply", SHA)
    assert keeper.project().params == OTHER
    keeper.save()
    assert json.loads((tmp_path / "a.stair.json").read_text())["settings"]["levels"]["eps_m"] == 0.03
