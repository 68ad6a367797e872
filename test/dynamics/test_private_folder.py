"""A private folder: what others could have written is not read, nor what is cut off or spoilt."""

import grp
import hashlib
import os
import pathlib
import pwd
import subprocess
import sys

from helpers.disk import full_disk
from push_dynamics.private_folder import PrivateFolder, warn_once
import pytest

CONTENT = bytes(range(256)) * 5
NOBODY = 65534
NEEDS_SUPERUSER = pytest.mark.skipif(os.geteuid() != 0,
                                     reason='only the superuser makes files of others')
# Writes a file again and again, all of its bytes alike.
WRITER = """
import pathlib, sys
from push_dynamics.private_folder import PrivateFolder
folder = PrivateFolder(pathlib.Path(sys.argv[1]))
input()
for _ in range(40):
    folder.write('file', bytes([int(sys.argv[2])]) * 300_000)
"""


@pytest.fixture
def path(tmp_path):
    """Make a folder with a file."""
    folder = tmp_path / 'private'
    PrivateFolder(folder).write('file', CONTENT)
    return folder


def files(path):
    """List the names in a folder."""
    return sorted(found.name for found in path.iterdir())


def test_what_is_written_is_read(path):
    """By the name that it was written under, and nobody but the user can."""
    folder = PrivateFolder(path)
    assert folder.read('file') == CONTENT
    assert folder.read('other') is None
    assert path.stat().st_mode & 0o777 == 0o700
    assert (path / 'file').stat().st_mode & 0o777 == 0o600
    assert files(path) == ['file']


def test_folders_above_are_made_for_the_user_alone(tmp_path):
    """Whatever is usual elsewhere: a user of a group makes folders that all of it may change."""
    before = os.umask(0o002)
    try:
        PrivateFolder(tmp_path / 'a' / 'b' / 'c').write('file', CONTENT)
    finally:
        os.umask(before)
    assert PrivateFolder(tmp_path / 'a' / 'b' / 'c').read('file') == CONTENT
    assert (tmp_path / 'a').stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize('length', [0, 1, 31, 32, 33, 640, 32 + len(CONTENT) - 1])
def test_a_file_that_is_cut_off_is_none(path, length):
    """And made again."""
    (path / 'file').write_bytes((path / 'file').read_bytes()[:length])
    check_made_again(path)


@pytest.mark.parametrize('place', [0, 31, 32, 700, -1])
def test_a_file_with_a_wrong_bit_is_none(path, place):
    """And made again."""
    content = bytearray((path / 'file').read_bytes())
    content[place] ^= 1
    (path / 'file').write_bytes(content)
    check_made_again(path)


def check_made_again(path):
    """Check that what is there counts as none."""
    folder = PrivateFolder(path)
    assert folder.read('file') is None
    assert folder.read_or_make('file', lambda: CONTENT) == CONTENT
    assert folder.read('file') == CONTENT


def test_a_file_under_the_name_of_another_is_none(path):
    """One is not taken for the other."""
    (path / 'file').rename(path / 'other')
    assert PrivateFolder(path).read('other') is None


def test_a_file_that_others_may_write_to_is_none(path):
    """With a digest that fits."""
    (path / 'file').chmod(0o602)
    assert PrivateFolder(path).read('file') is None


@NEEDS_SUPERUSER
def test_a_file_of_another_user_is_none(path):
    """With a digest that fits."""
    os.chown(path / 'file', NOBODY, -1)
    assert PrivateFolder(path).read('file') is None


def test_no_link_is_read_nor_waited_for_a_writer(path):
    """Of a file only."""
    (path / 'file').rename(path.parent / 'file')
    (path / 'file').symlink_to(path.parent / 'file')
    assert PrivateFolder(path).read('file') is None
    (path / 'file').unlink()
    os.mkfifo(path / 'file')
    assert PrivateFolder(path).read('file') is None


@pytest.mark.parametrize('mode', [0o702, 0o777, 0o1777])
def test_a_folder_that_others_may_write_to_is_refused(path, mode):
    """By its name and mode."""
    path.chmod(mode)
    with pytest.raises(PermissionError, match=f'{path}: got mode {mode:o}, .*chmod go-w'):
        PrivateFolder(path)


@pytest.mark.parametrize('mode', [0o702, 0o777])
def test_so_is_one_below_such_a_folder(path, mode):
    """Others could put their own in its place."""
    path.parent.chmod(mode)
    with pytest.raises(PermissionError, match=f'{path.parent}: got mode {mode:o}'):
        PrivateFolder(path)


@pytest.mark.parametrize('name, members, is_refused', [
    ('own', [], False), ('own', ['own'], False), ('own', ['own', 'somebody'], True),
    ('staff', [], True)])
def test_the_group_may_write_only_where_nobody_else_is_in_it(path, monkeypatch, name, members,
                                                             is_refused):
    """Debian gives each user a group of the same name, and lets it write by default."""
    account = pwd.getpwuid(os.geteuid())
    names = [account.pw_name if member == 'own' else member for member in (name, *members)]
    monkeypatch.setattr(grp, 'getgrgid', lambda group: grp.struct_group(
        (names[0], 'x', group, names[1:])))
    os.chown(path, -1, account.pw_gid)
    path.chmod(0o770)
    if not is_refused:
        assert PrivateFolder(path).read('file') == CONTENT
        return
    with pytest.raises(PermissionError, match=f'{path}: got mode 770'):
        PrivateFolder(path)


def test_a_folder_of_the_user_in_one_for_everybody_is_read(path):
    """As in /tmp, where nobody can put another in its place."""
    path.parent.chmod(0o1777)
    assert PrivateFolder(path).read('file') == CONTENT


def test_a_folder_of_another_user_is_refused(path):
    """Told by number."""
    another = os.geteuid() + 1
    with pytest.raises(PermissionError, match=f'expected user {another}'):
        PrivateFolder(path, another)


@NEEDS_SUPERUSER
@pytest.mark.parametrize('depth', [0, 1])
def test_a_true_folder_of_another_user_is_refused(path, depth):
    """The folder, or one above it."""
    folder = [path, path.parent][depth]
    os.chown(folder, NOBODY, -1)
    with pytest.raises(PermissionError, match=f'{folder}: got .* of user {NOBODY}'):
        PrivateFolder(path)


def test_links_of_the_user_are_followed(path):
    """The way they lead is checked too."""
    (path.parent / 'cache').symlink_to('private/../private')
    assert PrivateFolder(path.parent / 'cache').path == path
    path.chmod(0o777)
    with pytest.raises(PermissionError, match=f'{path}: got mode 777'):
        PrivateFolder(path.parent / 'cache')


@NEEDS_SUPERUSER
def test_links_of_others_are_not(path):
    """They may lead to a folder of the user with files that others have chosen."""
    path.parent.chmod(0o1777)
    link = path.parent / 'cache'
    link.symlink_to(path)
    os.lchown(link, NOBODY, -1)
    with pytest.raises(PermissionError, match=f'{link}: got .* of user {NOBODY}'):
        PrivateFolder(link)


def test_links_in_a_circle_end(tmp_path):
    """With an error of the disk."""
    (tmp_path / 'circle').symlink_to('circle')
    with pytest.raises(OSError, match='links'):
        PrivateFolder(tmp_path / 'circle')


def test_a_full_disk_leaves_what_there_was(path):
    """It is told once, and what was made is returned."""
    warn_once.cache_clear()
    folder = PrivateFolder(path)
    with full_disk(100), pytest.warns(RuntimeWarning, match='File too large') as warned:
        folder.write('file', b'more' * 1000)
        assert folder.read_or_make('other', lambda: CONTENT) == CONTENT
    assert len(warned) == 1
    assert folder.read('file') == CONTENT
    assert set(files(path)) == {'file', 'other.lock'}


def test_of_two_processes_that_write_at_once_each_file_is_whole(path):
    """Whoever reads meanwhile sees one of both, or what was there before."""
    environment = {**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)}
    writers = [subprocess.Popen([sys.executable, '-c', WRITER, str(path), number],
                                env=environment, stdin=subprocess.PIPE)
               for number in ('1', '2')]
    folder = PrivateFolder(path)
    possible = {hashlib.sha256(content).digest()
                for content in (CONTENT, b'\1' * 300_000, b'\2' * 300_000)}
    for writer in writers:
        writer.stdin.write(b'\n')
        writer.stdin.close()
    while any(writer.poll() is None for writer in writers):
        assert hashlib.sha256(folder.read('file')).digest() in possible
    assert [writer.wait() for writer in writers] == [0, 0]
    assert len(folder.read('file')) == 300_000
    assert files(path) == ['file']


def test_a_path_without_its_root_is_that_from_the_working_folder(path, monkeypatch):
    """As that of an environment variable may be."""
    monkeypatch.chdir(path.parent)
    assert PrivateFolder(pathlib.Path('private')).read('file') == CONTENT
