"""Files appear whole or not at all, where they are asked for, and no draft is left behind."""

import os
import sys
from errno import ELOOP, EMFILE, ENOSPC
from pathlib import Path

import pytest

from driftproof.support.files import atomic_write, read_utf8, require_file, require_folder, sole_writer


def test_file_appears_when_the_block_ends(tmp_path):
    path = tmp_path / "new" / "a.svg"
    with atomic_write(path) as draft:
        assert Path(draft).suffix == ".svg"
        Path(draft).write_text("all of it", encoding="utf-8")
        assert not path.exists()
    assert path.read_text(encoding="utf-8") == "all of it"
    assert list(path.parent.iterdir()) == [path]


def test_file_stays_as_it_was_when_the_block_fails(tmp_path):
    path = tmp_path / "a"
    path.write_text("old", encoding="utf-8")

    def interrupted():
        with atomic_write(path) as draft:
            Path(draft).write_text("half", encoding="utf-8")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("umask", [0o000, 0o022, 0o077])
def test_new_file_obeys_the_umask_and_a_replaced_one_keeps_its_mode(tmp_path, umask):
    kept, new = tmp_path / "kept", tmp_path / "new"
    kept.touch()
    kept.chmod(0o640)
    before = os.umask(umask)
    try:
        for path in (kept, new):
            with atomic_write(path) as draft:
                Path(draft).write_text("x", encoding="utf-8")
    finally:
        os.umask(before)
    assert kept.stat().st_mode & 0o7777 == 0o640
    assert new.stat().st_mode & 0o7777 == 0o666 & ~umask


def test_last_of_two_writers_wins_with_the_whole_of_its_file(tmp_path):
    path = tmp_path / "a"
    with atomic_write(path) as first:
        Path(first).write_text("1" * 9, encoding="utf-8")
        with atomic_write(path) as second:
            Path(second).write_text("2" * 5, encoding="utf-8")
        assert path.read_text(encoding="utf-8") == "2" * 5
    assert path.read_text(encoding="utf-8") == "1" * 9


def test_one_writer_at_a_time_may_go_on_from_a_file(tmp_path, monkeypatch):
    path = tmp_path / "a"
    path.touch()
    for one in (path, tmp_path):
        with sole_writer(one):
            with pytest.raises(BlockingIOError, match="another process is writing it") as refused, sole_writer(one):
                raise AssertionError
            assert refused.value.filename == str(one)
        with sole_writer(one):
            pass
    monkeypatch.setitem(sys.modules, "fcntl", None)  # as where there is none
    with sole_writer(path), sole_writer(path):
        pass


@pytest.mark.parametrize("number", [ENOSPC, EMFILE])
def test_error_of_a_draft_names_the_file(tmp_path, number):
    path = tmp_path / "a.svg"
    for named in (None, "draft", "another"):
        with pytest.raises(OSError, match=r"a\.svg|another") as refused, atomic_write(path) as draft:
            raise OSError(number, os.strerror(number), draft if named == "draft" else named)
        shown = named if named == "another" else str(path)
        assert (refused.value.errno, refused.value.filename) == (number, shown)
        assert list(tmp_path.iterdir()) == []
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    for given in (atomic_write(loop).__enter__, lambda: require_folder(loop)):
        with pytest.raises(ValueError, match=f"loop: {os.strerror(ELOOP)}"):
            given()
    assert loop.is_symlink()


def test_link_keeps_pointing_where_it_does(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "file")
    with atomic_write(tmp_path / "link") as draft:
        Path(draft).write_text("x", encoding="utf-8")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_text(encoding="utf-8") == "x"


def test_what_is_in_the_way_is_named(tmp_path):
    (tmp_path / "file").touch()
    require_folder(tmp_path)
    require_folder(tmp_path / "new")
    require_file(tmp_path / "file")
    with pytest.raises(ValueError, match="file is a file; name a folder"):
        require_folder(tmp_path / "file")
    with pytest.raises(ValueError, match="is a folder; name a file in it"), atomic_write(tmp_path):
        raise AssertionError
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="pipe is not a regular file"):
        require_file(tmp_path / "pipe")
    with pytest.raises(ValueError, match="file/below: Not a directory"), atomic_write(tmp_path / "file" / "below"):
        raise AssertionError


def test_text_is_read_within_a_limit(tmp_path):
    path = tmp_path / "x.txt"
    path.write_bytes(b"\xef\xbb\xbf\xce\xb1")  # with a byte order mark
    assert read_utf8(path, 5) == "α"
    for content, reason in (
        (b"1234567", "too large; at most 6 bytes are read"),
        (b"ab\xff", "not UTF-8 at byte 2; save it as UTF-8"),
    ):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=f"x.txt: {reason}$"):
            read_utf8(path, 6)
