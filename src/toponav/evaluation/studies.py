"""Studies: several runs on the same episodes that differ in one thing, as the paper's tables do."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from toponav.config import with_overrides
from toponav.errors import InputError
from toponav.evaluation.evaluate import RunProgress, evaluate
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import RunRequest
from toponav.evaluation.tables.groups import GroupKind
from toponav.methods import methods

BASE = "toponav"
"""Name of the run that is not changed; studies in one folder share it."""


class Watcher(Protocol):
    """Follows a run."""

    def on_progress(self, progress: RunProgress) -> None:
        """Told at the start and after every episode."""
        ...


@dataclass(frozen=True)
class Variant:
    """One run of a study.

    Attributes:
        name: Names its folder and its row.
        overrides: Dotted key to JSON value, as `--set` takes them.
        method: Another method than TopoNav.
    """

    name: str
    overrides: Mapping[str, str] = field(default_factory=dict)
    method: str = BASE

    def applied_to(self, config: RunConfig) -> RunConfig:
        """The run's configuration, changed."""
        changed = config.model_copy(update={"method": self.method})
        return with_overrides(changed, self.overrides)


@dataclass(frozen=True)
class Study:
    """What is compared.

    Attributes:
        title: One line for people; names the paper's table.
        variants: The runs; the others are compared with the first.
        by: What the table groups by; None for the whole runs.
    """

    title: str
    variants: tuple[Variant, ...]
    by: GroupKind | None = None


def _set(name: str, **overrides: str) -> Variant:
    """A variant of the navigator's configuration; a double underscore stands for the dot."""
    keys = {f"navigator.{key.replace('__', '.')}": value for key, value in overrides.items()}
    return Variant(name, keys)


FULL = Variant(BASE)

STUDIES: dict[str, Study] = {
    "goal-detection": Study(
        "Who recognises the target (the paper's Table II)",
        (
            FULL,
            _set("reasoner-only", goal__recognition='"reasoner"'),
            _set("detector-only", goal__recognition='"detector"'),
        ),
    ),
    "node-information": Study(
        "What the nodes tell the reasoner (the paper's Table III)",
        (
            FULL,
            _set("without-frontiers", memory__include_frontiers="false"),
            _set("without-rooms", memory__include_rooms="false"),
            _set("without-objects", memory__include_objects="false"),
        ),
    ),
    "categories": Study(
        "TopoNav and InstructNav by category (the paper's Fig. 5)",
        (FULL, Variant("instructnav", method="instructnav")),
        by="category",
    ),
    "affordances": Study(
        "Each term of the affordance sum (Section III-E)",
        (
            FULL,
            _set("without-dir", affordances__weight_dir="0"),
            _set("without-node", affordances__weight_node="0"),
            _set("without-front", affordances__weight_front="0"),
            _set("without-hist", affordances__weight_hist="0"),
            _set("without-sem", affordances__weight_sem="0"),
        ),
    ),
    "panorama": Study(
        "Views of a panorama",
        (
            FULL,
            _set("6-views-of-the-circle", panorama__views="6", panorama__spacing_deg="60"),
            _set("4-views-of-the-circle", panorama__views="4", panorama__spacing_deg="90"),
            _set("6-views-of-half-the-circle", panorama__views="6"),
        ),
    ),
    "revisit": Study(
        "A goal in a building that searches for one, two and four others have made known",
        (FULL, *(Variant(f"after-{k}", {"revisit": str(k)}) for k in (1, 2, 4))),
    ),
    "default-parts": Study(
        "The preset default without each of its parts (give --preset default)",
        (
            FULL,
            _set("without-evidence", goal__evidence="null"),
            _set("without-glimpses", goal__glimpses="null"),
            _set("without-stairwells", map__stairwells="false"),
            _set("without-stairs-by-shape", map__stairs_by_shape="false"),
            _set("without-sight", decide_on_sight="false"),
            _set("without-plan", search="null"),
            _set("without-affinity", search='{"semantic_exponent": 0}'),
            _set("without-node", search='{"guided_node": 1}'),
            _set(
                "without-shapes",
                goal__evidence__implausible="0",
                goal__evidence__implausible_most="100",
            ),
            _set("without-impossible-names", goal__evidence__impossible_names="false"),
            _set("without-second-thoughts", goal__evidence__better="null"),
            _set("without-gaps", locomotion__recovery__maneuver_m="0"),
            _set("without-landings", locomotion__planner__landing_m="0"),
            _set("without-clearing", map__clearing="null"),
        ),
    ),
    "merge-distance": Study(
        "Distance within which nodes are merged (Section III-D)",
        (
            FULL,
            _set("d-merge-0", memory__d_merge="0"),
            _set("d-merge-2", memory__d_merge="2"),
            _set("d-merge-4", memory__d_merge="4"),
        ),
    ),
}


def study(name: str) -> Study:
    """The study of a name; `methods` compares TopoNav with every other method.

    Raises:
        InputError: No such study; the message lists those known.
    """
    if name == "methods":
        others = [method for method in methods.names() if method != BASE]
        variants = (FULL, *(Variant(method, method=method) for method in others))
        return Study("Every method on the same map, perception, planner and episodes", variants)
    if name not in STUDIES:
        known = ", ".join((*STUDIES, "methods"))
        raise InputError(f"unknown study {name!r}; known: {known}")
    return STUDIES[name]


def run_study(
    chosen: Study,
    request: RunRequest,
    config: RunConfig,
    folder: Path,
    display: Callable[[Variant], AbstractContextManager[Watcher]],
) -> list[Path]:
    """Run every variant that is not done yet, each into a folder of its own.

    Args:
        chosen: What to compare.
        request: On which episodes.
        config: What the variants change.
        folder: Gets a folder a variant; what an earlier, interrupted study did is kept.
        display: Makes what follows a variant while it runs.

    Returns:
        The variants' folders, in order.

    Raises:
        InputError: As `evaluate`.
    """
    folders = [folder / variant.name for variant in chosen.variants]
    configs = [variant.applied_to(config) for variant in chosen.variants]
    for variant, own, where in zip(chosen.variants, configs, folders, strict=True):
        with display(variant) as shown:
            evaluate(request, own, where, resume=True, on_progress=shown.on_progress)
    return folders
