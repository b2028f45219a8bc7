"""Every navigation method by name: `toponav`, the baselines, and what a user registers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from toponav.baselines.cow import CowAgent
from toponav.baselines.esc import EscAgent
from toponav.baselines.frontier import FrontierAgent
from toponav.baselines.instructnav import InstructNavAgent
from toponav.baselines.l3mvn import L3mvnAgent
from toponav.baselines.random_walk import RandomAgent
from toponav.baselines.sg_nav import SgNavAgent
from toponav.baselines.tour import TourAgent
from toponav.baselines.trihelper import TriHelperAgent
from toponav.baselines.vlfm import VlfmAgent
from toponav.baselines.voronav import VoroNavAgent
from toponav.baselines.wmnav import WmNavAgent
from toponav.config import NavigatorConfig
from toponav.navigator import Navigator
from toponav.perception.base import Detector
from toponav.policy.decision import DecisionListener, Listeners
from toponav.reasoning.base import Reasoner
from toponav.registry import Registry
from toponav.types import Agent


@dataclass(frozen=True, eq=False)
class AgentContext:
    """What a method is built from; a method takes what it needs.

    Attributes:
        detector: Perception.
        reasoner: Plays the VLM.
        config: Shared by all methods, so that they differ in what they explore and not in their
            map, planner or stop rule.
        seed: Seeds whatever the method draws at random.
        listener: Watches the decisions.
    """

    detector: Detector
    reasoner: Reasoner
    config: NavigatorConfig
    seed: int = 0
    listener: DecisionListener = field(default_factory=Listeners)


AgentFactory = Callable[[AgentContext], Agent]
methods: Registry[AgentFactory] = Registry("method")


@methods.register("toponav")
def _toponav(context: AgentContext) -> Agent:
    return Navigator(context.detector, context.reasoner, context.config, context.listener)


@methods.register("frontier")
def _frontier(context: AgentContext) -> Agent:
    return FrontierAgent(context.detector, context.config, context.listener)


@methods.register("random")
def _random(context: AgentContext) -> Agent:
    return RandomAgent(context.detector, context.config, context.seed, context.listener)


@methods.register("tour")
def _tour(context: AgentContext) -> Agent:
    return TourAgent(context.detector, context.config, context.listener)


@methods.register("cow")
def _cow(context: AgentContext) -> Agent:
    return CowAgent(context.detector, context.config, context.listener)


@methods.register("esc")
def _esc(context: AgentContext) -> Agent:
    return EscAgent(context.detector, context.reasoner, context.config, context.listener)


@methods.register("l3mvn")
def _l3mvn(context: AgentContext) -> Agent:
    return L3mvnAgent(context.detector, context.reasoner, context.config, context.listener)


@methods.register("sg_nav")
def _sg_nav(context: AgentContext) -> Agent:
    return SgNavAgent(context.detector, context.reasoner, context.config, context.listener)


@methods.register("instructnav")
def _instructnav(context: AgentContext) -> Agent:
    return InstructNavAgent(context.detector, context.reasoner, context.config, context.listener)


@methods.register("trihelper")
def _trihelper(context: AgentContext) -> Agent:
    return TriHelperAgent(
        context.detector, context.reasoner, context.config, context.seed, context.listener
    )


@methods.register("vlfm")
def _vlfm(context: AgentContext) -> Agent:
    return VlfmAgent(context.detector, context.reasoner, context.config, context.listener)


@methods.register("voronav")
def _voronav(context: AgentContext) -> Agent:
    return VoroNavAgent(context.detector, context.reasoner, context.config, context.listener)


@methods.register("wmnav")
def _wmnav(context: AgentContext) -> Agent:
    return WmNavAgent(context.detector, context.reasoner, context.config, context.listener)
