"""From options to configurations: what the commands that run episodes share."""

from __future__ import annotations

from pathlib import Path

from toponav.cli.options import AgentOptions, RunOptions, image_size, overrides
from toponav.config import load_config, parse_config, with_overrides
from toponav.envs.simulator import HouseEnvConfig
from toponav.errors import InputError
from toponav.evaluation.run_config import RunConfig, run_config
from toponav.evaluation.run_folder import CONFIG_FILE, RUN_FILE, RunRequest


def resolve_config(options: AgentOptions) -> RunConfig:
    """The run's configuration from the command line.

    Raises:
        InputError: A value that cannot be used; the message names it.
    """
    width, height = image_size(options.camera)
    size_and_limit = {"width": width, "height": height, "max_steps": options.max_steps}
    env = parse_config(HouseEnvConfig, size_and_limit, "the command line")
    config = run_config(options.preset, options.method, options.seed, env)
    parts = ("detector", "reasoner", "backend", "follower")
    config = config.model_copy(update={name: getattr(options, name) for name in parts})
    model = {"model": options.model, "base_url": options.base_url}
    named = {f"reasoning.openai.{key}": value for key, value in model.items() if value is not None}
    return with_overrides(config, {**named, **overrides(options.set)})


def resolve_run(
    source: str | None, options: RunOptions, agent: AgentOptions, shard: str | None = None
) -> tuple[RunRequest, RunConfig]:
    """What to run and how, from the command line.

    Raises:
        InputError: A value that cannot be used; the message names it.
    """
    if source is None:
        raise InputError("give a SOURCE, such as generated:0-49, or --replay RUN")
    request = {
        "source": source,
        "episodes": options.episodes,
        "only": options.only,
        "labels": options.labels,
        "data": options.data,
        "shard": shard,
        "workers": options.workers,
        "ray_address": options.ray_address,
        "record": options.record,
        "explain": options.explain,
        "cache": agent.cache,
        "max_cost": options.max_cost,
    }
    return parse_config(RunRequest, request, "the command line"), resolve_config(agent)


def resolve_replay(
    run: Path, source: str | None, options: RunOptions, agent: AgentOptions
) -> tuple[RunRequest, RunConfig]:
    """An earlier run again, with its model's answers; who runs it is up to the command line.

    Raises:
        InputError: There is no such run, or it is told to be another one.
    """
    if source is not None or agent != AgentOptions():
        raise InputError(
            "--replay takes SOURCE and the agent's options from the run: leave them out"
        )
    request = load_config(RunRequest, run / RUN_FILE)
    again = {
        "workers": options.workers,
        "ray_address": options.ray_address,
        "record": options.record,
        "explain": options.explain,
        "episodes": options.episodes or request.episodes,
        "only": options.only or request.only,
        "cache": None,
        "max_cost": None,
        "replay": run.resolve(),
    }
    return request.model_copy(update=again), load_config(RunConfig, run / CONFIG_FILE)
