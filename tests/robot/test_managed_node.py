"""The node without a robot: its states, and its goals by message, by parameter and by argument."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from dds_domain import domain_of

from toponav.errors import TopoNavError
from toponav.robot.trial import Process, TrialConfig

pytest.importorskip("rclpy", reason="needs the extra ros2")
pytest.importorskip("nav_msgs", reason="needs the extra ros2")

PATIENCE_S = 60.0
"""For an answer on a busy machine."""


class Observer:
    """Hears the node's status and asks it for things."""

    def __init__(self, witness) -> None:
        from std_msgs.msg import String

        self.witness, self.status = witness, {}
        witness.node.create_subscription(String, "toponav/status", self._heard, 10)
        self._goal = witness.node.create_publisher(String, "toponav/goal", 10)

    def _heard(self, message) -> None:
        self.status = json.loads(message.data)

    def wait_for(self, **values) -> None:
        """Until the status has some values."""
        try:
            self.witness.wait(
                lambda: values.items() <= self.status.items(), PATIENCE_S, str(values)
            )
        except TopoNavError as error:
            raise AssertionError(f"{error}; last heard {self.status}") from error

    def send_goal(self, goal: str) -> None:
        from std_msgs.msg import String

        self._goal.publish(String(data=goal))

    def change_state(self, transition: int) -> None:
        from lifecycle_msgs.srv import ChangeState

        request = ChangeState.Request()
        request.transition.id = transition
        assert self.witness.ask(ChangeState, "toponav/change_state", request, PATIENCE_S).success

    def set_goal(self, goal: str) -> None:
        from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
        from rcl_interfaces.srv import SetParameters

        value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=goal)
        request = SetParameters.Request(parameters=[Parameter(name="goal", value=value)])
        answer = self.witness.ask(SetParameters, "toponav/set_parameters", request, PATIENCE_S)
        assert answer.results[0].successful


def test_the_node_goes_through_its_states_and_follows_its_goals(tmp_path: Path) -> None:
    from lifecycle_msgs.msg import Transition

    from toponav.robot.witness import Witness

    trial = TrialConfig("", "", domain=domain_of(10))
    arguments = ["ros2", "--managed", "--timeout-s", "600", "--ros-args", "-p", "goal:=chair"]
    with Witness(trial.domain) as witness:
        node = Process(arguments, tmp_path, "node", trial)
        try:
            observer = Observer(witness)
            observer.wait_for(active=False, status="idle")
            observer.change_state(Transition.TRANSITION_CONFIGURE)
            observer.wait_for(active=False, status="searching", goal="chair")
            observer.change_state(Transition.TRANSITION_ACTIVATE)
            observer.wait_for(active=True)
            observer.set_goal("bed")
            observer.wait_for(status="searching", goal="bed")
            observer.set_goal("")
            observer.wait_for(status="cancelled")
            observer.send_goal("sofa")
            observer.wait_for(status="searching", goal="sofa")
            observer.change_state(Transition.TRANSITION_DEACTIVATE)
            observer.wait_for(active=False, status="searching")
            observer.change_state(Transition.TRANSITION_CLEANUP)
            observer.wait_for(status="cancelled", reason="cleaned up")
            observer.change_state(Transition.TRANSITION_UNCONFIGURED_SHUTDOWN)
        finally:
            node.wait(PATIENCE_S)
    assert node.process.returncode == 0, node.last_words()
