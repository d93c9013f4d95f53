"""Files appear whole or not at all, where they are asked for, and no draft is left behind."""

from pathlib import Path

import pytest

from driftproof.support.files import atomic_write, read_utf8, require_file, require_folder


def test_file_appears_when_the_block_ends(tmp_path):
    path = tmp_path / "new" / "a.svg"
    with atomic_write(path) as draft:
        assert Path(draft).suffix == ".svg"
        Path(draft).write_text("all of it", encoding="utf-8")
        assert not path.exists()
    assert path.read_text(encoding="utf-8") == "all of it"
    assert path.stat().st_mode & 0o777 == 0o644
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
    with pytest.raises(ValueError, match="/dev/null is no file that can be replaced"):
        require_file(Path("/dev/null"))
    with pytest.raises(OSError, match="file") as refused, atomic_write(tmp_path / "file" / "below"):
        raise AssertionError
    assert str(refused.value.filename).startswith(str(tmp_path))


def test_text_is_read_within_a_limit(tmp_path):
    path = tmp_path / "x.txt"
    path.write_bytes(b"\xef\xbb\xbf\xce\xb1")  # with a byte order mark
    assert read_utf8(path, 6) == "α"
    for content, reason in ((b"1234567", "longer than 6 bytes"), (b"ab\xff", "not UTF-8 at byte 2")):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=f"x.txt: {reason}$"):
            read_utf8(path, 6)
