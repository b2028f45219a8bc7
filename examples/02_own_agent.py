"""A method of one's own, registered by name and run beside the others."""

from toponav import Action, HouseEnvConfig, Observation, load_scene
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner
from toponav.methods import AgentContext, methods


class WallFollower:
    """Walks until it bumps, then turns left; knows nothing of its goal."""

    def reset(self, goal: str) -> None:
        """Nothing to forget."""

    def act(self, observation: Observation) -> Action:
        """Forward, or left after a bump."""
        return Action.TURN_LEFT if observation.collided else Action.MOVE_FORWARD

    def close(self) -> None:
        """Nothing to release."""


@methods.register("wall-follower")
def wall_follower(context: AgentContext) -> WallFollower:
    """Build one; a method takes what it needs from the context."""
    return WallFollower()


if __name__ == "__main__":
    env = HouseEnvConfig(width=160, height=120, max_steps=60)
    for method in ("wall-follower", "frontier"):
        runner = SceneRunner(load_scene("generated:6"), run_config("paper", method, env=env))
        result = runner.run(runner.episode(0))
        length, soft_spl = result.path_length, result.soft_spl
        print(f"{method}: {result.ended} after {length:.1f} m, SoftSPL {soft_spl:.2f}")
