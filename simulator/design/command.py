"""The command `rcskin design`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..requests.options import SceneName
from ..safe_text import say

if TYPE_CHECKING:
    from ..scene.design_goals import Design
    from ..scene.scene import Scene

FOLDER = Path("design")


def design(
    scene: SceneName,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for design.toml, tables and report.")
    ] = FOLDER,
    target: Annotated[
        str | None,
        typer.Option(
            help="What is to be told: pixel, column, row, pair or position.",
            autocompletion=lambda: ["pixel", "column", "row", "pair", "position"],
        ),
    ] = None,
    want: Annotated[
        float | None, typer.Option(help="Share of sweeps that is to be right, 0 to 1.")
    ] = None,
    within: Annotated[
        float | None, typer.Option(help="mm: of positions, so near half of all answers come.")
    ] = None,
    wires: Annotated[int | None, typer.Option(help="Foils with a wire, at most.")] = None,
    readings: Annotated[int | None, typer.Option(help="Readings of a sweep, at most.")] = None,
    frequencies: Annotated[
        int | None, typer.Option(help="Frequencies of each reading, at most.")
    ] = None,
    own_frequencies: Annotated[
        bool | None,
        typer.Option("--own-frequencies", help="Each reading may have its own, as many in all."),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="What a sweep may take on the meter, at most.")
    ] = None,
    band: Annotated[
        str | None,
        typer.Option(help="LOW:HIGH in Hz; what is absent is the scene's lowest or highest."),
    ] = None,
    sheet_resistance: Annotated[
        str | None, typer.Option(help="LOW:HIGH in ohm/sq, of both sheets.")
    ] = None,
    sheet_ratio: Annotated[
        float | None, typer.Option(help="One sheet's resistance over the other's, at most.")
    ] = None,
    foam_thickness: Annotated[
        str | None, typer.Option(help="LOW:HIGH in m, of a foam whose thickness the scene gives.")
    ] = None,
    grading: Annotated[
        float | None,
        typer.Option(help="Sheet resistance at one edge over that at the other, 1 to 10, at most."),
    ] = None,
    foils: Annotated[
        bool | None, typer.Option("--foils", help="Places and lengths of foils may change.")
    ] = None,
    foil_length: Annotated[
        str | None, typer.Option(help="LOW:HIGH of a foil's length over that of its edge.")
    ] = None,
    against_rest: Annotated[
        int | None, typer.Option(help="Sweeps at rest that each sweep is compared with.")
    ] = None,
    casts: Annotated[
        int | None, typer.Option(help="Skins drawn as `dataset.session` of the scene says.")
    ] = None,
    draws: Annotated[int, typer.Option(help="Sweeps drawn for each bound.")] = 2000,
    seed: Annotated[int, typer.Option(help="Of all random numbers.")] = 1,
) -> None:
    """Find the skin and the readings that tell most within what must be kept.

    Options stand before the table [design] of the scene. FOLDER/design.toml
    is the scene that was found, which every command takes; wiring.csv says
    which wires go to H and to L for each reading, report.html what each step
    gained, how flat the optimum is, and what to cast.

    A search that was killed goes on with the same command.
    """
    from ..bounds.sets import own_band
    from ..models.uniform import folded
    from ..progress import on_terminal
    from ..requests.requested_scene import requested_scene
    from ..scene.frequency import parse_band
    from ..scene.scene_files import scene_text
    from ..sweeps.accuracy_text import bound_text
    from .bench import Asking
    from .journal import Journal
    from .report.folder import answer, write_folder
    from .search import search

    loaded = folded(requested_scene(scene), "a design")
    given = {
        "target": target,
        "want": want,
        "within": _metres("--within", within),
        "wires": wires,
        "readings": readings,
        "frequencies": frequencies,
        "own_frequencies": own_frequencies,
        "seconds": seconds,
        "band": None if band is None else parse_band(band, own_band(loaded)),
        "sheet_resistance": _bounds("--sheet-resistance", sheet_resistance),
        "sheet_ratio": sheet_ratio,
        "foam_thickness": _bounds("--foam-thickness", foam_thickness),
        "grading": grading,
        "foils": foils,
        "foil_length": _bounds("--foil-length", foil_length),
        "against_rest": against_rest,
        "casts": casts,
    }
    asked = _asked(loaded, {name: value for name, value in given.items() if value is not None})
    bare = loaded.model_copy(update={"design": None})
    header = {"asked": asked.model_dump(mode="json"), "seed": seed, "draws": draws}
    journal = Journal(_journal_of(output), {"scene": scene_text(bare), **header})
    with on_terminal() as progress:
        asking = Asking(asked, seed, draws, journal, progress)
        found = search(bare, asking)
        write_folder(found, asking, output)
    journal.done()
    say(answer(found, asking))
    if asked.target != "position":
        skins = f"each of {asked.casts} known casts" if asked.casts else "a known skin"
        say(bound_text(asked.against_rest, skins))
    say(f"design, wiring and report in {output}")


def _asked(scene: Scene, given: dict[str, object]) -> Design:
    from pydantic import ValidationError

    from ..scene.design_goals import Design
    from ..scene.validation import one_line
    from ..sweeps import InputError

    table = scene.design.model_dump(exclude_unset=True) if scene.design else {}
    try:
        return Design.model_validate({**table, **given})
    except ValidationError as error:
        raise InputError(f"{scene.name}: design: {one_line(error, Design)}") from error


def _bounds(option: str, text: str | None) -> tuple[float, float] | None:
    from ..sweeps import InputError

    if text is None:
        return None
    try:
        low, high = map(float, text.split(":"))
    except ValueError:
        raise InputError(f"{option} must be LOW:HIGH, got {text!r}") from None
    return low, high


def _metres(option: str, millimetres: float | None) -> float | None:
    from ..sweeps import InputError

    if millimetres is None:
        return None
    if not 0 < millimetres < float("inf"):
        raise InputError(f"{option} must be finite and > 0 mm, got {millimetres:g}")
    return 1e-3 * millimetres


def _journal_of(output: Path) -> Path:
    from ..sweeps import checked_folder
    from .report.folder import WRITTEN

    return checked_folder(output, *WRITTEN).with_name(f".{output.name}.search")
