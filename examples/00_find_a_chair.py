"""The whole loop in a few lines: a house, a simulator, the navigator, a chair."""

from toponav import HouseEnv, HouseEnvConfig, Navigator, OracleDetector, PriorReasoner, load_scene

env = HouseEnv(load_scene("generated:6"), HouseEnvConfig(width=320, height=240))
env.reset(seed=0, options={"target": "chair"})
agent = Navigator(OracleDetector(env.oracle), PriorReasoner())
agent.reset("chair")
ended = False
steps = 0
while not ended:
    _, _, stopped, cut_off, _ = env.step(agent.act(env.observe()))
    ended = stopped or cut_off
    steps += 1
print(f"{steps} steps, {env.oracle.distance_to_goal():.2f} m from where a chair is seen")
