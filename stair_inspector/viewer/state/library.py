"""Which scans a server offers, where uploads are kept, and which project file belongs to which page."""

import contextlib
import hashlib
import os
import shutil
import tempfile
import threading
import unicodedata
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from stair_inspector.content.project_basis import basis_of, pinned_of
from stair_inspector.errors import ConfigError, StairError, WriteError
from stair_inspector.files.atomic import write_atomically
from stair_inspector.files.paths import sample_scans
from stair_inspector.files.project_files import read_project
from stair_inspector.files.projects import Project, autosave_path
from stair_inspector.files.scans import SUFFIXES, find_scans
from stair_inspector.viewer.state.labels import free_label, label_scans

DEFAULT_UPLOAD_LIMIT_MB = 500.0
_LARGEST_UPLOAD_MB = 1e6
_MOST_UPLOADS = 50
_LONGEST_NAME = 120
_MOST_PROJECTS = 50
"""Pages that can work on one scan at the same time, each with a project file of its own."""


class Library:
    """The files of one server: scans by their name in the list, uploads, and the projects beside them.

    Parameters
    ----------
    scans : sequence of Path
        Files and folders the server was started with, at least one. A folder is looked at again by :meth:`refresh`.
    project_dir : Path, optional
        Where projects are saved; None is beside each scan.
    saves_projects : bool
        False keeps projects in memory only.
    upload_limit_mb : float
        Largest upload, megabytes.
    """

    def __init__(
        self,
        scans: Sequence[Path],
        project_dir: Path | None = None,
        *,
        saves_projects: bool = True,
        upload_limit_mb: float = DEFAULT_UPLOAD_LIMIT_MB,
    ) -> None:
        if not 0.0 < upload_limit_mb <= _LARGEST_UPLOAD_MB:
            raise ConfigError(
                f"--upload-limit-mb: got {upload_limit_mb:g}; give a number above 0, at most {_LARGEST_UPLOAD_MB:g}"
            )
        self.upload_limit_bytes = int(upload_limit_mb * 1e6)
        self._given = list(scans)
        self._project_dir = project_dir
        self._saves_projects = saves_projects
        self._lock = threading.Lock()
        self._uploads: dict[str, Path] = {}
        self._n_uploaded = 0
        self._upload_folder: tempfile.TemporaryDirectory[str] | None = None
        self._claimed: set[Path] = set()
        # Every name that was ever given out, since pages go on using it, and those that the menu lists now.
        self._scans: dict[str, Path] = {}
        self._listed: tuple[str, ...] = ()
        self.refresh()

    def refresh(self) -> None:
        """Look into the folders again; a folder that can no longer be read keeps what it had.

        A name that was given out stands for the same file ever after.
        """
        found: list[Path] = []
        for path in self._given:
            if not path.is_dir():
                # Whether a file can be read is said when it is opened.
                found.append(path)
                continue
            try:
                found += find_scans([path])
            except StairError:
                found += [known for known in self._scans.values() if known.parent == path]
        if not found and not self._scans:
            # Said as it is when the server starts.
            found = find_scans(self._given)
        with self._lock:
            if not self._scans:
                self._scans = label_scans(found)
            known = {path: label for label, path in self._scans.items()}
            for path in found:
                if path not in known:
                    known[path] = free_label(path, {*self._scans, *self._uploads})
                    self._scans[known[path]] = path
            self._listed = tuple(dict.fromkeys(known[path] for path in found)) or self._listed

    def labels(self, own: Sequence[str] = ()) -> tuple[str, ...]:
        """Return the names in the list: the server's scans, then those uploads that are one's own."""
        with self._lock:
            return (*self._listed, *(label for label in own if label in self._uploads))

    def path(self, label: str, own: Sequence[str] = ()) -> Path:
        """Return the file that a name stands for, of the uploads one's own alone.

        Raises
        ------
        ConfigError
            No scan has that name.
        """
        with self._lock:
            path = self._scans.get(label) or (self._uploads.get(label) if label in own else None)
        if path is None:
            raise ConfigError(
                f"scan: {str(label)[:60]!r} is none of the files that were opened; choose one of the list"
            )
        return path

    def check_upload(self, name: str, size: int) -> None:
        """Raise before an upload is received.

        Raises
        ------
        ConfigError
            The file is empty or too large, its suffix is none of a scan, or its name is none of a file.
        """
        if any(unicodedata.category(character) in ("Cc", "Cs") for character in name):
            raise ConfigError(f"upload: {name[:60]!r} holds what no name of a file may hold; rename the file")
        suffix = PurePosixPath(name).suffix.lower()
        if suffix not in SUFFIXES:
            raise ConfigError(
                f"upload: {name[:60]!r} is no scan by its name; give a file that ends in {', '.join(SUFFIXES)}"
            )
        if size <= 0:
            raise ConfigError(f"upload: {name[:60]!r} is empty; give another file")
        if size > self.upload_limit_bytes:
            raise ConfigError(
                f"upload: {name[:60]!r} has {size / 1e6:,.1f} MB and {self.upload_limit_bytes / 1e6:,.0f} MB are "
                "allowed; thin it out, put it into the folder of the scans, or start with a larger --upload-limit-mb"
            )

    def add_upload(self, name: str, content: bytes) -> str:
        """Keep an uploaded scan until the server ends, or :meth:`forget_upload`; return its name in the list.

        Raises
        ------
        ConfigError
            As :meth:`check_upload`, or too many uploads.
        WriteError
            There is no room for it.
        """
        # Only the name: what a browser sends is never a path.
        name = PurePosixPath(name.replace("\\", "/")).name[-_LONGEST_NAME:]
        self.check_upload(name, len(content))
        with self._lock:
            if len(self._uploads) >= _MOST_UPLOADS:
                raise ConfigError(
                    f"upload: {_MOST_UPLOADS} uploaded files are open, which is the most; close pages that have some"
                )
            if self._upload_folder is None:
                self._upload_folder = tempfile.TemporaryDirectory(prefix="stair_inspector_")
            self._n_uploaded += 1
            label, number = name, 1
            while label in self._scans or label in self._uploads:
                number += 1
                label = f"{Path(name).stem} ({number}){Path(name).suffix}"
            # The name is taken now; that it takes a while to write the file holds up nobody.
            path = self._uploads[label] = Path(self._upload_folder.name) / str(self._n_uploaded) / label
        is_kept = False
        try:
            write_atomically(path, content)
            is_kept = True
        finally:
            # Whatever went wrong, the place is free again.
            if not is_kept:
                self.forget_upload(label)
        return label

    def is_full(self) -> bool:
        """Return whether there are as many uploads as there can be."""
        with self._lock:
            return len(self._uploads) >= _MOST_UPLOADS

    def forget_upload(self, label: str) -> None:
        """Delete an uploaded scan that no page has any more."""
        with self._lock:
            path = self._uploads.pop(label, None)
        if path is not None:
            with contextlib.suppress(OSError):
                shutil.rmtree(path.parent)

    def claim_project(
        self, scan: Path, sha256: str = "", *, only_reads: bool = False
    ) -> tuple[Path | None, Project | None, str]:
        """Take a project file of a scan for one page, which :meth:`release_project` gives back.

        Parameters
        ----------
        scan : Path
            The scan's file.
        sha256 : str
            Pass over the work that was done on other bytes of it.
        only_reads : bool
            Take nothing: what is saved is wanted alone, whoever works on it.

        Returns
        -------
        path, project, words
            Where to save, None where nothing can be saved; what is saved there, None for nothing; and what the
            inspector should know about it, empty for nothing.
        """
        if not self._saves_projects:
            return None, None, ""
        folder = self._project_dir
        if folder is None and self._is_upload(scan):
            words = "is deleted when the server ends, and so is the work on it; download the project to keep it"
            return None, None, f"{scan.name} {words}, or start with --project-dir"
        if folder is None and _is_bundled(scan):
            return None, None, ""
        if folder is None and not only_reads and not os.access(scan.parent, os.W_OK):
            return None, None, f"{scan.parent} cannot be written, so nothing is saved there; start with --project-dir"
        if folder is not None and not only_reads:
            try:
                folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise WriteError(f"{folder}: cannot be made ({error.strerror}); give another --project-dir") from error
        first = autosave_path(scan, folder)
        words = ""
        with self._lock:
            for number in range(1, _MOST_PROJECTS + 1):
                path = first if number == 1 else autosave_path(scan.with_stem(f"{scan.stem}.{number}"), folder)
                if path in self._claimed and not only_reads:
                    continue
                project, why = _saved_project(path)
                if why:
                    # What cannot be read may be somebody's work: it is left alone and the next name is taken.
                    words = f"{why} It is left as it is"
                    continue
                if project is not None and project.scan_file != scan.name:
                    # stair.ply and stair.pcd share a stem.
                    continue
                if project is not None and sha256 not in ("", project.scan_sha256):
                    continue
                if not only_reads:
                    self._claimed.add(path)
                return path, project, words
        return None, None, f"{_MOST_PROJECTS} pages work on this scan; what is changed on this page is not saved"

    def retake_project(self, scan: Path, path: Path, state: str) -> Path | None:
        """Take the project file that a page which comes back has had, or one that is not there yet.

        Parameters
        ----------
        scan, path : Path
            The scan, and the project file.
        state : str
            What :func:`state_of` said of the file when the page left it: a file that has changed since is the work of
            somebody else.
        """
        with self._lock, contextlib.suppress(WriteError):
            if path not in self._claimed and state_of(path) in ("", state):
                self._claimed.add(path)
                return path
        return self.new_project(scan, path.parent)

    def new_project(self, scan: Path, folder: Path) -> Path | None:
        """Take a project file that is not there yet; None if there are too many."""
        with self._lock:
            for number in range(1, _MOST_PROJECTS + 1):
                stem = scan.stem if number == 1 else f"{scan.stem}.{number}"
                path = autosave_path(scan.with_stem(stem), folder)
                if path not in self._claimed and not path.exists():
                    self._claimed.add(path)
                    return path
        return None

    def release_project(self, path: Path | None) -> None:
        """Give a project file back; another page may take it."""
        if path is not None:
            with self._lock:
                self._claimed.discard(path)

    def _is_upload(self, scan: Path) -> bool:
        with self._lock:
            return scan in self._uploads.values()

    def close(self) -> None:
        """Delete the uploads."""
        with self._lock:
            if self._upload_folder is not None:
                with contextlib.suppress(OSError):
                    self._upload_folder.cleanup()
                self._upload_folder = None
            self._uploads = {}


def state_of(path: Path) -> str:
    """Return what tells whether a project file has changed: the SHA-256 of its bytes, empty where there is no file.

    Raises
    ------
    WriteError
        What is there cannot be read, and so must not be replaced.
    """
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except FileNotFoundError:
        return ""
    except OSError as error:
        raise WriteError(f"{path}: cannot be read ({error.strerror}); remove what is in the way") from error


def upload_types() -> str:
    """Return what the file dialog of an upload offers."""
    return ",".join(SUFFIXES)


def _is_bundled(scan: Path) -> bool:
    """Return whether a scan comes with the program, beside which nothing is to be written."""
    try:
        return scan.resolve().parent == sample_scans().resolve()
    except StairError:
        return False


def _saved_project(path: Path) -> tuple[Project | None, str]:
    """Return the project in a file, and why there is none."""
    if not path.exists():
        return None, ""
    try:
        project = read_project(path)
        # Read here, where what cannot be read is left alone.
        basis_of(project, str(path))
        pinned_of(project, str(path))
    except StairError as error:
        return None, f"The saved work cannot be taken up: {error}."
    return project, ""
