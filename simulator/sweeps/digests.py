"""Checksums that detect a corrupt file before it is parsed.

A file without a checksum is read as it is: older files, files of other tools, and files that a
library changed (HDF5 cuts off bytes behind its own end; a rewritten archive or store has no
checksum of ours).
"""

from __future__ import annotations

import hashlib
import json
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

from .errors import InputError
from .inputs import objects

HEX = 64
"""Number of hexadecimal characters of a SHA-256 digest."""
BLOCK_SIZE = 2**20
DIGEST_PREFIX = b"\nsha256 of the bytes above: "
"""Text before the digest at the end of a binary file; HDF5 ignores bytes behind its end."""
MEMBER = "sha256"
"""Member of a ZIP archive with the digest of the names and contents of all other members."""
STORE_DIGEST = "zarr.json.sha256"
"""Digest file of a Zarr folder in the format of `sha256sum`; chunks have their own crc32c."""
LINES_WIDTH = 15
"""Width of the line count: enough digits for any disk."""
FIRST_LINES = re.compile(rb'# rcskin_sha256 = "([0-9a-f]{64})"\n(# rcskin_lines = *(\d+)\n)')
OWN_KEYS = ("rcskin_sha256", "rcskin_lines")
UNSEALED = f'# {OWN_KEYS[0]} = "{"0" * HEX}"\n# {OWN_KEYS[1]} = {"0":>{LINES_WIDTH}}\n'
"""First two lines of a CSV before `seal_text` fills them in: the digest of everything below the
first line, and the number of lines below both."""


def seal_binary(path: Path) -> None:
    """Appends the digest of a file to the file."""
    with path.open("r+b") as file:
        digest = _digest_to_end(file)
        file.write(DIGEST_PREFIX + digest.encode() + b"\n")


def check_binary(path: Path) -> None:
    """Raises InputError if the file does not match the digest at its end."""
    size = len(DIGEST_PREFIX) + HEX + 1
    with path.open("rb") as file:
        length = file.seek(0, 2) - size
        file.seek(max(length, 0))
        end = file.read()
        if length < 0 or not end.startswith(DIGEST_PREFIX):
            return
        file.seek(0)
        if _digest_to_end(file, length) != end[len(DIGEST_PREFIX) : -1].decode("ascii", "replace"):
            raise _corrupt_error(path)


def seal_text(path: Path) -> None:
    """Fills in the first two lines of a CSV, which are UNSEALED."""
    digest_line, lines_line = UNSEALED.encode().splitlines(keepends=True)
    with path.open("r+b") as file:
        file.seek(len(UNSEALED))
        lines = sum(part.count(b"\n") for part in iter(lambda: file.read(BLOCK_SIZE), b""))
        file.seek(len(digest_line))
        file.write(lines_line.replace(b"0".rjust(LINES_WIDTH), f"{lines:>{LINES_WIDTH}}".encode()))
        file.seek(len(digest_line))
        digest = _digest_to_end(file)
        file.seek(0)
        file.write(digest_line.replace(b"0" * HEX, digest.encode()))


def check_text(path: Path, content: bytes) -> bool:
    """True if a CSV has a digest. Raises InputError if the content does not match it.

    Windows line ends and a byte order mark, which editors and version control add, are ignored.
    """
    plain = content.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n")
    sealed = FIRST_LINES.match(plain)
    if sealed is None:
        above = b"".join(plain.split(b"\n", 2)[:2])
        if any(key.encode() in above for key in OWN_KEYS):
            raise _changed_error(path, "the lines of its checksum are spoilt")
        return False
    found, expected = plain.count(b"\n", sealed.end()), int(sealed[3])
    if found != expected:
        raise _changed_error(path, f"only {found} of {expected} lines are left")
    if hashlib.sha256(plain[sealed.start(2) :]).hexdigest().encode() != sealed[1]:
        raise _changed_error(path, f"its {expected} lines do not match their checksum")
    return True


def seal_archive(archive: zipfile.ZipFile) -> None:
    """Adds the digest of all members to a ZIP archive that is open for reading and appending."""
    archive.writestr(zipfile.ZipInfo(MEMBER), _members_digest(archive))


def check_archive(path: Path, archive: zipfile.ZipFile) -> None:
    """Raises InputError if the members of an archive do not match its digest; path: its name."""
    if MEMBER in archive.namelist() and archive.read(MEMBER) != _members_digest(archive):
        raise _corrupt_error(path)


def seal_store(folder: Path) -> None:
    """Writes the digest of a Zarr folder's consolidated metadata beside the metadata."""
    digest = hashlib.sha256((folder / "zarr.json").read_bytes()).hexdigest()
    (folder / STORE_DIGEST).write_bytes(f"{digest}  zarr.json\n".encode())


def check_store(folder: Path) -> bool:
    """True if a Zarr folder has a digest; raises InputError if the metadata do not match it."""
    try:
        stored = (folder / STORE_DIGEST).read_bytes()
    except FileNotFoundError:
        return False
    digest = hashlib.sha256((folder / "zarr.json").read_bytes()).hexdigest()
    if stored.split() != [digest.encode(), b"zarr.json"]:
        raise InputError(
            f"{folder}: spoilt or changed: zarr.json is not what {STORE_DIGEST} in it says; use "
            f"another copy, or remove {STORE_DIGEST} if you changed it"
        )
    return True


def sealed_json(content: Mapping[str, Any], *, allow_nan: bool = True) -> str:
    """An object as JSON with the digest of its content. Raises as json.dumps."""
    return json.dumps({**content, MEMBER: _json_digest(content)}, allow_nan=allow_nan)


def unsealed_json(text: str) -> dict[str, Any]:
    """The object in a JSON text, without its digest; texts without a digest are accepted.

    Raises ValueError if it is no object or does not match its digest.
    """
    content = objects(text)
    if not isinstance(content, dict):
        raise ValueError("it is no object")
    stored = content.pop(MEMBER, None)
    if stored is not None and stored != _json_digest(content):
        raise ValueError("it does not match its checksum")
    return content


def _json_digest(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def _digest_to_end(file: BinaryIO, end: int | None = None) -> str:
    """Hexadecimal digest from the current position to the end of the file, or to `end`."""
    digest = hashlib.sha256()
    while part := file.read(BLOCK_SIZE if end is None else min(BLOCK_SIZE, end - file.tell())):
        digest.update(part)
    return digest.hexdigest()


def _members_digest(archive: zipfile.ZipFile) -> bytes:
    """Hexadecimal digest of the names and contents of all members except the digest itself."""
    digest = hashlib.sha256()
    for name in sorted(set(archive.namelist()) - {MEMBER}):
        own = hashlib.sha256(archive.read(name)).digest()
        digest.update(hashlib.sha256(name.encode()).digest() + own)
    return digest.hexdigest().encode()


def _corrupt_error(path: Path) -> InputError:
    return InputError(
        f"{path}: spoilt: its contents are not what its checksum says; use another copy"
    )


def _changed_error(path: Path, what: str) -> InputError:
    return InputError(
        f"{path}: cut off or changed since it was written: {what}; use another copy, or delete "
        f"its lines `# {'` and `# '.join(OWN_KEYS)}` if you changed it"
    )
