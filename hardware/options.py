"""Arguments that several of the meter's commands share."""

from __future__ import annotations

from ..simulator.requests.number_ranges import SHARE, AllowedRange, any_finite
from ..simulator.requests.request import How

INTERFACES = How("Interface; repeatable.", ("--interface",))
RESOURCE = How("VISA resource, e.g. TCPIP0::127.0.0.1::3500::SOCKET.")
SOURCE = How(
    "VISA resource, e.g. TCPIP0::127.0.0.1::3500::SOCKET, or serial:PORT or tcp:HOST:PORT with "
    "--reader."
)
READER_FILE = How("Description (TOML) of lines of JSON or CSV at the resource.")
CONTROL_ADDRESS = How(
    "Control port of the virtual meter: HOST:PORT, or TOKEN@HOST:PORT if another user or computer "
    "serves it."
)
DRIFT = How("Allowed change of |Z| of the unpressed skin.", within=SHARE)
TIMEOUT = How("Longest time of an answer, s.", within=any_finite("s"))
BAUD = How("Baud rate of a serial port.")
ACCURACY_TABLE = How("Accuracy table (TOML); default: the 3522-50's.")
SWITCH_NAME = How("TABLE.toml, HOST:PORT of a virtual meter's control port, or `ask` (record).")
SWITCH_WITH = How("Command that switches; {interface} is replaced.")
SETTLE_TIME = How(
    "Seconds from turn to reading; default: the table's, or 0.05.",
    within=AllowedRange(0.0, 3600.0, "s: an hour at most", "s"),
)
