"""A map from posed RGB-D images: clouds by category, the grid, its frontiers."""

import numpy as np

from toponav import HouseEnv, HouseEnvConfig, OracleDetector, load_scene
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.view import FREE

env = HouseEnv(load_scene("generated:6"), HouseEnvConfig(width=160, height=120))
env.reset(seed=0)
detector = OracleDetector(env.oracle)
house_map = SemanticMap(MapConfig())
TURN_LEFT = 2
for _ in range(12):  # once around, by 30 degrees
    observation = env.observe()  # rgb, depth, world_from_camera, intrinsics: your own would do
    vocabulary = ("chair", "table", "bed", "sofa", "toilet", "cabinet", "plant")
    house_map.integrate(observation, detector.detect(observation.rgb, vocabulary))
    env.step(TURN_LEFT)
view = house_map.view()
free_m2 = np.count_nonzero(view.grid.cells == FREE) * view.grid.resolution**2
print(f"{len(view.scene)} points, {free_m2:.1f} m2 free, {len(view.frontiers)} frontier points")
for category, cloud in sorted(view.objects.items()):
    print(f"{category}: {len(cloud)} points about {cloud.points.mean(axis=0).round(1)}")
