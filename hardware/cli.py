"""Commands of `rcskin meter`: serve and control a virtual meter, use a real one."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from ..simulator.requests.number_ranges import PORT, SEED, any_finite
from ..simulator.requests.options import complete_scene
from ..simulator.requests.request import Request, Writing, argument, typed
from ..simulator.requests.typer_commands import add_commands
from ..simulator.safe_text import say
from .options import (
    ACCURACY_TABLE,
    BAUD,
    CONTROL_ADDRESS,
    INTERFACES,
    READER_FILE,
    RESOURCE,
    TIMEOUT,
)
from .record_command import Gather, Record

if TYPE_CHECKING:
    from .virtual.instrument import Instrument
    from .virtual.meter_server import Ports
    from .virtual.served_skin import ServedSkin
    from .virtual.serving import PageOptions

CONTROL = "127.0.0.1:3501"
VIRTUAL = "TCPIP0::127.0.0.1::3500::SOCKET"
"""Default resource of `serve`."""

app = typer.Typer(
    help="Serve a virtual LCR meter, or use a real one.",
    no_args_is_help=True,
    suggest_commands=False,  # `requests/mistyped.py` does
    rich_markup_mode=None,
)


class Serve(Request, example="meter serve --scene sheet-5x5"):
    """Serve a virtual meter, or reader of lines, on TCP until interrupted."""

    scene: str | None = typed("A built-in scene, or a path.", complete=complete_scene, default=None)
    recorded: Sequence[Path] | None = typed(
        "Play recorded sweeps instead of a scene.", default=None
    )
    interface: Sequence[str] | None = typed(INTERFACES, default=None)
    host: str = typed("Address to listen at.", default="127.0.0.1")
    port: int = typed("TCP port; 0 takes any free one.", within=PORT, default=3500)
    control_port: int = typed("TCP port for commands such as press.", within=PORT, default=3501)
    script: Path | None = typed("Presses with times: lines `SECONDS PRESS`.", default=None)
    random: float | None = typed(
        "Press at random every so many seconds.", within=any_finite("s"), default=None
    )
    seed: int = typed("Seed of the session's errors and presses.", within=SEED, default=1)
    pace: float = typed("Factor on measuring times: 1 real, 0 none.", default=1)
    accuracy: Path | None = typed(ACCURACY_TABLE, default=None)
    model: str = typed(
        "Model to imitate: IM3523, E4980A, E4980AL, 4284A or E4990A.", default="IM3523"
    )
    reader: Path | None = typed(READER_FILE, default=None)
    page: bool = typed("Serve a page that presses the skin.", default=False)
    page_port: int | None = typed(
        "TCP port of the page; default: any free one.", within=PORT, default=None
    )

    def run(self) -> None:
        from .event_counter import counted_events
        from .reader.line_format import read_line_format
        from .virtual import served_skin, serving

        served = _served_skin(self.scene, self.recorded, self.interface, self.seed)
        press_routines = serving.routines(served, self.script, self.random, self.seed)
        if self.reader is None:
            device = _virtual_meter(served, self.pace, self.accuracy, self.model)
        else:
            device = served_skin.reader(served, read_line_format(self.reader), self.pace)
        page_options = _page_options(served, self.page, self.page_port)

        def on_listening(ports: Ports) -> None:
            resource = ports.line_resource if self.reader else ports.resource
            say(f"{resource}  control 127.0.0.1:{ports.control}")

        with counted_events(lambda text: say(f"rcskin: {text}", err=True)) as device.report:
            device.report_failure = partial(device.report, "failed readings")
            serving.serve(
                device,
                press_routines,
                on_listening,
                self.host,
                self.port,
                self.control_port,
                page_options,
            )


class Identify(Request):
    """List the meters that answer, with their resources."""

    resources: Sequence[str] | None = argument("VISA resources; default: all found.", default=None)
    timeout: float = typed(TIMEOUT, default=2.0)
    baud: int = typed(BAUD, default=9600)

    def run(self) -> int:
        from .meter.instruments import find_resources, probe

        names = self.resources or find_resources()
        answers = [(name, probe(name, self.timeout, self.baud)) for name in names]
        for name, answer in answers:
            say(answer.failure or f"{name}  {answer.identity}")
        if not names:
            say("no VISA resource found; name the meter's TCP socket", err=True)
        return int(not any(answer.identity for _, answer in answers))


class NewReader(Writing, example="meter new-reader reader.toml"):
    """Start a description of a reader's lines: a commented file with every key."""

    output: Path = argument("READER.toml, a new file to edit.")

    def run(self) -> None:
        from .reader.line_format import write_new_format

        write_new_format(self.output)
        say(f"{self.output}: edit it, then give it to record or live by --reader")


class Correct(Request, example="meter correct open --resource TCPIP0::127.0.0.1::3500::SOCKET"):
    """Acquire the open or short correction, or end it."""

    kind: str = argument("Correction: open or short.")
    resource: str = typed(RESOURCE)
    extent: str = typed("ALL, SPOT (Hioki) or OFF.", default="ALL")
    timeout: float = typed(TIMEOUT, default=5.0)
    baud: int = typed(BAUD, default=9600)

    def run(self) -> None:
        from ..simulator.sweeps import InputError
        from .meter.instruments import open_meter
        from .meter.lcr_meter import LcrMeter
        from .meter.lcr_meter import correct as acquire
        from .meter.termination import interruptible, orderly_termination
        from .record.managed_meter import ManagedMeter

        with orderly_termination() as report:
            station = ManagedMeter(
                lambda: open_meter(self.resource, self.timeout, self.baud), report=report
            )
            with station, interruptible():
                meter = station.ready()
                if not isinstance(meter, LcrMeter):
                    raise InputError(
                        f"{self.resource}: {meter.model} has no open or short correction"
                    )
                acquire(meter, self.kind.lower(), self.extent.upper())
                state = meter.open_correction, meter.short_correction
            say(f"open correction {state[0]}, short correction {state[1]}")


class Press(Request, example="meter press 2,3"):
    """Press the skin of a running virtual meter until the next press."""

    press: str = argument("ROW,COLUMN[:FACTOR][:FINGER], joined by '+', or none.")
    control: str = typed(CONTROL_ADDRESS, default=CONTROL)

    def run(self) -> None:
        from .control_client import send_request

        say(send_request(self.control, "press", press=self.press))
        if depths := send_request(self.control, "depths"):
            say(f"rcskin: note: {depths}", err=True)


class Select(Request):
    """Connect a running virtual meter to another interface of its skin."""

    interface: str = argument("Interface of the served skin.")
    control: str = typed(CONTROL_ADDRESS, default=CONTROL)

    def run(self) -> None:
        from .control_client import send_request

        say(send_request(self.control, "select", interface=self.interface))


class Misbehave(Request, example="meter misbehave late --times 2"):
    """Make a running virtual meter fail at its next answers."""

    kind: str = argument(
        "drop, late, silent, garbage, half, status, correction, forget, slow, stuck; of "
        "a reader: restart, miscount, repeat, interleave, endless, nan."
    )
    times: int = typed("Number of faults.", default=1)
    seconds: float = typed("Delay of late and slow, s.", within=any_finite("s"), default=2.0)
    status: int = typed("Status code of the failed reading.", default=7)
    control: str = typed(CONTROL_ADDRESS, default=CONTROL)

    def run(self) -> None:
        from .control_client import send_request

        send_request(
            self.control,
            "misbehave",
            kind=self.kind,
            times=self.times,
            seconds=self.seconds,
            status=self.status,
        )


add_commands(app, Serve, Record, Gather, Identify, NewReader, Correct, Press, Select, Misbehave)


def _served_skin(
    scene: str | None, recorded: Sequence[Path] | None, interfaces: Sequence[str] | None, seed: int
) -> ServedSkin:
    from ..simulator.requests.requested_scene import note_if_noise_free, requested_scene
    from ..simulator.sweeps import InputError, read_joined
    from .virtual import served_skin

    if (scene is None) == (not recorded):
        raise InputError("serve needs either --scene or --recorded")
    if recorded:
        return served_skin.recorded(read_joined(recorded), interfaces)
    assert scene is not None
    requested = requested_scene(scene)
    served = served_skin.simulated(requested.parts, interfaces, seed)
    note_if_noise_free(requested.name, requested.parts.setup, requested.parts.meter)
    return served


def _virtual_meter(
    served: ServedSkin, pace: float, accuracy: Path | None, model: str
) -> Instrument:
    """Virtual meter of a skin, with notes on what it does not do."""
    from ..simulator.meters.accuracy_table import DERIVED_TABLE
    from ..simulator.sweeps import InputError
    from .virtual import served_skin

    if served.parts is not None and served.parts.setup.gain:
        raise InputError(
            f"{served.parts.skin.name}: an LCR meter reads impedances, and the readings of this "
            "scene are gains; --reader FILE serves lines of a reader"
        )
    meter = served_skin.instrument(served, pace, accuracy or DERIVED_TABLE, model)
    if len(served.skins) > 1:
        say(
            f"rcskin: note: connected to interface {meter.interface} of "
            f"{', '.join(served.skins)}; `rcskin meter select` or --switch takes another",
            err=True,
        )
    for note in served_skin.notes(meter, served):
        say(f"rcskin: note: {note}", err=True)
    return meter


def _page_options(served: ServedSkin, page: bool, port: int | None) -> PageOptions | None:
    """Options of the requested page, or None. Raises InputError if they do not fit the skin."""
    from ..simulator.sweeps import InputError
    from .page.page_document import PageDocument
    from .virtual import serving

    if not page:
        if port is not None:
            raise InputError("--page-port needs --page")
        return None
    if served.parts is None:
        raise InputError("--page needs --scene: a recorded skin has no page")
    document = PageDocument.of(served.parts, "skin")
    return serving.PageOptions(document, port or 0, lambda address: say(f"page  {address.url}"))
