"""The meter of a recording: connected when it is needed, set as when the recording began."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..meter.errors import WrongMeterError
from ..meter.hioki import Meter
from ..meter.snapshot import restore
from .journal import Header


@dataclass
class Station:
    """The meter of a recording: connected when it is needed, set as when the recording began."""

    connect: Callable[[], Meter]
    header: Header | None = None
    meter: Meter | None = None

    def ready(self) -> Meter:
        """The meter, set up. Raises MeterError, WrongMeterError where it is another than before."""
        if self.meter is None:
            meter = self.connect()
            try:
                self._check(meter)
            except BaseException:
                meter.close()
                raise
            self.meter = meter
        return self.meter

    def close(self) -> None:
        """Let the meter go; `ready` connects anew."""
        if self.meter:
            self.meter.close()
            self.meter = None

    def _check(self, meter: Meter) -> None:
        if self.header is None:
            return
        if meter.identity.text != self.header.meter:
            raise WrongMeterError(
                f"{meter.talk.resource}: the recording began with {self.header.meter}, now "
                f"{meter.identity.text} answers; check which meter is connected"
            )
        restore(meter, self.header.settings)
