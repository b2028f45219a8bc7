"""Studies: what the variants change, and that an interrupted study goes on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from small_house import small_config
from toponav.errors import InputError
from toponav.evaluation.evaluate import RunProgress
from toponav.evaluation.run_folder import RunRequest
from toponav.evaluation.studies import BASE, STUDIES, Study, Variant, run_study, study
from toponav.evaluation.tables.runs import load_runs
from toponav.methods import methods


@dataclass
class Log:
    """Which variants ran, and how many episodes of each."""

    runs: dict[str, int] = field(default_factory=dict)

    @contextmanager
    def display(self, variant: Variant) -> Iterator[Log]:
        self._name = variant.name
        self.runs[variant.name] = 0
        yield self

    def on_progress(self, progress: RunProgress) -> None:
        self.runs[self._name] += progress.outcome is not None


@pytest.mark.parametrize("name", [*STUDIES, "methods"])
def test_every_variant_is_a_valid_configuration_of_its_own(name: str) -> None:
    preset = "default" if name == "default-parts" else "paper"  # whose parts it takes away
    chosen, config = study(name), small_config(preset=preset)
    configs = [variant.applied_to(config) for variant in chosen.variants]
    assert configs[0] == config
    assert len({one.model_dump_json() for one in configs}) == len(configs) > 1
    assert len({variant.name for variant in chosen.variants}) == len(configs)


def test_the_papers_tables() -> None:
    config = small_config()
    detection = [v.applied_to(config) for v in study("goal-detection").variants]
    recognition = [one.navigator.goal.recognition for one in detection]
    assert recognition == ["both", "reasoner", "detector"]
    information = [
        v.applied_to(config).navigator.memory for v in study("node-information").variants
    ]
    shown = [(one.include_frontiers, one.include_rooms, one.include_objects) for one in information]
    assert shown == [(True,) * 3, (False, True, True), (True, False, True), (True, True, False)]


def test_every_method_is_compared() -> None:
    assert {variant.method for variant in study("methods").variants} == set(methods.names())
    assert study("methods").variants[0].method == BASE


def test_what_is_done_is_not_run_again(tmp_path: Path) -> None:
    config = small_config("random", max_steps=3)
    first = Variant("first", method="random")
    request = RunRequest(source="generated:6", record=False)
    before, after = Log(), Log()
    run_study(Study("", (first,)), request, config, tmp_path, before.display)
    longer = Variant("longer", {"env.max_steps": "5"}, method="random")
    folders = run_study(Study("", (first, longer)), request, config, tmp_path, after.display)
    assert before.runs == {"first": 2}
    assert after.runs == {"first": 0, "longer": 2}
    steps = [[episode.steps for episode in run.episodes] for run in load_runs(folders)]
    assert steps == [[3, 3], [5, 5]]


def test_an_unknown_study_lists_those_known() -> None:
    with pytest.raises(InputError, match=r"unknown study 'magic'; known: .*methods"):
        study("magic")
