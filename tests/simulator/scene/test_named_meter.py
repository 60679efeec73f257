"""A scene may name its meter, and is told of where it has none."""

import pytest
from rcskin.simulator.scene.meter import Readout, meter_names
from rcskin.simulator.scene.scene_files import builtin_names, load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

OF_THE_PAPER = [name for name in builtin_names() if name.startswith(("sheet", "strip"))]


def scene_with(readout):
    text = scene_text(load_scene("strip-1x3").model_copy(update={"readout": Readout()}))
    head, _, tail = text.partition("[readout]")
    _, _, tail = tail.partition("\n\n")
    return parse_scene(f"{readout}\n{head}{tail}", "mine.toml")


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_the_papers_devices_are_read_by_its_meter(name):
    assert scene_with('readout = "IM3523"').readout == load_scene(name).readout


def test_a_named_meter_is_written_out_in_numbers():
    scene = scene_with('readout = "IM3523"')
    assert not scene.readout.exact
    assert parse_scene(scene_text(scene), "again") == scene


def test_a_scene_without_readout_reads_without_error():
    assert scene_with("").readout.exact
    assert not scene_with("readout = {phase_noise = 1e-3}").readout.exact


def test_another_meter_is_refused_with_those_there_are():
    assert meter_names() == ["3522-50-derived", "E4980A", "IM3523"]
    with pytest.raises(InputError, match="one of 3522-50-derived, E4980A, IM3523, got .IM35."):
        scene_with('readout = "IM35"')
