"""The agent of a robot, put together from names."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from toponav.errors import InputError
from toponav.navigator import Navigator
from toponav.perception import DetectorContext, PerceptionConfig, make_detector
from toponav.perception.base import Detector
from toponav.reasoning import ReasonerContext, ReasoningConfig, reasoners
from toponav.reasoning.vlm.access import ModelAccess
from toponav.robot.config import RobotConfig, navigator_config
from toponav.robot.labels import LabelImageDetector
from toponav.robot.memory_file import load_memory
from toponav.robot.ros2_node import Task

LABEL_TOPIC = "labels"
"""Name of the detector that takes label images from a topic."""

NEEDS_GROUND_TRUTH = ("oracle", "noisy")
"""Detectors and reasoners that read a simulator's labels, which no robot has."""


@dataclass(frozen=True)
class AgentParts:
    """What an agent is made of.

    Attributes:
        detector: `labels`, or a detector's name and argument, such as onnx:MODEL.onnx.
        reasoner: prior or openai.
        model: Of the reasoner openai.
        base_url: Its server.
        memory: File of what is known of the building.
    """

    detector: str = LABEL_TOPIC
    reasoner: str = "prior"
    model: str | None = None
    base_url: str | None = None
    memory: Path | None = None


def robot_task(parts: AgentParts, robot: RobotConfig) -> Task:
    """An agent for a robot, with what its memory file holds.

    Raises:
        InputError: An unknown or impossible part, a damaged file.
    """
    for name in (parts.detector, parts.reasoner):
        if name in NEEDS_GROUND_TRUTH:
            raise InputError(f"{name} reads a simulator's true labels: a robot has none")
    labels = LabelImageDetector() if parts.detector == LABEL_TOPIC else None
    detector: Detector = labels or make_detector(
        parts.detector, DetectorContext(PerceptionConfig())
    )
    config = navigator_config(robot)
    if parts.reasoner != "prior":
        # The robot drives on by common sense while the model thinks.
        background = config.counsel.model_copy(update={"mode": "background"})
        config = config.model_copy(update={"counsel": background})
    reasoning = _reasoning(parts)
    reasoner = reasoners.get(parts.reasoner)(ReasonerContext(reasoning, access=ModelAccess()))
    agent = Navigator(detector, reasoner, config)
    remembered = None if parts.memory is None else load_memory(parts.memory, config.map)
    if remembered is None:
        return Task(agent, labels, robot)
    agent.recall(remembered.knowledge)
    points = len(remembered.knowledge.semantic_map.view().scene)
    return Task(agent, labels, robot, remembered.slam_from_world, points)


def _reasoning(parts: AgentParts) -> ReasoningConfig:
    config = ReasoningConfig()
    named = {"model": parts.model, "base_url": parts.base_url}
    changes = {key: value for key, value in named.items() if value is not None}
    openai = config.openai.model_copy(update=changes)
    return config.model_copy(update={"openai": openai})
