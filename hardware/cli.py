"""Commands of `rcskin meter`: serve and control a virtual meter, use a real one."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..simulator.requests.options import complete_scene
from ..simulator.safe_text import say
from .options import Accuracy, Baud, ControlAddress, Interfaces, ReaderFile, Resource, Timeout
from .record_command import gather, record

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


@app.command(epilog="Example: rcskin meter serve --scene sheet-5x5")
def serve(
    scene: Annotated[
        str | None,
        typer.Option(help="A built-in scene, or a path.", autocompletion=complete_scene),
    ] = None,
    recorded: Annotated[
        list[Path] | None, typer.Option(help="Play recorded sweeps instead of a scene.")
    ] = None,
    interface: Interfaces = None,
    host: Annotated[str, typer.Option(help="Address to listen at.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="TCP port; 0 takes any free one.")] = 3500,
    control_port: Annotated[int, typer.Option(help="TCP port for commands such as press.")] = 3501,
    script: Annotated[
        Path | None, typer.Option(help="Presses with times: lines `SECONDS PRESS`.")
    ] = None,
    random: Annotated[
        float | None, typer.Option(help="Press at random every so many seconds.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the session's errors and presses.")] = 1,
    pace: Annotated[float, typer.Option(help="Factor on measuring times: 1 real, 0 none.")] = 1,
    accuracy: Accuracy = None,
    model: Annotated[
        str, typer.Option(help="Model to imitate: IM3523, E4980A, E4980AL, 4284A or E4990A.")
    ] = "IM3523",
    reader: ReaderFile = None,
    page: Annotated[
        bool, typer.Option("--page", help="Serve a page that presses the skin.")
    ] = False,
    page_port: Annotated[
        int | None, typer.Option(help="TCP port of the page; default: any free one.")
    ] = None,
) -> None:
    """Serve a virtual meter, or reader of lines, on TCP until interrupted."""
    from .event_counter import counted_events
    from .reader.line_format import read_line_format
    from .virtual import served_skin, serving

    served = _served_skin(scene, recorded, interface, seed)
    press_routines = serving.routines(served, script, random, seed)
    if reader is None:
        device = _virtual_meter(served, pace, accuracy, model)
    else:
        device = served_skin.reader(served, read_line_format(reader), pace)
    page_options = _page_options(served, page, page_port)

    def on_listening(ports: Ports) -> None:
        resource = ports.line_resource if reader else ports.resource
        say(f"{resource}  control 127.0.0.1:{ports.control}")

    with counted_events(lambda text: say(f"rcskin: {text}", err=True)) as device.report:
        device.report_failure = partial(device.report, "failed readings")
        serving.serve(device, press_routines, on_listening, host, port, control_port, page_options)


app.command(epilog=f"Example: rcskin meter record sheet-5x5 --resource {VIRTUAL} -o run.nc")(record)
app.command("gather", epilog="Example: rcskin meter gather run.nc -o so-far.nc")(gather)


@app.command()
def identify(
    resources: Annotated[
        list[str] | None, typer.Argument(help="VISA resources; default: all found.")
    ] = None,
    timeout: Timeout = 2.0,
    baud: Baud = 9600,
) -> None:
    """List the meters that answer, with their resources."""
    from .meter.link.discovery import find_resources, probe

    names = resources or find_resources()
    answers = [(name, probe(name, timeout, baud)) for name in names]
    for name, answer in answers:
        say(answer.failure or f"{name}  {answer.identity}")
    if not names:
        say("no VISA resource found; name the meter's TCP socket", err=True)
    if not any(answer.identity for _, answer in answers):
        raise typer.Exit(1)


@app.command("new-reader", epilog="Example: rcskin meter new-reader reader.toml")
def new_reader(
    output: Annotated[Path, typer.Argument(help="READER.toml, a new file to edit.")],
) -> None:
    """Start a description of a reader's lines: a commented file with every key."""
    from .reader.line_format import write_new_format

    write_new_format(output)
    say(f"{output}: edit it, then give it to record or live by --reader")


@app.command(epilog=f"Example: rcskin meter correct open --resource {VIRTUAL}")
def correct(
    kind: Annotated[str, typer.Argument(help="Correction: open or short.")],
    resource: Resource,
    extent: Annotated[str, typer.Option(help="ALL, SPOT (Hioki) or OFF.")] = "ALL",
    timeout: Timeout = 5.0,
    baud: Baud = 9600,
) -> None:
    """Acquire the open or short correction, or end it."""
    from ..simulator.sweeps import InputError
    from .meter.correction import correct as acquire
    from .meter.instruments import open_meter
    from .meter.lcr_meter import LcrMeter
    from .meter.restoring.termination import interruptible, orderly_termination
    from .record.managed_meter import ManagedMeter

    with orderly_termination() as report:
        station = ManagedMeter(lambda: open_meter(resource, timeout, baud), report=report)
        with station, interruptible():
            meter = station.ready()
            if not isinstance(meter, LcrMeter):
                raise InputError(f"{resource}: {meter.model} has no open or short correction")
            acquire(meter, kind.lower(), extent.upper())
            state = meter.open_correction, meter.short_correction
        say(f"open correction {state[0]}, short correction {state[1]}")


@app.command(epilog="Example: rcskin meter press 2,3")
def press(
    press: Annotated[
        str, typer.Argument(help="ROW,COLUMN[:FACTOR][:FINGER], joined by '+', or none.")
    ],
    control: ControlAddress = CONTROL,
) -> None:
    """Press the skin of a running virtual meter until the next press."""
    from .control_client import send_request

    say(send_request(control, "press", press=press))
    if depths := send_request(control, "depths"):
        say(f"rcskin: note: {depths}", err=True)


@app.command()
def select(
    interface: Annotated[str, typer.Argument(help="Interface of the served skin.")],
    control: ControlAddress = CONTROL,
) -> None:
    """Connect a running virtual meter to another interface of its skin."""
    from .control_client import send_request

    say(send_request(control, "select", interface=interface))


@app.command(epilog="Example: rcskin meter misbehave late --times 2")
def misbehave(
    kind: Annotated[
        str,
        typer.Argument(
            help="drop, late, silent, garbage, half, status, correction, forget, slow, stuck; of "
            "a reader: restart, miscount, repeat, interleave, endless, nan."
        ),
    ],
    times: Annotated[int, typer.Option(help="Number of faults.")] = 1,
    seconds: Annotated[float, typer.Option(help="Delay of late and slow, s.")] = 2.0,
    status: Annotated[int, typer.Option(help="Status code of the failed reading.")] = 7,
    control: ControlAddress = CONTROL,
) -> None:
    """Make a running virtual meter fail at its next answers."""
    from .control_client import send_request

    send_request(control, "misbehave", kind=kind, times=times, seconds=seconds, status=status)


def _served_skin(
    scene: str | None, recorded: list[Path] | None, interfaces: list[str] | None, seed: int
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
