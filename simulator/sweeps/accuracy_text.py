"""One line that explains an accuracy; every command prints it beside the figure."""

from __future__ import annotations

CHANGES = "changes from the unpressed skin"
NOISE, NOISE_FREE = "with the meter's noise", "free of noise (a meter finds fewer)"
FOUND = {
    "pair": "none to two pixels were all found",
    "touches": "number of touches was found",
}


def bound_text(baseline_count: int, skins: str) -> str:
    """The line that explains a bound.

    baseline_count: number of baseline sweeps, 0 for none. skins: which skins are known.
    """
    features = (
        f"{CHANGES} (mean of {baseline_count} sweeps)"
        if baseline_count
        else "readings without a baseline, with the meter's errors of a session"
    )
    return (
        f"at most means: share of presses that the best localizer of {skins} finds, from "
        f"{features}, with the meter's noise; rcskin study computes what a trained localizer "
        "reaches on other skins"
    )


def accuracy_text(
    target: str, features: str, scored: str, scene: str = "SCENE", *, noisy: bool = True
) -> str:
    """The line that explains an accuracy.

    features: what was evaluated. scored: which sweeps, such as "sweeps outside the training".
    scene: name or path, for the command that computes the bound. noisy: True if a real or
    simulated meter read the sweeps.
    """
    found = FOUND.get(target, f"{target} was found")
    return (
        f"accuracy means: share of the {scored} whose {found}, from {features}, "
        f"{NOISE if noisy else NOISE_FREE}; rcskin limits {scene} computes the bound for a known "
        "skin"
    )
