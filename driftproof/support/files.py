"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def atomic_write(path: Path) -> Iterator[str]:
    """The name of a draft beside `path`, with its suffix, that takes its place when the block ends without an error.

    Folders on the way are made. Raises ValueError where `path` is something else than a file, OSError as usual.
    """
    path = path.resolve()  # a link keeps pointing where it does; a device would be replaced by a file
    require_file(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        handle, draft = tempfile.mkstemp(dir=path.parent, suffix=path.suffix)
    except OSError as error:  # of a name that nobody gave
        raise OSError(error.errno, error.strerror, str(path)) from None
    os.close(handle)
    try:
        yield draft
        os.chmod(draft, 0o644)
        os.replace(draft, path)
    except BaseException:
        os.unlink(draft)
        raise


def require_folder(path: Path) -> None:
    """Raises ValueError if `path` is there and is no folder."""
    if path.exists() and not path.is_dir():
        raise ValueError(f"{path} is a file; name a folder")


def require_file(path: Path) -> None:
    """Raises ValueError if `path` is there and is no file, so that nothing is computed for a name that cannot be."""
    if path.is_dir():
        raise ValueError(f"{path} is a folder; name a file in it")
    if path.exists() and not path.is_file():
        raise ValueError(f"{path} is no file that can be replaced; name another")


def read_utf8(path: Path, most: int) -> str:
    """The text of a file of at most so many bytes. Raises OSError, and ValueError, in one line that names the file."""
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"{path}: longer than {most} bytes")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not UTF-8 at byte {error.start}") from None
