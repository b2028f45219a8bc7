"""A search on a continuous robot: the agent thinks in a thread of its own, the pilot drives.

The agent is any of the package's, unchanged: it takes one observation and answers one action. A
turn to look becomes a turn in place, after which it is shown an image taken at rest. An action that
is part of a walk becomes the whole way, which the robot follows without stopping; a step's length
farther on the agent is shown the next image, and may lead it elsewhere.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from toponav.geometry import Pose
from toponav.knowledge import RecallingAgent
from toponav.robot.frame_sync import Instant
from toponav.robot.intent import Follow, Intent, Turn
from toponav.robot.pilot import Outcome
from toponav.robot.senses import Senses
from toponav.types import Action, Agent

STEP_M = 0.25
"""The agent's step: walking, it is shown an image as often as in the protocol."""

NEAR_BUMP_M = 0.3
"""Nearer than this to where it ran into something, the robot goes step by step, metres."""

ROUND_S = 0.02
"""Longest wait between two looks for something to do, seconds."""


class Status(Enum):
    """Where a search stands."""

    IDLE = "idle"
    SEARCHING = "searching"
    DONE = "done"
    CANCELLED = "cancelled"
    FAILED = "failed"


@runtime_checkable
class WalkingAgent(Agent, Protocol):
    """An agent that says where its steps lead."""

    @property
    def way(self) -> NDArray[np.float64] | None:
        """(K, 2) the way that the last action is a part of; None where it was a turn to look."""
        ...


class Driver(Protocol):
    """Carries out intents: `Pilot` or `GoalPilot`."""

    outcome: Outcome

    def begin(self, intent: Intent, pose: Pose, *, go_on: bool = False) -> None:
        """Carry out an intent from now on, from where the robot is."""
        ...

    def stop(self) -> None:
        """Stand still from now on."""
        ...


@dataclass(frozen=True)
class SearchTiming:
    """When the agent is shown an image.

    Attributes:
        turn_rad: The agent's turn.
        settle_s: Images taken sooner after the robot came to rest may be blurred.
        max_age_s: On the way, it looks again after so long at the latest.
    """

    turn_rad: float = math.radians(30.0)
    settle_s: float = 0.25
    max_age_s: float = 1.0


class SearchWatcher(Protocol):
    """Told, in the agent's thread, what it has been shown and what it did."""

    def __call__(self, instant: Instant, intent: Intent | None) -> None:
        """Called after every action; None is no motion."""
        ...


class Search:
    """Drives one agent through one search at a time. `start` and `cancel` never wait."""

    def __init__(
        self,
        agent: Agent,
        driver: Driver,
        senses: Senses,
        timing: SearchTiming,
        clock: Callable[[], float] = time.time,
    ) -> None:
        """Start idle; `run` does the work, in a thread of the caller's.

        Args:
            agent: Any.
            driver: What it moves by.
            senses: What it sees by.
            timing: When it looks.
            clock: The clock of the images' stamps, seconds.
        """
        self._agent, self._driver, self._senses = agent, driver, senses
        self._timing, self._clock = timing, clock
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._closed = False
        self._request: str | None = None
        self._generation = 0
        self._bumps: list[NDArray[np.float64]] = []
        self._searched = self._moving = self._turning = self._collided = False
        self._rest_s = 0.0
        self._shown: Instant | None = None
        self.watchers: list[SearchWatcher] = []
        self.goal = ""
        self.steps = 0
        self.status = Status.IDLE
        self.reason = ""
        """Why the search ended or waits, in words; empty while all is well."""

    def start(self, goal: str) -> None:
        """Forget the last search and look for `goal` in images taken from now on."""
        with self._lock:
            self._generation += 1
            self._driver.stop()
            self._request, self.goal = goal, goal
            self.status, self.reason, self.steps = Status.SEARCHING, "", 0
        self._wake.set()

    def cancel(self, why: str = "cancelled") -> None:
        """Stand still from now on."""
        with self._lock:
            self._generation += 1
            self._driver.stop()
            self._request = None
            if self.status is Status.SEARCHING:
                self.status, self.reason = Status.CANCELLED, why

    def close(self) -> None:
        """End the search; `run` returns soon."""
        self.cancel()
        self._closed = True
        self._wake.set()

    def run(self) -> None:
        """Work until `close`."""
        while not self._closed:
            self.round()
            self._wake.wait(ROUND_S)
            self._wake.clear()
        self._agent.close()

    def round(self) -> None:
        """Let the agent do what is to be done now, if anything."""
        with self._lock:
            request, self._request = self._request, None
            generation = self._generation
        if request is None and self.status is not Status.SEARCHING:
            return
        try:
            if request is not None:
                self._begin(request)
                self._moving = self._collided = False
                self._rest_s, self._shown = self._clock(), None
            self._look(generation)
        except Exception as error:  # whatever it is, the robot must stop
            self._end(generation, Status.FAILED, f"{type(error).__name__}: {error}")

    def _begin(self, goal: str) -> None:
        """Start the agent on a goal, with what earlier goals have taught it."""
        if self._searched and isinstance(self._agent, RecallingAgent):
            self._agent.recall(self._agent.knowledge)
        self._searched = True
        self._agent.reset(goal)

    def _look(self, generation: int) -> None:
        """Show the agent an image if one is due, and carry out what it answers."""
        outcome = self._driver.outcome
        if self._moving and outcome is not Outcome.UNDER_WAY:
            self._moving = False
            # A turn that is blocked says nothing of what is ahead.
            self._collided = outcome is Outcome.BLOCKED and not self._turning
            self._rest_s = self._clock() + self._timing.settle_s
        instant = self._senses.newest()
        with self._lock:
            if self._generation == generation:
                self.reason = self._senses.reader.lacks
        if instant is None or not self._is_due(instant):
            return
        begun_s = time.perf_counter()
        seen = self._senses.reader.observation(instant)
        observation = replace(seen, collided=self._collided, step=self.steps)
        action = self._agent.act(observation)
        self._senses.timings.add("agent", time.perf_counter() - begun_s)
        if self._collided:
            self._bumps.append(instant.world_from_base.translation[:2])
        self._shown, self._collided = instant, False
        intent = self._intent(action, instant)
        for watch in self.watchers:
            watch(instant, intent)
        if action is Action.STOP:
            self._end(generation, Status.DONE, "")
            return
        with self._lock:
            if self._generation != generation:
                return
            self.steps += 1
            pose = self._senses.pose
            if intent is not None and pose is not None:
                onward = self._moving and isinstance(intent, Follow)
                self._driver.begin(intent, pose, go_on=onward)
                self._moving = True
                self._turning = isinstance(intent, Turn)
        self._senses.timings.add("image to intent", self._clock() - instant.stamp_s)

    def _is_due(self, instant: Instant) -> bool:
        """Whether the agent should see it."""
        if not self._moving or self._shown is None:
            return instant.stamp_s >= self._rest_s
        if self._turning:
            return False
        last = self._shown
        moved = last.world_from_base.inverse() @ instant.world_from_base
        return (
            instant.stamp_s - last.stamp_s >= self._timing.max_age_s
            or math.hypot(*moved.translation[:2]) >= STEP_M
            or abs(moved.yaw) >= self._timing.turn_rad
        )

    def _intent(self, action: Action, instant: Instant) -> Intent | None:
        """What an action means for the base."""
        pose = instant.world_from_base
        here = pose.translation[:2]
        way = self._agent.way if isinstance(self._agent, WalkingAgent) else None
        # Beside a bump the agent's own steps lead round it, headings that are barred left out.
        bumped = any(np.hypot(*(here - bump)) < NEAR_BUMP_M for bump in self._bumps)
        if way is not None and len(way) and not bumped:
            return Follow(way)
        if action is Action.MOVE_FORWARD:
            ahead = STEP_M * np.array([math.cos(pose.yaw), math.sin(pose.yaw)])
            return Follow(pose.translation[None, :2] + ahead)
        turns = {Action.TURN_LEFT: 1.0, Action.TURN_RIGHT: -1.0}
        return Turn(turns[action] * self._timing.turn_rad) if action in turns else None

    def _end(self, generation: int, status: Status, reason: str) -> None:
        with self._lock:
            if self._generation == generation:
                self._driver.stop()
                self._moving = False
                self.status, self.reason = status, reason
