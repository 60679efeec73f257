"""Designs whose readings have their own frequencies."""

import json

import numpy as np
from rcskin.simulator.bounds.choice import exchanged_by_slope, selection_bound
from rcskin.simulator.scene.scene_files import load_scene


def test_exchanges_approach_the_best_choice(seed=3):
    random = np.random.default_rng(seed)
    worth = random.random((40, 12))

    def slope(weights):
        seen = 1 + worth.T @ weights
        return float(np.log(seen).sum()), worth @ (1 / seen)

    begun = np.argsort(worth.sum(axis=1))[:8]
    found = exchanged_by_slope(slope, begun, 40)

    def value(choice):
        return slope(np.isin(np.arange(40), choice).astype(float))[0]

    most = selection_bound(slope, found, 40)
    assert len(set(found.tolist())) == 8
    assert value(begun) < value(found) <= most
    assert most - value(found) < 0.1 * (most - value(begun))


def test_a_design_with_own_frequencies_is_a_scene_with_them(run, strip_file, tmp_path):
    options = ("--own-frequencies", "--casts", 1, "--draws", 200, "--readings", 3)
    code, out, err = run("design", strip_file, *options, "-o", tmp_path / "found")
    assert (code, err) == (0, ""), out
    steps = json.loads((tmp_path / "found" / "design.json").read_text())["steps"]
    assert steps[-1]["step"] == "frequencies of each reading"
    designed = load_scene(str(tmp_path / "found" / "design.toml"))
    asked = {each.name: each.frequencies for each in designed.interfaces}
    told = steps[-1].get("frequencies_of_each_Hz")
    if steps[-1]["taken"]:
        assert told == {name: list(own) for name, own in asked.items()}
        assert steps[-1]["nine_of_ten_samples"] >= steps[-2]["nine_of_ten_samples"]
    counts = [len(own) for own in told.values()]
    assert sum(counts) <= 3 * 2
