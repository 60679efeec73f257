"""The command `rcskin design`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..requests.number_ranges import BASELINES, DRAWS, MILLIMETRES, any_finite
from ..requests.options import SCENE, SEED_OF_ALL
from ..requests.request import Writing, argument, typed
from ..safe_text import say

if TYPE_CHECKING:
    from ..scene.design_goals import Design
    from ..scene.parts import Plan, Skin

FOLDER = Path("design")


class DesignSkin(
    Writing, command="design", example="design sheet-5x5-two-interfaces --want 0.9 -o designed"
):
    """Find the best skin and readings within given constraints.

    Options override the table [design] of the scene. FOLDER/design.toml is
    the designed scene, which every command accepts. wiring.csv lists the
    wires at H and at L for each reading. report.html has the gain of each
    step, the sensitivity of the optimum and the properties to make.

    Run the same command again to continue an interrupted search.
    """

    scene: str = argument(SCENE)
    output: Path = typed(
        "Folder for design.toml, tables and report.", "--output", "-o", default=FOLDER
    )
    target: str | None = typed(
        "What the readings must identify: pixel, column, row, pair or position.",
        complete=lambda: ["pixel", "column", "row", "pair", "position"],
        default=None,
    )
    want: float | None = typed("Required share of correct sweeps, 0 to 1.", default=None)
    within: float | None = typed(
        "Required median error of positions, mm.", within=MILLIMETRES, default=None
    )
    wires: int | None = typed("Largest number of foils with a wire.", default=None)
    readings: int | None = typed("Largest number of readings in a sweep.", default=None)
    frequencies: int | None = typed("Largest number of frequencies of a reading.", default=None)
    own_frequencies: bool | None = typed(
        "Each reading may have its own frequencies, the same number in total.", default=None
    )
    seconds: float | None = typed(
        "Longest time of a sweep on the meter.", within=any_finite("s"), default=None
    )
    band: str | None = typed(
        "LOW:HIGH in Hz; default: the scene's lowest and highest frequency.", default=None
    )
    sheet_resistance: str | None = typed("LOW:HIGH in ohm/sq, for both sheets.", default=None)
    sheet_ratio: float | None = typed(
        "Largest ratio of one sheet's resistance to the other's.", default=None
    )
    foam_thickness: str | None = typed(
        "LOW:HIGH in m, if the scene states the foam's thickness.", default=None
    )
    grading: float | None = typed(
        "Largest ratio of a sheet's resistance at opposite edges, 1 to 10.", default=None
    )
    foils: bool | None = typed("Positions and lengths of foils may change.", default=None)
    foil_length: str | None = typed(
        "LOW:HIGH, a foil's length over that of its edge.", default=None
    )
    against_rest: int | None = typed(
        "Number of baseline sweeps that each sweep is compared with.",
        within=BASELINES,
        default=None,
    )
    casts: int | None = typed("Number of skin samples, drawn from `dataset.session`.", default=None)
    draws: int = typed("Number of sweeps drawn for each bound.", within=DRAWS, default=2000)
    seed: int = typed(SEED_OF_ALL, default=1)

    def run(self) -> None:
        from ..bounds.frequency_sets import own_band
        from ..models.mechanics.force_depths import pressed_by_factors
        from ..progress import on_terminal
        from ..requests.requested_scene import requested_scene
        from ..scene.frequency import parse_band
        from ..scene.supports import supported
        from ..sweeps.units import bound_text
        from .design_report import report_of
        from .evaluator import SearchJournal, SearchSettings
        from .search import search

        loaded = pressed_by_factors(supported("a design", requested_scene(self.scene).parts))
        given = {
            "target": self.target,
            "want": self.want,
            "within": _metres("--within", self.within),
            "wires": self.wires,
            "readings": self.readings,
            "frequencies": self.frequencies,
            "own_frequencies": self.own_frequencies,
            "seconds": self.seconds,
            "band": None if self.band is None else parse_band(self.band, own_band(loaded.setup)),
            "sheet_resistance": _bounds("--sheet-resistance", self.sheet_resistance),
            "sheet_ratio": self.sheet_ratio,
            "foam_thickness": _bounds("--foam-thickness", self.foam_thickness),
            "grading": self.grading,
            "foils": self.foils,
            "foil_length": _bounds("--foil-length", self.foil_length),
            "against_rest": self.against_rest,
            "casts": self.casts,
        }
        request = _request(
            loaded.skin,
            loaded.plan,
            {name: value for name, value in given.items() if value is not None},
        )
        bare = replace(loaded, plan=replace(loaded.plan, design=None))
        header = {"asked": request.model_dump(mode="json"), "seed": self.seed, "draws": self.draws}
        journal = SearchJournal(_journal_of(self.output), {"scene": bare.text, **header})
        with on_terminal() as progress:
            settings = SearchSettings(request, self.seed, self.draws, journal, progress)
            found = search(bare, settings)
            report = report_of(found, settings)
            report.write(self.output, json="design.json", page="report.html")
        journal.done()
        say(report.verdict)
        if request.target != "position":
            skins = f"each of {request.casts} known samples" if request.casts else "a known skin"
            say(bound_text(request.against_rest, skins))
        say(f"design, wiring and report written to {self.output}")


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
    from .design_report import WRITTEN

    return checked_folder(output, *WRITTEN).with_name(f".{output.name}.search")
