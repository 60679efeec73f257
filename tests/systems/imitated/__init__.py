"""Windows and macOS as far as Linux can imitate them, for a whole process and all it starts.

`pytest --system windows` runs tests so. Calls that a system lacks are taken away, others refuse
what it refuses, and modules of rcskin see its name in `sys.platform` and `os.name`.
"""

import os
import sys
from importlib.machinery import PathFinder
from pathlib import Path
from types import ModuleType

from . import files, kernel, processes

NAMES = {"windows": ("win32", "nt"), "macos": ("darwin", "posix")}
"""`sys.platform` and `os.name` of each system."""
VARIABLE = "RCSKIN_TEST_SYSTEM"


class Lasting:
    """The methods of pytest.MonkeyPatch that systems use, for changes that nobody takes back."""

    def setattr(self, target, name, value, raising=True):
        setattr(target, name, value)

    def delattr(self, target, name, raising=True):
        if hasattr(target, name):
            delattr(target, name)

    def setitem(self, target, name, value):
        target[name] = value


def imitate(system):
    """Makes this process and those that it starts behave as on `windows` or `macos`."""
    if getattr(sys, "imitated_system", None) == system:
        return
    sys.imitated_system = system
    folder = str(Path(__file__).parents[1])
    paths = [each for each in os.environ.get("PYTHONPATH", "").split(os.pathsep) if each]
    if folder not in paths:
        os.environ["PYTHONPATH"] = os.pathsep.join([folder, *paths])
    os.environ[VARIABLE] = system
    take_away(system, Lasting())
    if system == "windows":
        os.environ.setdefault("PYTHONIOENCODING", files.CODE_PAGE)
        processes.coarse_clocks(Lasting())
    sys.meta_path.insert(0, Finder(_seen(system)))


def take_away(system, context):
    """Takes away what the system lacks. context: a pytest.MonkeyPatch, or Lasting."""
    processes.spawn_only(context)
    files.hide_proc(context)
    files.ignore_case(context)
    if system == "windows":
        processes.without_unix(context)
        files.keep_open_ones(context)
        files.without_links(context)
        files.text_of_windows(context)
        kernel.add(context)
    for name, module in [*sys.modules.items()]:
        if _is_tested(name):
            show(module, _seen(system), context)


def _seen(system):
    """Modules of rcskin see the name of the system; libraries see that of this one."""
    platform, name = NAMES[system]
    return {"sys": renamed(sys, platform=platform), "os": renamed(os, name=name)}


def _is_tested(name):
    return name.startswith("rcskin.") and not name.startswith("rcskin.tests")


def renamed(module, **here):
    """The module, of which some attributes differ; changes go to the module itself."""
    usual = {name: getattr(module, name) for name in here}

    class Renamed(ModuleType):
        def __getattribute__(self, name):
            """The attribute; one that a test has changed is as the test has it."""
            current = getattr(module, name)
            return here[name] if name in here and current == usual[name] else current

        def __setattr__(self, name, value):
            setattr(module, name, value)

        def __delattr__(self, name):
            delattr(module, name)

    return Renamed(module.__name__)


class Finder:
    """Finds modules of rcskin as usual, and shows them the name of the system."""

    def __init__(self, seen):
        self._seen = seen

    def find_spec(self, name, path=None, target=None):
        if not _is_tested(name):
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def exec_module(module):
                execute(module)
                show(module, self._seen, Lasting())

            spec.loader.exec_module = exec_module
        return spec


def show(module, seen, context):
    for name, renamed in seen.items():
        if vars(module).get(name) in (sys, os):
            context.setattr(module, name, renamed)
