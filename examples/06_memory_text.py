"""The topological memory: what a language model reads at each decision."""

from toponav import HouseEnv, HouseEnvConfig, Navigator, OracleDetector, PriorReasoner, load_scene
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.policy.decision import Decision


class Reader:
    """Watches the decisions; it cannot steer."""

    def on_decision(self, decision: Decision) -> None:
        """Print the memory as the reasoner read it, and what it answered."""
        if decision.memory is not None and decision.guidance is not None:
            print(f"step {decision.step}\n{decision.memory.text}")
            print(f"-> {decision.guidance.reason}\n")

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Nothing to add."""


env = HouseEnv(load_scene("generated:6"), HouseEnvConfig(width=160, height=120, max_steps=60))
env.reset(seed=0)
agent = Navigator(OracleDetector(env.oracle), PriorReasoner(), listener=Reader())
agent.reset(env.target)
done = False
while not done:
    _, _, stopped, cut_off, _ = env.step(agent.act(env.observe()))
    done = stopped or cut_off
agent.close()
