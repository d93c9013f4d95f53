"""Files: atomic writing, locks between processes, checks of paths, and reading with a limit."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from errno import EAGAIN
from os.path import exists
from pathlib import Path
from stat import S_IMODE, S_ISDIR, S_ISREG

# The folders of a text and of its claims, where a file that they name is looked for before the working directory.
FOLDERS_OF_TEXT: ContextVar[tuple[Path, ...]] = ContextVar("FOLDERS_OF_TEXT", default=())


def file_named(name: str | Path) -> Path:
    """The file beside the text that names it, if there is one; else the file that the working directory has."""
    return next((path for folder in FOLDERS_OF_TEXT.get() if exists(path := folder / name)), Path(name))


@contextmanager
def named_beside(*files: str | Path) -> Iterator[None]:
    """Look for the files that are named inside the block in the folders of these files first."""
    before = FOLDERS_OF_TEXT.set(tuple(Path(file).parent for file in files))
    try:
        yield
    finally:
        FOLDERS_OF_TEXT.reset(before)


@contextmanager
def atomic_write(path: Path) -> Iterator[str]:
    """Yield the name of a draft with the suffix of `path`, which replaces `path` if the block ends without an error.

    Missing folders are created. An existing file keeps its mode, a new one has that of the umask; if `path` is a link,
    its target is replaced. Of several writers the last one wins, with its whole file. Raises ValueError if `path`
    exists and is no regular file; an OSError names `path` rather than the draft.
    """
    require_file(path)
    target = path.resolve()  # so that a link is kept, and its target replaced
    target.parent.mkdir(parents=True, exist_ok=True)
    draft = str(target.with_name(f".{os.urandom(8).hex()}{target.suffix}"))  # a name that no other file has
    with naming(path, draft):
        os.close(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        try:
            yield draft
            if target.exists():
                os.chmod(draft, S_IMODE(target.stat().st_mode))
            os.replace(draft, target)
        except BaseException:
            os.unlink(draft)
            raise


@contextmanager
def naming(path: Path, draft: str | None = None) -> Iterator[None]:
    """Make an OSError of the block name `path` if it names no file, as for a full disk, or if it names the draft."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename not in (None, draft):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from None


@contextmanager
def sole_writer(path: Path) -> Iterator[None]:
    """Lock an existing file or folder for the duration of the block, against other processes that lock it.

    Raises BlockingIOError if another process has the lock. The lock ends with the process; without fcntl there is none.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    held = os.open(path, os.O_RDONLY)
    try:
        with naming(path):
            try:
                fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
                mine = os.path.samestat(os.fstat(held), path.stat())  # False if it was replaced since it was opened
            except BlockingIOError:
                mine = False
            if not mine:
                raise BlockingIOError(EAGAIN, "another process is writing it; wait, or name another file")
        yield
    finally:
        os.close(held)


def require_folder(path: Path) -> None:
    """Raise ValueError if `path` exists and is no folder, or cannot be reached."""
    if (mode := _mode(path)) and not S_ISDIR(mode):
        raise ValueError(f"{path} is a file; name a folder")


def require_file(path: Path) -> None:
    """Raise ValueError if `path` exists and is no regular file, or cannot be reached, before it is to be written."""
    if S_ISDIR(mode := _mode(path)):
        raise ValueError(f"{path} is a folder; name a file in it")
    if mode and not S_ISREG(mode):
        raise ValueError(f"{path} is not a regular file; name another")


def _mode(path: Path) -> int:
    """The mode of a file, 0 if there is none. Raises ValueError for circular links, and if the folder is none."""
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return 0
    except (OSError, ValueError) as error:
        raise ValueError(_unreachable(path, error)) from None


def _unreachable(path: str | Path, error: Exception) -> str:
    """Why a file cannot be opened, in one line that names it; a ValueError is for a zero byte in the name."""
    return " ".join(f"{path}: {getattr(error, 'strerror', None) or error}".split())


def read_bytes(path: str | Path, most: int, refusal: type[ValueError] = ValueError) -> bytes:
    """The content of a file of at most `most` bytes. Raises `refusal` for any other file, in one line that names it."""
    try:
        with Path(path).open("rb") as file:
            content = file.read(most + 1)
    except (OSError, ValueError) as error:
        raise refusal(_unreachable(path, error)) from None
    if len(content) > most:
        raise refusal(f"{path}: too large; at most {most} bytes are read")
    return content


def read_utf8(path: str | Path, most: int, refusal: type[ValueError] = ValueError) -> str:
    """The text of a UTF-8 file of at most `most` bytes. Raises `refusal` for any other file, as `read_bytes` does."""
    try:
        return read_bytes(path, most, refusal).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refusal(f"{path}: not UTF-8 at byte {error.start}; save it as UTF-8") from None
