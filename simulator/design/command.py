"""The command `rcskin design`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..requests.options import SceneName
from ..safe_text import say

if TYPE_CHECKING:
    from ..scene.design_goals import Design
    from ..scene.parts import Plan, Skin

FOLDER = Path("design")


def design(
    scene: SceneName,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for design.toml, tables and report.")
    ] = FOLDER,
    target: Annotated[
        str | None,
        typer.Option(
            help="What the readings must identify: pixel, column, row, pair or position.",
            autocompletion=lambda: ["pixel", "column", "row", "pair", "position"],
        ),
    ] = None,
    want: Annotated[
        float | None, typer.Option(help="Required share of correct sweeps, 0 to 1.")
    ] = None,
    within: Annotated[
        float | None, typer.Option(help="Required median error of positions, mm.")
    ] = None,
    wires: Annotated[int | None, typer.Option(help="Largest number of foils with a wire.")] = None,
    readings: Annotated[
        int | None, typer.Option(help="Largest number of readings in a sweep.")
    ] = None,
    frequencies: Annotated[
        int | None, typer.Option(help="Largest number of frequencies of a reading.")
    ] = None,
    own_frequencies: Annotated[
        bool | None,
        typer.Option(
            "--own-frequencies",
            help="Each reading may have its own frequencies, the same number in total.",
        ),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="Longest time of a sweep on the meter.")
    ] = None,
    band: Annotated[
        str | None,
        typer.Option(help="LOW:HIGH in Hz; default: the scene's lowest and highest frequency."),
    ] = None,
    sheet_resistance: Annotated[
        str | None, typer.Option(help="LOW:HIGH in ohm/sq, for both sheets.")
    ] = None,
    sheet_ratio: Annotated[
        float | None, typer.Option(help="Largest ratio of one sheet's resistance to the other's.")
    ] = None,
    foam_thickness: Annotated[
        str | None, typer.Option(help="LOW:HIGH in m, if the scene states the foam's thickness.")
    ] = None,
    grading: Annotated[
        float | None,
        typer.Option(help="Largest ratio of a sheet's resistance at opposite edges, 1 to 10."),
    ] = None,
    foils: Annotated[
        bool | None, typer.Option("--foils", help="Positions and lengths of foils may change.")
    ] = None,
    foil_length: Annotated[
        str | None, typer.Option(help="LOW:HIGH, a foil's length over that of its edge.")
    ] = None,
    against_rest: Annotated[
        int | None, typer.Option(help="Number of baseline sweeps that each sweep is compared with.")
    ] = None,
    casts: Annotated[
        int | None, typer.Option(help="Number of skin samples, drawn from `dataset.session`.")
    ] = None,
    draws: Annotated[int, typer.Option(help="Number of sweeps drawn for each bound.")] = 2000,
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 1,
) -> None:
    """Find the best skin and readings within given constraints.

    Options override the table [design] of the scene. FOLDER/design.toml is
    the designed scene, which every command accepts. wiring.csv lists the
    wires at H and at L for each reading. report.html has the gain of each
    step, the sensitivity of the optimum and the properties to make.

    Run the same command again to continue an interrupted search.
    """
    from ..bounds.frequency_sets import own_band
    from ..models.mechanics.force_depths import pressed_by_factors
    from ..progress import on_terminal
    from ..requests.requested_scene import requested_scene
    from ..scene.frequency import parse_band
    from ..sweeps.units import bound_text
    from .evaluator import SearchSettings
    from .report.design_folder import answer, write_folder
    from .search import search
    from .search_journal import SearchJournal

    loaded = pressed_by_factors(requested_scene(scene).parts, "a design")
    given = {
        "target": target,
        "want": want,
        "within": _metres("--within", within),
        "wires": wires,
        "readings": readings,
        "frequencies": frequencies,
        "own_frequencies": own_frequencies,
        "seconds": seconds,
        "band": None if band is None else parse_band(band, own_band(loaded.setup)),
        "sheet_resistance": _bounds("--sheet-resistance", sheet_resistance),
        "sheet_ratio": sheet_ratio,
        "foam_thickness": _bounds("--foam-thickness", foam_thickness),
        "grading": grading,
        "foils": foils,
        "foil_length": _bounds("--foil-length", foil_length),
        "against_rest": against_rest,
        "casts": casts,
    }
    request = _request(
        loaded.skin,
        loaded.plan,
        {name: value for name, value in given.items() if value is not None},
    )
    bare = replace(loaded, plan=replace(loaded.plan, design=None))
    header = {"asked": request.model_dump(mode="json"), "seed": seed, "draws": draws}
    journal = SearchJournal(_journal_of(output), {"scene": bare.text, **header})
    with on_terminal() as progress:
        settings = SearchSettings(request, seed, draws, journal, progress)
        found = search(bare, settings)
        write_folder(found, settings, output)
    journal.done()
    say(answer(found, settings))
    if request.target != "position":
        skins = f"each of {request.casts} known samples" if request.casts else "a known skin"
        say(bound_text(request.against_rest, skins))
    say(f"design, wiring and report written to {output}")


def _request(skin: Skin, plan: Plan, given: dict[str, object]) -> Design:
    from pydantic import ValidationError

    from ..scene.design_goals import Design
    from ..scene.validation import one_line
    from ..sweeps import InputError

    table = plan.design.model_dump(exclude_unset=True) if plan.design else {}
    try:
        return Design.model_validate({**table, **given})
    except ValidationError as error:
        raise InputError(f"{skin.name}: design: {one_line(error, Design)}") from error


def _bounds(option: str, text: str | None) -> tuple[float, float] | None:
    from ..sweeps import InputError
    from ..sweeps.units import quantity

    if text is None:
        return None
    try:
        low, high = (quantity(part, None) for part in text.split(":"))
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
    from .report.design_folder import WRITTEN

    return checked_folder(output, *WRITTEN).with_name(f".{output.name}.search")
