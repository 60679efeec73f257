"""Options that several of the meter's commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Interfaces = Annotated[list[str] | None, typer.Option("--interface", help="Of the scene; repeat.")]
Resource = Annotated[str, typer.Option(help="VISA resource, e.g. TCPIP0::127.0.0.1::3500::SOCKET.")]
ControlAddress = Annotated[
    str,
    typer.Option(
        help="Control port of the virtual meter: HOST:PORT, or TOKEN@HOST:PORT where another "
        "user or computer serves it."
    ),
]
Timeout = Annotated[float, typer.Option(help="Seconds that an answer may take.")]
Baud = Annotated[int, typer.Option(help="Of a serial port.")]
Accuracy = Annotated[
    Path | None, typer.Option(help="Table of accuracy (TOML); else the one of the 3522-50.")
]
SwitchName = Annotated[
    str | None,
    typer.Option(
        "--switch",
        help="TABLE.toml, HOST:PORT of a virtual meter's control port, or `ask` (record).",
    ),
]
SwitchWith = Annotated[
    str | None, typer.Option(help="Switch by this command, with {interface} filled in.")
]
Settle = Annotated[
    float | None, typer.Option(help="Seconds from switching to reading; else the table's or 0.05.")
]
