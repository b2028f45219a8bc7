"""A detector of one's own, registered by name: it finds things by their colour."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav import Detections, HouseEnvConfig, load_scene
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner
from toponav.perception import DetectorContext, detectors


class GreenIsSofa:
    """Calls whatever is clearly green a sofa; a network would be called in its place."""

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """One detection of all green pixels, if there are enough of them."""
        red, green, blue = (rgb[..., k].astype(int) for k in range(3))
        mask = (green > red + 15) & (green > blue + 15)
        if "sofa" not in vocabulary or mask.sum() < 50:
            return Detections.empty(*mask.shape)
        rows, columns = np.nonzero(mask)
        box = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
        return Detections(
            labels=("sofa",),
            scores=np.array([0.8], np.float32),
            boxes=np.array([box], np.float32),
            masks=mask[None],
        )


@detectors.register("green")
def green(context: DetectorContext) -> GreenIsSofa:
    """Build one; a detector takes what it needs from the context."""
    return GreenIsSofa()


if __name__ == "__main__":
    config = run_config("default", env=HouseEnvConfig(width=160, height=120, max_steps=60))
    config = config.model_copy(update={"detector": "green"})
    runner = SceneRunner(load_scene("generated:6"), config)
    result = runner.run(runner.spec(0, runner.env.episode("sofa", None, 0)))
    print(
        f"{result.steps} steps, ended by {result.ended} {result.distance_to_goal:.2f} m from a sofa"
    )
