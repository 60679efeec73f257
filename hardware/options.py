"""Options that several of the meter's commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Interface = Annotated[str | None, typer.Option(help="The scene's interface; else its first.")]
Resource = Annotated[str, typer.Option(help="VISA resource, e.g. TCPIP0::127.0.0.1::3500::SOCKET.")]
ControlAddress = Annotated[str, typer.Option(help="HOST:PORT of the virtual meter's side door.")]
Timeout = Annotated[float, typer.Option(help="Seconds that an answer may take.")]
Baud = Annotated[int, typer.Option(help="Of a serial port.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace a file that is there.")]
Accuracy = Annotated[
    Path | None, typer.Option(help="Table of accuracy (TOML); else the one of the 3522-50.")
]
