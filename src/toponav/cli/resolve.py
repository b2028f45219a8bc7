"""From options to configurations: what the commands that run episodes share."""

from __future__ import annotations

from toponav.cli.options import AgentOptions, RunOptions, image_size, overrides
from toponav.config import parse_config, with_overrides
from toponav.envs.simulator import HouseEnvConfig
from toponav.evaluation.run_config import RunConfig, run_config
from toponav.evaluation.run_folder import RunRequest


def resolve_config(options: AgentOptions) -> RunConfig:
    """The run's configuration from the command line.

    Raises:
        InputError: A value that cannot be used; the message names it.
    """
    width, height = image_size(options.camera)
    size_and_limit = {"width": width, "height": height, "max_steps": options.max_steps}
    env = parse_config(HouseEnvConfig, size_and_limit, "the command line")
    config = run_config(options.preset, options.method, options.seed, env)
    config = config.model_copy(update={"detector": options.detector, "reasoner": options.reasoner})
    return with_overrides(config, overrides(options.set))


def resolve_request(source: str, options: RunOptions, shard: str | None = None) -> RunRequest:
    """What to run, from the command line.

    Raises:
        InputError: A value that cannot be used; the message names it.
    """
    return parse_config(
        RunRequest,
        {
            "source": source,
            "episodes": options.episodes,
            "labels": options.labels,
            "data": options.data,
            "shard": shard,
            "workers": options.workers,
            "ray_address": options.ray_address,
            "record": options.record,
        },
        "the command line",
    )
