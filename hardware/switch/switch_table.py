"""Description of a switch in TOML: the relays or channels of each interface."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, ClassVar, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    field_validator,
    model_validator,
)

from ...simulator.meters.reading_time import SETTLE
from ...simulator.sweeps import InputError, inputs
from .relays import NUMERALS, Closed, LcusBoard, NumatoBoard, SerialLine
from .scpi import ROUTINGS, ScpiSwitch, open_scpi
from .switch import DeviceSwitch

Seconds = Annotated[float, Field(ge=0, le=3600)]
Positive = Annotated[float, Field(gt=0, le=3600)]
Relays = tuple[int, ...]


class _SwitchTable(BaseModel):
    """Common keys of all kinds.

    interface: numbers of the relays that are on, by interface; all others named here are off.
    settle: s from the end of a turn to the first reading. timeout: longest time of an answer or a
    turn, s.
    """

    numbers: ClassVar[tuple[int, int]]
    model_config = ConfigDict(extra="forbid", frozen=True)

    interface: dict[str, Relays] = Field(min_length=1)
    settle: Seconds = SETTLE
    timeout: Positive = 1.0
    baud: Annotated[int, Field(gt=0)] = 9600

    @field_validator("interface")
    @classmethod
    def _sound(cls, value: dict[str, Relays]) -> dict[str, Relays]:
        low, high = cls.numbers
        if not all(low <= number <= high for relays in value.values() for number in relays):
            raise ValueError(f"numbers must be in {low}..{high}")
        if len({frozenset(relays) for relays in value.values()}) < len(value):
            raise ValueError("two interfaces have the same relays")
        return value

    @property
    def positions(self) -> dict[str, Closed]:
        """Closed relays or channels by interface."""
        return {name: frozenset(relays) for name, relays in self.interface.items()}

    @property
    def driven(self) -> Closed:
        """All relays or channels of the switch."""
        return frozenset[int]().union(*self.positions.values())


class NumatoTable(_SwitchTable):
    """A board of Numato Lab. port: a serial port, or a pyserial URL."""

    numbers: ClassVar = 0, len(NUMERALS) - 1
    kind: Literal["numato"]
    port: str

    def opened(self) -> NumatoBoard:
        """The board, connected."""
        return NumatoBoard(SerialLine(self.port, self.baud, self.timeout), self.driven)


class LcusTable(_SwitchTable):
    """A board of the LCUS kind. query: bytes in hex that ask for the state, or empty."""

    numbers: ClassVar = 1, 255
    kind: Literal["lcus"]
    port: str
    query: str = "FF"

    @field_validator("query")
    @classmethod
    def _hexadecimal(cls, value: str) -> str:
        bytes.fromhex(value)
        return value

    def opened(self) -> LcusBoard:
        """The board, connected."""
        line = SerialLine(self.port, self.baud, self.timeout)
        return LcusBoard(line, self.driven, bytes.fromhex(self.query))


class ScpiTable(_SwitchTable):
    """An SCPI switch at a VISA resource. routing: one of `scpi.ROUTINGS`."""

    numbers: ClassVar = 1, 99_999
    kind: Literal["scpi"]
    resource: str
    routing: Literal["single", "multiple", "states"] = "single"

    def opened(self) -> ScpiSwitch:
        """The switch, connected."""
        routing = ROUTINGS[self.routing]
        return open_scpi(self.resource, self.baud, self.timeout, self.driven, routing)

    @model_validator(mode="after")
    def _one_at_a_time(self) -> Self:
        if self.routing == "single" and any(len(each) != 1 for each in self.interface.values()):
            raise ValueError("`routing` single closes exactly one channel; see multiple and states")
        return self


SwitchTable = Annotated[NumatoTable | LcusTable | ScpiTable, Field(discriminator="kind")]


def read_switch(path: Path, settle: float | None = None) -> DeviceSwitch[Closed]:
    """Switch of a TOML file. settle: s, overrides the file's.

    Raises InputError with the file, the key and the fault.
    """
    try:
        table = TypeAdapter(SwitchTable).validate_python(
            inputs.tables(inputs.text(path, inputs.SETTINGS))
        )
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no table of a switch in TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"][1:] or first["loc"])) or "kind"
        raise InputError(f"{path}: `{key}`: {first['msg']}, got {first['input']}") from error
    waiting = table.settle if settle is None else settle
    return DeviceSwitch(table.opened, table.positions, waiting, table.timeout)
