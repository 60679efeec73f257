"""Files of other systems: their names, what stays while it is open, how text is kept."""

import builtins
import io
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

REMOVING = ("unlink", "remove", "rename", "replace", "rmdir")
OPEN = Path("/proc/self/fd")
FORBIDDEN = set('<>:"|?*\\') | set(map(chr, range(32)))
RESERVED = {
    "CON",
    "PRN",
    "AUX",
    "NUL",
    *(f"{port}{n}" for port in ("COM", "LPT") for n in range(1, 10)),
}
CODE_PAGE = "cp1252"


def hide_proc(context):
    """rcskin finds nothing in /proc and /sys; libraries of this system may need them."""
    _reopen(context, _without_proc)


def ignore_case(context):
    """No file beside one whose name differs in upper and lower case only: it would be that one."""
    _reopen(context, _without_twins)


def text_of_windows(context):
    """Names of Windows only; text without an encoding is cp1252, its lines end with CR and LF."""
    _reopen(context, _as_on_windows)
    context.setattr(os, "mkdir", _naming(os.mkdir))
    context.setattr(subprocess, "_text_encoding", lambda: CODE_PAGE)


def capture_in_code_page(context):
    """What a test captures of its own process has passed through the code page."""
    capture = sys.modules["_pytest.capture"]
    context.setattr(capture, "CaptureIO", _captured(capture.CaptureIO))


def without_links(context):
    """Symbolic links need a right that users lack; folders are no files, nor a place for calls."""
    context.setattr(os, "symlink", _refuse_link)
    context.setattr(os, "supports_dir_fd", set())
    context.setattr(shutil, "_use_fd_functions", False)
    context.setattr(os, "open", _naming(_only_files(os.open)))


def keep_open_ones(context):
    """What is open in this process, or a folder with it, is neither removed nor renamed."""
    unnamed = SimpleNamespace(**{**vars(os), "unlink": os.unlink})
    context.setattr(tempfile, "_os", unnamed)  # its files have no name here, once they are open
    for name in REMOVING:
        context.setattr(os, name, _refusing(getattr(os, name)))
    context.setattr(os, "rename", _never_onto(os.rename))


def _reopen(context, change):
    opened = change(io.open)
    for module in (builtins, io):
        context.setattr(module, "open", opened)


def _without_proc(call):
    def open(file, mode="r", *more, **options):
        name = os.fspath(file) if isinstance(file, str | os.PathLike) else ""
        if (
            isinstance(name, str)
            and name.startswith(("/proc/", "/sys/"))
            and _is_tested(_caller(2))
        ):
            raise FileNotFoundError(2, "No such file or directory", name)
        return call(file, mode, *more, **options)

    return open


def _is_tested(name):
    return name.startswith("rcskin.") and not name.startswith("rcskin.tests")


def _caller(depth):
    """Name of the module that makes a call, through pathlib or not."""
    frame = sys._getframe(depth)
    while frame is not None and frame.f_globals.get("__name__") in ("pathlib", __name__):
        frame = frame.f_back
    return frame.f_globals.get("__name__", "") if frame is not None else ""


def _without_twins(call):
    def open(file, mode="r", *more, **options):
        if isinstance(file, str | os.PathLike) and set(mode) & set("wxa"):
            _refuse_twins(os.fsdecode(file))
        return call(file, mode, *more, **options)

    return open


def _refuse_twins(path):
    folder, name = os.path.split(path)
    try:
        names = os.listdir(folder or ".")
    except OSError:
        return
    if name not in names and name.lower() in map(str.lower, names):
        raise AssertionError(f"{path} is another file of {folder}, but for upper and lower case")


def _as_on_windows(call):
    def open(
        file, mode="r", buffering=-1, encoding=None, errors=None, newline=None, *more, **options
    ):
        if set(mode) & set("wxa") and not isinstance(file, int):
            check_name(file)
        if "b" not in mode:
            encoding = CODE_PAGE if encoding in (None, "locale") else encoding
            newline = "\r\n" if newline is None and set(mode) & set("wxa") else newline
        return call(file, mode, buffering, encoding, errors, newline, *more, **options)

    return open


def check_name(path):
    """Raises OSError for a path in which a name cannot be on Windows."""
    for name in Path(os.fsdecode(path)).parts:
        if name in ("/", "..") or (name == "null" and os.fsdecode(path) == os.devnull):
            continue
        stem = name.partition(".")[0].rstrip().upper()
        if set(name) & FORBIDDEN or name.endswith((".", " ")) or stem in RESERVED:
            raise OSError(22, "The filename, directory name, or volume label is incorrect", name)


def _naming(call):
    def create(path, flags=0o777, *more, **options):
        if call.__name__ == "mkdir" or flags & os.O_CREAT:
            check_name(path)
        return call(path, flags, *more, **options)

    return create


def _only_files(call):
    def open(path, *more, **options):
        if os.path.isdir(path):
            raise PermissionError(13, "Permission denied", path)
        return call(path, *more, **options)

    return open


def _refuse_link(source, target, target_is_directory=False, *, dir_fd=None):
    raise OSError(22, "A required privilege is not held by the client", source, None, target)


def _captured(kind):
    class Captured(kind):
        """Text that a test captures is what the code page has."""

        def __init__(self):
            super(kind, self).__init__(
                io.BytesIO(), encoding=CODE_PAGE, newline="", write_through=True
            )

        def getvalue(self):
            return self.buffer.getvalue().decode(CODE_PAGE)

    return Captured


def _refusing(call):
    """The call, which refuses what is open in this process, or a folder with what is."""

    def refuse(*paths, **options):
        if _caller(2).startswith("filelock"):  # which removes an open file on this system alone
            return call(*paths, **options)
        places = [_place(path, options) for path in paths]
        for file in _open_files():
            if any(file == place or file.startswith(f"{place}/") for place in places):
                raise PermissionError(13, "The process cannot access the file", file)
        return call(*paths, **options)

    return refuse


def _never_onto(call):
    def rename(source, target, **options):
        if os.path.lexists(target) and not os.path.samefile(source, target):
            raise FileExistsError(17, "Cannot create a file when that file already exists", target)
        return call(source, target, **options)

    return rename


def _place(path, options):
    folder = options.get("dir_fd") or options.get("src_dir_fd")
    beneath = os.readlink(OPEN / str(folder)) if folder is not None else ""
    return os.path.realpath(os.path.join(beneath, os.fspath(path)))


def _open_files():
    found = []
    for entry in os.listdir(OPEN):
        try:
            found.append(os.readlink(OPEN / entry))
        except OSError:  # the listing itself
            continue
    return [path for path in found if os.path.isfile(path)]
