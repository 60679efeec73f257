"""One case answered and held against its reference."""

from __future__ import annotations

import time
import traceback
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_parts.kinds import KINDS
from rcskin.benchmarks.accuracy.campaign_parts.problem import Case, Truth
from rcskin.benchmarks.accuracy.campaign_parts.verdict import Values, Verdict
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.solution import Solution
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.sweeps import InputError, ToleranceError

DOUBT = 0.25
"""Of the tolerance: a reference that is less sure is none."""
IN_TURN, FIRST_IN_TURN = (1e-3, 1e-4, 1e-5), 100
"""Tolerances that scenes are asked for in turn, from that seed on."""


def drawn(kind: str, seed: int) -> Case:
    """The case that a kind and a seed are, always the same."""
    case = KINDS[kind](np.random.default_rng([*kind.encode(), seed]))
    if seed < FIRST_IN_TURN:
        return case
    return replace(case, rtol=IN_TURN[(seed - FIRST_IN_TURN) % len(IN_TURN)])


def judged(kind: str, seed: int) -> Verdict:
    """Answer a case and its reference, and compare them. Raises nothing."""
    rtol = 0.0
    try:
        case = drawn(kind, seed)
        rtol = case.rtol
        return _compared(kind, seed, case)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        reason = f"{type(error).__name__} in {where.name}: {' '.join(str(error).split())}"
        return Verdict(kind, seed, rtol, "failed", reason)


def _compared(kind: str, seed: int, case: Case) -> Verdict:
    start = time.process_time()
    try:
        answer = Solver(case.problem.scene.parts, case.rtol).solve(case.problem.press)
    except (ToleranceError, InputError) as error:
        return Verdict(kind, seed, case.rtol, "refused", str(error))
    answered = time.process_time() - start
    try:
        truth = case.route(case.rtol)
    except (ToleranceError, InputError) as error:
        return Verdict(kind, seed, case.rtol, "not judged", f"no reference: {error}")
    seconds = round(answered, 2), round(time.process_time() - start - answered, 2)
    return _held(kind, seed, case.rtol, answer, truth, seconds)


def _held(
    kind: str, seed: int, rtol: float, answer: Solution, truth: Truth, seconds: tuple[float, float]
) -> Verdict:
    true = relative_difference(answer.Z, truth.Z)
    estimated = np.stack(answer.relative_errors)
    sure = truth.doubt.max() <= DOUBT * rtol
    return Verdict(
        kind,
        seed,
        rtol,
        "judged" if sure else "not judged",
        "" if sure else f"the reference is off by up to {truth.doubt.max():.1e}",
        answer.model,
        tuple(answer.frequency.tolist()),
        _rounded(true),
        _rounded(estimated),
        _rounded(truth.doubt),
        seconds,
    )


def _rounded(values: NDArray[np.float64]) -> Values:
    return [[[float(f"{x:.3g}") for x in line] for line in part] for part in values]
