"""How the tests themselves run."""

import os
import subprocess
import sys
from pathlib import Path

import joblib
import pytest

SYSTEMS = Path(__file__).with_name("systems")


def test_there_is_one_worker_more_than_cores(pytestconfig):
    workers = pytestconfig.hook.pytest_xdist_auto_num_workers(config=pytestconfig)
    assert workers == joblib.cpu_count() + 1


SEEN = """
import sys
from rcskin.simulator import processes
print(processes.sys.platform, sys.platform)
"""


@pytest.mark.parametrize(("system", "platform"), [("windows", "win32"), ("macos", "darwin")])
def test_another_system_is_imitated_in_every_process(system, platform):
    paths = [str(SYSTEMS), *filter(None, [os.environ.get("PYTHONPATH")])]
    given = {"PYTHONPATH": os.pathsep.join(paths), "RCSKIN_TEST_SYSTEM": system}
    done = subprocess.run(
        [sys.executable, "-c", SEEN], capture_output=True, text=True, env={**os.environ, **given}
    )
    assert done.stdout.split() == [platform, sys.platform], done.stderr
