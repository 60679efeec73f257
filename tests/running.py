"""How tests run: on how many processes, with which examples, and what is skipped."""

import ctypes
import gc
import os
import platform
import signal
import subprocess
import sys
from functools import cache
from importlib import import_module
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before numpy: other cores have other tests
os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")  # before onnxruntime: no test reports to others
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # no worker, no process compiles modules anew

import joblib
import pytest
import typer
from hypothesis import Phase, settings

sys.dont_write_bytecode = False
settings.register_profile(
    "reproducible",
    phases=[Phase.explicit, Phase.generate],  # making a failing skin smaller takes minutes
    max_examples=12,
    deadline=None,
    derandomize=True,
    database=None,
)
settings.register_profile("search", max_examples=400, deadline=None)
settings.load_profile("reproducible")

for name, default in (("SIGINT", signal.default_int_handler), ("SIGQUIT", signal.SIG_DFL)):
    number = getattr(signal, name, None)  # Windows has no SIGQUIT
    if number and signal.getsignal(number) is signal.SIG_IGN:  # of a run in the background
        signal.signal(number, default)  # for children

SYSTEMS = Path(__file__).with_name("systems")
DRAW = """
import sys
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.view.painting import off_screen
try:
    with off_screen(8, 8) as plotter:
        plotter.screenshot()
except InputError as error:
    sys.exit(str(error))
"""


@cache
def why_no_pictures():
    """Found out in a process of its own, for VTK may take it down; "" where they can be drawn."""
    done = subprocess.run([sys.executable, "-c", DRAW], capture_output=True, text=True, timeout=120)
    if done.returncode == 1:
        return done.stderr.strip().splitlines()[-1]
    return f"VTK cannot draw here: it ends with {done.returncode}" if done.returncode else ""


def pytest_addoption(parser):
    """`--system windows` and `--system macos`: all tests as they would run there."""
    parser.addoption("--system", choices=["windows", "macos"], help="imitate another system")


def pytest_configure(config):
    """Imitates the system here and in all processes that begin from now on."""
    system = config.getoption("system")
    if system:
        sys.path.insert(0, str(SYSTEMS))
        imitated = import_module("imitated")
        imitated.imitate(system)
        if system == "windows":
            imitated.files.capture_in_code_page(imitated.Lasting())


@pytest.hookimpl(tryfirst=True)  # xdist has an answer of its own
def pytest_xdist_auto_num_workers():
    """One more than cores: a fifth of the time tests wait, for a meter, a browser or a process."""
    return joblib.cpu_count() + 1


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """What is collected stays to the end: it is not looked through for waste, then or later."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_runtest_setup(item):
    """Skips tests of pictures where none can be drawn, and those of calls that a system lacks."""
    unix = item.get_closest_marker("posix")
    if unix and "windows" in (item.config.getoption("system"), platform.system().lower()):
        pytest.skip(unix.args[0])
    if item.get_closest_marker("pictures") and why_no_pictures():
        pytest.skip(why_no_pictures())


@pytest.fixture(scope="session", autouse=True)
def commands_made_once():
    """The tree of commands is the same in a whole process; typer makes it anew for each line."""
    with pytest.MonkeyPatch.context() as patch:
        once = cache(typer.main.get_command)
        patch.setattr("typer.main.get_command", once)
        patch.setattr("typer.testing._get_command", once)
        yield


@pytest.fixture(scope="module", autouse=True)
def freed_memory_is_given_back():
    """To the system, where the C library keeps it: one worker meets the largest skins of many."""
    yield
    getattr(ctypes.pythonapi, "malloc_trim", int)(0)
