"""Files and folders that appear whole or not at all."""

from __future__ import annotations

import csv
import errno
import hashlib
import io
import os
import resource
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path

from drake_screw.errors import DrakeScrewError, RunDirectoryError
from drake_screw.file_locks import lock

WRITABLE_OUTPUT = "Give an --output in a folder that exists and that you may write to."
WRITTEN_NOW = "another process is writing it just now"
NO_FILE = "it is a device or a pipe, not a file"


def write_text(file: Path, text: str, *, shared: bool = False) -> None:
    """Write a file, UTF-8, so that it is there whole or not at all.

    Args:
        file: to appear.
        text: it is to hold.
        shared: whether other processes may be writing the same file just now.

    Raises:
        OSError: it cannot be written.
    """
    write_bytes(file, text.encode(), shared=shared)


def write_bytes(file: Path, content: bytes, *, shared: bool = False) -> None:
    """As `write_text`, bytes.

    Raises:
        OSError: it cannot be written.
    """
    try:
        with appearing(file, shared=shared) as temporary:
            temporary.write_bytes(content)
    except OSError as error:
        error.add_note(f"{_size(len(content))} are needed for {file.name}")
        raise


@contextmanager
def appearing(file: Path, *, shared: bool = False) -> Iterator[Path]:
    """A context in which a file is written bit by bit, and after which it is there whole.

    Args:
        file: to appear; where it is a symbolic link, what that leads to.
        shared: whether other processes may be writing the same file just now.

    Yields:
        Where to write it, in the same folder. If something is raised, nothing stays of it.

    Raises:
        OSError: it cannot be written, or is something else than a file, which is left alone; or it
            is not `shared`, and another process is writing it.
    """
    file = Path(os.path.realpath(file))
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(file))
    if file.exists() and not file.is_file():
        raise FileExistsError(errno.EEXIST, NO_FILE, str(file))
    own = f".{os.getpid()}" if shared else ""
    temporary = file.with_name(f".{file.name}{own}.part")
    try:
        descriptor, _ = lock(temporary)
    except BlockingIOError:
        raise FileExistsError(errno.EEXIST, WRITTEN_NOW, str(file)) from None
    try:
        yield temporary
        os.replace(temporary, file)
    except BaseException:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise
    finally:
        os.close(descriptor)


def write_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Write a folder so that it is there whole or not at all; a stale one is replaced.

    Args:
        folder: to appear.
        fill: writes its contents into the folder that it is given.

    Raises:
        OSError: it cannot be written.
    """
    temporary = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(temporary, ignore_errors=True)
    try:
        temporary.mkdir(parents=True)
        fill(temporary)
        shutil.rmtree(folder, ignore_errors=True)
        os.replace(temporary, folder)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write a folder of some files so that it is there whole or not at all.

    A folder that holds nothing else is replaced.

    Args:
        folder: to appear, in one that exists.
        files: their contents, by their paths in the folder.

    Raises:
        RunDirectoryError: the folder holds other files.
        OSError: it cannot be written.
    """
    folder = folder.resolve()
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))
    there = {item.relative_to(folder).as_posix() for item in folder.rglob("*") if item.is_file()}
    if others := sorted(there - files.keys()):
        raise RunDirectoryError(
            f"cannot be written: the folder holds other files, {others[0]} for one",
            remedy="Give another --output; only an earlier export is replaced.",
            file=folder,
        )
    if not folder.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(folder))

    def fill(new: Path) -> None:
        for name, content in files.items():
            (new / name).parent.mkdir(parents=True, exist_ok=True)
            (new / name).write_bytes(content)

    write_folder(folder, fill)


@contextmanager
def writing(
    place: Path, remedy: str, kind: type[DrakeScrewError] = RunDirectoryError
) -> Iterator[None]:
    """A context in which a file or folder that cannot be written is an error for its user.

    Args:
        place: what is written; it stands in the message.
        remedy: what the user can do about it.
        kind: of error.

    Raises:
        DrakeScrewError: of that kind, where the operating system refuses.
    """
    try:
        yield
    except OSError as error:
        raise kind(
            f"cannot be written: {error.strerror or error}{_room(place, error)}",
            remedy=remedy,
            file=place,
        ) from error


_NO_ROOM = (errno.ENOSPC, errno.EDQUOT)


def _room(place: Path, error: OSError) -> str:
    """Which file system is full, or what limit was met, and what is needed, where it is that."""
    needed = getattr(error, "__notes__", [])
    if error.errno == errno.EFBIG:
        limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
        known = [] if limit < 0 else [f"the limit is {_size(limit)} a file (ulimit -f)"]
        return "; ".join(["", *known, *needed])
    if error.errno not in _NO_ROOM:
        return ""
    mount = place.absolute()
    while not os.path.ismount(mount):
        mount = mount.parent
    try:
        free = f" has {_size(shutil.disk_usage(mount).free)} left"
    except OSError:
        free = ""
    return "; ".join(["", f"the file system {mount}{free}", *needed])


def _size(size: int) -> str:
    """Bytes for people.

    >>> _size(900), _size(84580), _size(2603840)
    ('900 bytes', '85 kB', '2.6 MB')
    """
    if size < 1000:
        return f"{size} bytes"
    return f"{size / 1e3:.0f} kB" if size < 1e6 else f"{size / 1e6:.1f} MB"


def make_folder(path: Path, what: str, files: Mapping[str, str]) -> None:
    """Make the folder of something new, such as a run, with its first files.

    An empty one is taken as it is, and so is one in which a process that was killed had not come as
    far as the last of these files, which makes the folder what it is.

    Args:
        path: of the folder.
        what: it is for, a word such as "run".
        files: their texts, by their names.

    Raises:
        RunDirectoryError: there is something at that place already.
        OSError: it cannot be written; what was written is removed, as it is by an interruption.
    """
    *_, last = files
    begun = path / f".{last}.part"
    makings = {*files, *(f".{name}.part" for name in files)} - {last}
    there = {item.name for item in path.iterdir()} if path.is_dir() else set()
    unfinished = begun.name in there and there <= makings
    if path.exists() and (not path.is_dir() or (there and not unfinished)):
        raise RunDirectoryError(
            f"exists already; a {what} never overwrites anything",
            remedy=f"Give another --output, or continue a {what} with --resume.",
            file=path,
        )
    path.mkdir(parents=True, exist_ok=True)
    try:
        begun.touch()
        for name, text in files.items():
            write_text(path / name, text)
    except BaseException:
        for name in {*makings, last}:
            with suppress(OSError):
                (path / name).unlink(missing_ok=True)
        with suppress(OSError):
            path.rmdir()
        raise


def fresh_folder(parent: Path) -> Path:
    """Make a folder that nobody else has, named after the time: ``parent/<time>``.

    Raises:
        OSError: it cannot be made.
    """
    stamp = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    parent.mkdir(parents=True, exist_ok=True)
    path, count = parent / stamp, 1
    while True:
        try:
            path.mkdir()
            return path
        except FileExistsError:
            count += 1
            path = parent / f"{stamp}_{count}"


def printable(name: str) -> str:
    """A file's name as text: bytes that are no UTF-8 are written as their numbers."""
    return os.fsencode(name).decode("utf-8", "backslashreplace")


def now() -> str:
    """The local time with its offset, to the second."""
    return datetime.now().astimezone().isoformat(timespec="seconds")


def file_hash(file: Path) -> str:
    """SHA-256 of a file's contents."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def csv_text(rows: Iterable[Sequence[object]]) -> str:
    """Rows as lines of CSV; what holds a comma or a quotation mark is quoted.

    >>> print(csv_text([("x", "demo, second try"), (0.5, "0:0")]), end="")
    x,"demo, second try"
    0.5,0:0
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
