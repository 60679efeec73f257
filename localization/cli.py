"""Commands of the localizer: study, train, evaluate, localize, adapt, gap, export, reproduce."""

from __future__ import annotations

from .commands.adapt import Adapt
from .commands.evaluate import Evaluate
from .commands.export import Export
from .commands.gap import Gap
from .commands.localize import Localize
from .commands.train import Train
from .paper.command import Reproduce
from .study.command import StudyScene

COMMANDS = (Reproduce, StudyScene, Gap, Train, Adapt, Evaluate, Localize, Export)
