"""Checksums by which a file that was spoilt is noticed before it is parsed.

A file without one is read as it stands: older files, those of other tools, and those that a
library changed (HDF5 cuts off what stands behind its own end; a rewritten archive or store has
no checksum of ours).
"""

from __future__ import annotations

import hashlib
import json
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any, BinaryIO

from .errors import InputError
from .inputs import objects

HEX = 64
"""Characters of a SHA-256 in hexadecimal."""
AT_ONCE = 2**20
AT_END = b"\nsha256 of the bytes above: "
"""Of a binary file. HDF5 allows further bytes behind its end, and does not parse them."""
MEMBER = "sha256"
"""Of a ZIP archive, beside the members whose names and contents it covers."""
OF_STORE = "zarr.json.sha256"
"""Of a Zarr folder, as `sha256sum` writes it. Chunks have their own crc32c."""
LINES_WIDTH = 15
"""Digits enough for any disk."""
ABOVE = re.compile(rb'# rcskin_sha256 = "([0-9a-f]{64})"\n(# rcskin_lines = *(\d+)\n)')
OWN_KEYS = ("rcskin_sha256", "rcskin_lines")
UNSEALED = f'# {OWN_KEYS[0]} = "{"0" * HEX}"\n# {OWN_KEYS[1]} = {"0":>{LINES_WIDTH}}\n'
"""The first two lines of a CSV, for `seal_text` to fill in: the digest of all that stands below
its own line, and how many lines stand below both."""


def seal_binary(path: Path) -> None:
    """Append the digest of the file to it."""
    with path.open("r+b") as file:
        digest = _of_rest(file)
        file.write(AT_END + digest.encode() + b"\n")


def check_binary(path: Path) -> None:
    """Raises InputError where the file is not what its digest at the end says."""
    size = len(AT_END) + HEX + 1
    with path.open("rb") as file:
        length = file.seek(0, 2) - size
        file.seek(max(length, 0))
        end = file.read()
        if length < 0 or not end.startswith(AT_END):
            return
        file.seek(0)
        if _of_rest(file, length) != end[len(AT_END) : -1].decode("ascii", "replace"):
            raise _spoilt(path)


def seal_text(path: Path) -> None:
    """Fill in the first two lines of a CSV, which are UNSEALED."""
    digest_line, lines_line = UNSEALED.encode().splitlines(keepends=True)
    with path.open("r+b") as file:
        file.seek(len(UNSEALED))
        lines = sum(part.count(b"\n") for part in iter(lambda: file.read(AT_ONCE), b""))
        file.seek(len(digest_line))
        file.write(lines_line.replace(b"0".rjust(LINES_WIDTH), f"{lines:>{LINES_WIDTH}}".encode()))
        file.seek(len(digest_line))
        digest = _of_rest(file)
        file.seek(0)
        file.write(digest_line.replace(b"0" * HEX, digest.encode()))


def check_text(path: Path, content: bytes) -> bool:
    """Whether a CSV has a digest. Raises InputError where it is not what that says.

    Line ends of Windows and a byte order mark, which editors and version control add, do not count.
    """
    plain = content.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n")
    sealed = ABOVE.match(plain)
    if sealed is None:
        above = b"".join(plain.split(b"\n", 2)[:2])
        if any(key.encode() in above for key in OWN_KEYS):
            raise _changed(path, "the lines of its checksum are spoilt")
        return False
    found, told = plain.count(b"\n", sealed.end()), int(sealed[3])
    if found != told:
        raise _changed(path, f"{found} of {told} lines are there")
    if hashlib.sha256(plain[sealed.start(2) :]).hexdigest().encode() != sealed[1]:
        raise _changed(path, f"its {told} lines are not what their checksum says")
    return True


def seal_archive(path: Path) -> None:
    """Add the digest of all members to a ZIP archive."""
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(zipfile.ZipInfo(MEMBER), _of_members(archive))


def check_archive(path: Path, file: IO[bytes]) -> None:
    """Raises InputError where members of an archive are not what its digest says.

    path: only named. Raises as zipfile where it is no archive, or a member is damaged.
    """
    with zipfile.ZipFile(file) as archive:
        if MEMBER not in archive.namelist():
            return
        if archive.read(MEMBER) != _of_members(archive):
            raise _spoilt(path)


def seal_store(folder: Path) -> None:
    """Write the digest of a Zarr folder's consolidated metadata beside it."""
    digest = hashlib.sha256((folder / "zarr.json").read_bytes()).hexdigest()
    (folder / OF_STORE).write_bytes(f"{digest}  zarr.json\n".encode())


def check_store(folder: Path) -> bool:
    """Whether a Zarr folder has a digest; raises InputError where it is not what that says."""
    try:
        told = (folder / OF_STORE).read_bytes()
    except FileNotFoundError:
        return False
    digest = hashlib.sha256((folder / "zarr.json").read_bytes()).hexdigest()
    if told.split() != [digest.encode(), b"zarr.json"]:
        raise InputError(
            f"{folder}: spoilt or changed: zarr.json is not what {OF_STORE} in it says; use "
            f"another copy, or remove {OF_STORE} if you changed it"
        )
    return True


def sealed_json(content: Mapping[str, Any], *, allow_nan: bool = True) -> str:
    """An object as JSON, with the digest of what it says. Raises as json.dumps."""
    return json.dumps({**content, MEMBER: _of_json(content)}, allow_nan=allow_nan)


def unsealed_json(text: str) -> dict[str, Any]:
    """The object that a text holds, without its digest; one that never had any is as it stands.

    Raises ValueError where it is no object, or not what its digest says.
    """
    content = objects(text)
    if not isinstance(content, dict):
        raise ValueError("it is no object")
    told = content.pop(MEMBER, None)
    if told is not None and told != _of_json(content):
        raise ValueError("it is not what its checksum says")
    return content


def _of_json(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def _of_rest(file: BinaryIO, end: int | None = None) -> str:
    """In hexadecimal, from where the file stands, to its end or that place."""
    digest = hashlib.sha256()
    while part := file.read(AT_ONCE if end is None else min(AT_ONCE, end - file.tell())):
        digest.update(part)
    return digest.hexdigest()


def _of_members(archive: zipfile.ZipFile) -> bytes:
    """In hexadecimal, of the names and contents of all members but that of the digest."""
    digest = hashlib.sha256()
    for name in sorted(set(archive.namelist()) - {MEMBER}):
        own = hashlib.sha256(archive.read(name)).digest()
        digest.update(hashlib.sha256(name.encode()).digest() + own)
    return digest.hexdigest().encode()


def _spoilt(path: Path) -> InputError:
    return InputError(
        f"{path}: spoilt: its contents are not what its checksum says; use another copy"
    )


def _changed(path: Path, what: str) -> InputError:
    return InputError(
        f"{path}: cut off or changed since it was written: {what}; use another copy, or delete "
        f"its lines `# {'` and `# '.join(OWN_KEYS)}` if you changed it"
    )
