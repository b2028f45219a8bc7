"""A reasoner of one's own, registered by name: it goes where most floor is to be seen."""

from toponav import HouseEnvConfig, PriorReasoner, load_scene
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner
from toponav.reasoning import Guidance, Query, ReasonerContext, reasoners


class MostFloor(PriorReasoner):
    """Knows nothing of rooms; what goes with what is still the prior's business."""

    def decide(self, query: Query) -> Guidance:
        """The view with most floor, from the place where the agent is."""
        views = query.panorama
        best = max(range(len(views)), key=lambda k: views[k].navigable_area_m2)
        found = any(item.label == query.target for view in views for item in view.seen)
        return Guidance(
            node_id=query.memory.current,
            direction=best,
            target_found=found,
            room_type="unknown",
            reason=f"view {best} shows {views[best].navigable_area_m2:.1f} m2 of floor",
        )


@reasoners.register("most-floor")
def most_floor(context: ReasonerContext) -> MostFloor:
    """Build one; a reasoner takes what it needs from the context."""
    return MostFloor(context.config.prior)


if __name__ == "__main__":
    env = HouseEnvConfig(width=160, height=120, max_steps=200)
    for name in ("most-floor", "prior"):
        config = run_config("paper", env=env).model_copy(update={"reasoner": name})
        runner = SceneRunner(load_scene("generated:6"), config)
        result = runner.run(runner.episode(0))
        print(f"{name}: {result.ended} after {result.steps} steps, SPL {result.spl:.2f}")
