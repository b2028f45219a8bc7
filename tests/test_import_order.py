"""Imports point downward only, and nothing heavy loads with the package."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

SRC = Path(__file__).resolve().parents[1] / "src" / "toponav"

BASE = {"errors", "config_model", "registry", "categories", "cores", "files", "geometry", "types"}
SCENES = BASE | {"scenes"}
MAPPING = BASE | {"mapping"}
PERCEPTION = BASE | {"perception"}
MEMORY = MAPPING | PERCEPTION | {"memory"}
REASONING = MEMORY | {"reasoning"}
POLICY = REASONING | {"policy"}
CONTROL = POLICY | {"control"}
AGENTS = CONTROL | {"config", "knowledge", "navigator", "baselines", "methods"}
DATASETS = BASE | {"datasets"}
EVALUATION = AGENTS | {"envs", "scenes", "datasets", "evaluation"}
ALLOWED = {
    "errors": set(),
    "config_model": set(),
    "registry": {"errors"},
    "categories": set(),
    "cores": set(),
    "files": set(),
    "geometry": {"errors", "geometry"},
    "types": {"errors", "geometry", "categories"},
    "mapping": MAPPING,
    "perception": PERCEPTION,
    "memory": MEMORY,
    "reasoning": REASONING,
    "policy": POLICY,
    "control": CONTROL,
    "config": CONTROL | {"config"},
    "knowledge": MEMORY | {"files", "knowledge"},
    "navigator": CONTROL | {"config", "knowledge", "navigator"},
    "baselines": AGENTS - {"navigator", "methods"},
    "methods": AGENTS,
    "scenes": SCENES,
    "envs": SCENES | {"envs"},
    "datasets": DATASETS,
    "evaluation": EVALUATION,
    "habitat": EVALUATION | {"habitat"},
    "robot": EVALUATION | {"robot"},
    "viz": EVALUATION | {"viz"},
    "cli": EVALUATION | {"habitat", "robot", "viz", "cli"},
}
"""What each part of the package may import; a part that is missing here fails the test."""


def imported_parts(path: Path) -> set[str]:
    parts = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module is not None
            names = [node.module]
            if node.module == "toponav":
                names = [f"toponav.{alias.name}" for alias in node.names]
        parts |= {name.split(".")[1] for name in names if name.startswith("toponav.")}
    return parts


MODULES = sorted(path for path in SRC.rglob("*.py") if path != SRC / "__init__.py")


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(SRC)))
def test_imports_point_downward(path: Path) -> None:
    part = path.relative_to(SRC).parts[0].removesuffix(".py")
    forbidden = imported_parts(path) - ALLOWED[part]
    assert not forbidden, f"{part} must not import {sorted(forbidden)}"


def test_only_evaluation_and_the_oracle_detector_see_ground_truth() -> None:
    allowed = {"evaluation", "envs", "types.py", "habitat"}
    readers = {
        path.relative_to(SRC)
        for path in MODULES
        if "semantic_frame" in path.read_text(encoding="utf-8")
    }
    outside = {path for path in readers if path.parts[0] not in allowed}
    noise_models = {Path("perception/noisy.py"), Path("perception/sightings.py")}
    simulated_camera = Path(
        "robot/sim_robot.py"
    )  # publishes true labels, as a detector's node would
    assert outside == {Path("perception/oracle.py"), *noise_models, simulated_camera}


def test_importing_the_package_loads_no_heavy_library() -> None:
    heavy = "numba trimesh embreex matplotlib scipy gymnasium torch ray networkx shapely openai"
    code = f"import sys, toponav; print([m for m in '{heavy}'.split() if m in sys.modules])"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"
