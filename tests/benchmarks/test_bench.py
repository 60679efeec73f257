"""What every benchmark does."""

import subprocess
import sys

IN_THE_BACKGROUND = """
import os, signal, sys

signal.signal(signal.SIGINT, signal.SIG_IGN)
os.execv(sys.executable, [sys.executable, "-c", sys.argv[1], "--quick"])
"""
BENCHMARK = """
import subprocess, sys
from rcskin.benchmarks.bench import launch

STARTED = "import signal; exit(signal.getsignal(signal.SIGINT) is not signal.default_int_handler)"
launch(lambda run: subprocess.run([sys.executable, "-c", STARTED]).returncode)
"""


def test_ctrl_c_reaches_what_a_benchmark_in_the_background_starts():
    command = [sys.executable, "-c", IN_THE_BACKGROUND, BENCHMARK]
    assert subprocess.run(command).returncode == 0
