"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import EAGAIN
from pathlib import Path
from secrets import token_hex
from stat import S_IMODE


@contextmanager
def atomic_write(path: Path) -> Iterator[str]:
    """The name of a draft beside `path`, with its suffix, that takes its place when the block ends without an error.

    Folders on the way are made. A file that is there keeps its mode, a new one has that of the umask; where `path` is a
    link, the file that it leads to is replaced. Of several writers the last one wins, with the whole of its file.
    Raises ValueError where `path` is something else than a file, OSError as usual, which names `path`.
    """
    require_file(path)
    target = path.resolve()  # a link keeps pointing where it does; a device would be replaced by a file
    target.parent.mkdir(parents=True, exist_ok=True)
    draft = str(target.with_name(f".{token_hex(8)}{target.suffix}"))  # a name that nobody has given
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
    """An OSError of the block that names no file, or the draft of one, names `path`: a full disk, too many files."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename not in (None, draft):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from None


@contextmanager
def sole_writer(path: Path) -> Iterator[None]:
    """While the block lasts no other process enters it for this file or folder, which is there.

    Raises BlockingIOError where one has. The lock ends with the process; systems without fcntl have none.
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
                mine = os.path.samestat(os.fstat(held), path.stat())  # not one replaced since it was opened
            except BlockingIOError:
                mine = False
            if not mine:
                raise BlockingIOError(EAGAIN, "another process is writing it; wait, or name another file")
        yield
    finally:
        os.close(held)


def require_folder(path: Path) -> None:
    """Raises ValueError if `path` is there and is no folder, OSError as `require_file`."""
    _look(path)
    if path.exists() and not path.is_dir():
        raise ValueError(f"{path} is a file; name a folder")


def require_file(path: Path) -> None:
    """Raises ValueError if `path` is there and is no file, so that nothing is computed for a name that cannot be.

    Raises OSError for links that lead in a circle, and where nobody may look.
    """
    _look(path)
    if path.is_dir():
        raise ValueError(f"{path} is a folder; name a file in it")
    if path.exists() and not path.is_file():
        raise ValueError(f"{path} is not a regular file; name another")


def _look(path: Path) -> None:
    """Raises OSError that pathlib's questions keep to themselves."""
    with suppress(FileNotFoundError):
        path.stat()


def read_utf8(path: Path, most: int) -> str:
    """The text of a file of at most so many bytes. Raises OSError, and ValueError, in one line that names the file."""
    with naming(path), path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"{path}: longer than {most} bytes")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not UTF-8 at byte {error.start}") from None
