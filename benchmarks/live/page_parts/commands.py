"""The commands that serve pages, as processes of their own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Thread


@dataclass(frozen=True)
class Linked:
    """A virtual meter and a live session at it, with their pages."""

    meter: subprocess.Popen
    live: subprocess.Popen
    control: str
    skin: str
    answers: str


@contextmanager
def linked(scene: str, model: Path) -> Iterator[Linked]:
    """Both of them, at the virtual meter's own pace."""
    anywhere = ["--port", 0, "--control-port", 0]
    with ExitStack() as stack:
        meter = stack.enter_context(
            _command("meter", "serve", "--scene", scene, "--page", *anywhere)
        )
        assert meter.stdout is not None
        resource, _, control = meter.stdout.readline().split()
        skin = meter.stdout.readline().split()[1]
        words = ["live", "--model", model, "--resource", resource, "--plain", "--page"]
        live = stack.enter_context(_command(*words))
        assert live.stdout is not None
        told = next(line for line in live.stdout if "page http" in line)
        next(line for line in live.stdout if line.count("\t") == 3)
        Thread(target=live.stdout.read, daemon=True).start()
        yield Linked(meter, live, control, skin, told.split()[-1])


def run(*words: object) -> None:
    """Run a command of rcskin. Raises where it fails."""
    subprocess.run(_words(words), check=True, stdout=subprocess.DEVNULL)


def ended_in(process: subprocess.Popen) -> float:
    """Seconds from Ctrl-C to the end."""
    begun = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.wait()
    return time.monotonic() - begun


def memory(process: subprocess.Popen) -> float:
    """Of a process, MB."""
    lines = Path(f"/proc/{process.pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS")).split()[1]) / 1e3


@contextmanager
def _command(*words: object) -> Iterator[subprocess.Popen]:
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(_words(words), env=environment, **pipes) as process:
        try:
            yield process
        finally:
            if process.poll() is None:
                ended_in(process)


def _words(words: tuple[object, ...]) -> list[str]:
    return [sys.executable, "-m", "rcskin", *map(str, words)]
