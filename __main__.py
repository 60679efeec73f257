"""The front door: the `rcskin` command, wiring simulator, localization and hardware together."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .examples import EXAMPLES, OF_THE_METER
from .hardware.cli import app as meter
from .hardware.live.command import live
from .hardware.meter.errors import MeterError
from .localization.cli import add_commands
from .localization.commands.gap import gap_command
from .localization.gap import given as gap
from .simulator.asked.numbers import with_ranges
from .simulator.asked.replacing import with_replacing
from .simulator.cli import app, run, with_examples
from .simulator.progress import on_terminal
from .simulator.shown import terminal

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

__all__ = ["app", "main"]


@app.command()
def reproduce(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for figures, tables and report.html.")
    ] = Path("results"),
    charts: Annotated[str, typer.Option(help="Figures besides: svg or pdf.")] = "png",
) -> None:
    """Reproduce the paper: its figures and confusion matrices, and its numbers beside ours."""
    from sklearn import config_context

    from .localization.evaluation.confusion import write_csv
    from .localization.evaluation.evaluation import UNCHECKED, cross_validate
    from .localization.evaluation.plot import draw_confusion
    from .localization.inputs.features import PAPER
    from .localization.model.file import save
    from .localization.model.training import train
    from .localization.paper.localizer import Localizer
    from .localization.paper.reproduce import reproduce as reproduce_paper
    from .simulator.charts import checked_ending

    ending = checked_ending(charts)
    localizer = Localizer(
        cross_validate=partial(cross_validate, quantities=PAPER),
        draw=draw_confusion,
        write=write_csv,
        save=lambda sweeps, path: save(path, train(sweeps, quantities=PAPER)),
    )
    with on_terminal() as progress, config_context(**UNCHECKED):
        claims = reproduce_paper(output, localizer, progress, ending)
    agreeing = sum(claim.agrees for claim in claims)
    terminal().print(
        f"{agreeing} of the paper's {len(claims)} statements agree; see {output / 'report.html'}",
        soft_wrap=True,
    )


add_commands(app)
app.command()(live)
app.add_typer(meter, name="meter")


def _gap_scene(name: str) -> str:
    from .simulator.asked.scene import asked_scene
    from .simulator.scene.files import scene_text

    return scene_text(asked_scene(name))


def _reading_error(text: str) -> gap.ReadingError | None:
    from .simulator.measure.simulate import reading_error

    found = reading_error(text)
    return gap.ReadingError(*found) if found else None


def _resimulated(sweeps: xr.Dataset, text: str, frequency: NDArray) -> xr.Dataset:
    from .simulator.measure.simulate import resimulated

    return resimulated(sweeps, text, frequency)


def _read_by_meter(sweeps: xr.Dataset, text: str, seed: int) -> xr.Dataset:
    from .simulator.measure.simulate import read_by_meter

    return read_by_meter(sweeps, text, seed)


def _recalibrated(simulated: xr.Dataset, measured: xr.Dataset) -> gap.Recalibrated:
    from .simulator.calibration.run import calibrate
    from .simulator.scene.files import parse_scene, scene_text

    found = calibrate(parse_scene(simulated.attrs["scene"], "scene"), measured)
    frequency = simulated["frequency"].values
    again = _resimulated(simulated, scene_text(found.scene), frequency)
    estimates = [
        gap.Estimate(each.name, each.unit, each.start, each.value, each.low, each.high)
        for each in found.quantities
    ]
    return gap.Recalibrated(again, estimates)


def _explained(text: str, measured: xr.Dataset) -> list[gap.Cause]:
    from .simulator.calibration.explained import gap_by_parameter
    from .simulator.scene.files import parse_scene

    found = gap_by_parameter(parse_scene(text, "scene"), measured)
    return [gap.Cause(each.name, max(0.0, each.removed)) for each in found]


def _style() -> gap.Style:
    from .simulator.charts import COLOURS, chart, checked_ending, frequency_axis

    return gap.Style(chart, frequency_axis, COLOURS, checked_ending)


_simulation = gap.Simulation(
    _gap_scene, _reading_error, _resimulated, _read_by_meter, _recalibrated, _explained
)
app.command("gap")(gap_command(_simulation, _style, on_terminal))


with_replacing(app)
with_replacing(meter, "meter")
with_examples(app, EXAMPLES)
with_examples(meter, OF_THE_METER)
with_ranges(app)
with_ranges(meter)


def main() -> None:
    """Run the command line."""
    run((MeterError,))


if __name__ == "__main__":
    main()
