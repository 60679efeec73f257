"""Options that several of the meter's commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Interfaces = Annotated[list[str] | None, typer.Option("--interface", help="Interface; repeatable.")]
Resource = Annotated[str, typer.Option(help="VISA resource, e.g. TCPIP0::127.0.0.1::3500::SOCKET.")]
Source = Annotated[
    str,
    typer.Option(
        "--resource",
        help="VISA resource, e.g. TCPIP0::127.0.0.1::3500::SOCKET, or serial:PORT or "
        "tcp:HOST:PORT with --reader.",
    ),
]
ReaderFile = Annotated[
    Path | None,
    typer.Option("--reader", help="Description (TOML) of lines of JSON or CSV at the resource."),
]
ControlAddress = Annotated[
    str,
    typer.Option(
        help="Control port of the virtual meter: HOST:PORT, or TOKEN@HOST:PORT if another "
        "user or computer serves it."
    ),
]
Drift = Annotated[float, typer.Option(help="Allowed change of |Z| of the unpressed skin.")]
Timeout = Annotated[float, typer.Option(help="Longest time of an answer, s.")]
Baud = Annotated[int, typer.Option(help="Baud rate of a serial port.")]
Accuracy = Annotated[
    Path | None, typer.Option(help="Accuracy table (TOML); default: the 3522-50's.")
]
SwitchName = Annotated[
    str | None,
    typer.Option(
        "--switch",
        help="TABLE.toml, HOST:PORT of a virtual meter's control port, or `ask` (record).",
    ),
]
SwitchWith = Annotated[
    str | None, typer.Option(help="Command that switches; {interface} is replaced.")
]
Settle = Annotated[
    float | None, typer.Option(help="Seconds from turn to reading; default: the table's, or 0.05.")
]
