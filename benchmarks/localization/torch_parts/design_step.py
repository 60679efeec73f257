"""Sheet resistance and frequencies moved along the gradient of a localizer's loss."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import rcskin
import torch
from rcskin.simulator.models.reduced.forward import REACH
from rcskin.simulator.scene.scene import Scene
from torch import Tensor

STRENGTHS = (1.3, 1.6, 1.9, 2.2, 2.6, 3.0)
"""Factors of c by which each pixel is pressed."""
DRAWS, STEP = 4, 0.05
LOW, HIGH = 1e3, 200e3
"""Range of the meter, Hz."""


@dataclass(frozen=True)
class Design:
    """A skin: resistance of both sheets in ohm/sq, frequencies in Hz, ascending."""

    resistance: float
    frequencies: tuple[float, ...]

    def on(self, scene: Scene) -> Scene:
        """Scene of the design."""
        return scene.with_(
            {
                "skin.top.sheet_resistance": self.resistance,
                "skin.bottom.sheet_resistance": self.resistance,
                "sweep.frequencies": [float(f"{f:.5g}") for f in self.frequencies],
            }
        )


class PixelLoss:
    """Cross-entropy of the posterior over pixels of a known skin, given the meter's noise.

    Each sweep is a pixel at one strength with noise; the posterior sums normal densities over all
    strengths of each pixel. The draws of the noise stay the same, so that the loss is smooth.
    """

    def __init__(self, scene: Scene, rtol: float) -> None:
        wide = scene.with_({"sweep.frequencies": [LOW, HIGH]})
        self.skin = rcskin.SkinModule(wide, rtol=rtol)
        pixels, readout = self.skin.parts.foam, scene.readout
        rises = torch.eye(pixels, dtype=torch.float64).repeat_interleave(len(STRENGTHS), 0)
        factors = torch.tensor(STRENGTHS, dtype=torch.float64).repeat(pixels)
        self.rises = torch.cat([torch.zeros(1, pixels), rises * (factors - 1)[:, None]])
        self.pixels, self.deviation = pixels, (readout.magnitude_noise, readout.phase_noise)
        self.random = np.random.default_rng(0)
        self.noise: Tensor | None = None

    def __call__(self, resistance: Tensor, frequency: Tensor) -> Tensor:
        """Loss in nats. resistance: logarithm of the factor on both sheets. frequency: Hz."""
        Z = self.skin(self.rises, {"sheet_resistance": resistance}, frequency)
        change = torch.log(Z[1:] / Z[:1]).flatten(1)
        features = torch.cat([change.real / self.deviation[0], change.imag / self.deviation[1]], 1)
        if self.noise is None:
            drawn = self.random.standard_normal((DRAWS, *features.shape))
            self.noise = torch.as_tensor(drawn)
        read = (features + self.noise).flatten(0, 1)
        near = -torch.cdist(read, features).square() / 2
        by_pixel = near.unflatten(1, (self.pixels, len(STRENGTHS))).logsumexp(dim=2)
        truth = torch.arange(self.pixels).repeat_interleave(len(STRENGTHS)).repeat(DRAWS)
        return torch.nn.functional.cross_entropy(by_pixel, truth)


def designed(scene: Scene, start: Design, steps: int, rtol: float) -> tuple[Design, list[float]]:
    """Design after gradient steps by Adam, and the loss of each step.

    Frequencies stay in the range of the meter, the resistance within a factor of REACH.
    """
    loss, span = PixelLoss(start.on(scene), rtol), math.log(HIGH / LOW)
    shares = torch.log(torch.tensor(start.frequencies, dtype=torch.float64) / LOW) / span
    places = torch.logit(shares.clamp(0.02, 0.98)).requires_grad_()
    turned = torch.zeros((), dtype=torch.float64, requires_grad=True)
    optimizer, losses = torch.optim.Adam([places, turned], STEP), []
    for _ in range(steps):
        optimizer.zero_grad()
        value = loss(math.log(REACH) * torch.tanh(turned), LOW * torch.exp(span * places.sigmoid()))
        value.backward()
        optimizer.step()
        losses.append(float(value.detach()))
    factor = math.exp(math.log(REACH) * math.tanh(turned.item()))
    frequencies = LOW * torch.exp(span * places.detach().sigmoid())
    return Design(start.resistance * factor, tuple(sorted(frequencies.tolist()))), losses


def accuracy(scene: Scene, design: Design, sweeps: int, rtol: float) -> float:
    """Share of pixels that `gaussian` finds on skins that it did not learn from."""
    own = design.on(scene)
    known = rcskin.dataset(own, sweeps, seed=1, rtol=rtol)
    unseen = rcskin.dataset(own, sweeps // 2, seed=2, rtol=rtol)
    model = rcskin.train(known, "pixel", "gaussian", quantities="dlnZ,dphase")
    return float(rcskin.evaluate(model, unseen).accuracy)
