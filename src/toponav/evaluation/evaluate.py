"""`toponav eval`: many episodes, by any number of workers, safe against every kind of end."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from toponav.errors import InputError, TopoNavError
from toponav.evaluation.crew import Crew, InProcess, Outcome, WorkerFactory, drive
from toponav.evaluation.episode_worker import EpisodeWorker
from toponav.evaluation.metrics import BENCHMARK_RADIUS_M
from toponav.evaluation.model_files import ModelFiles, check_replay
from toponav.evaluation.other_floor import only
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import RunFolder, RunRequest
from toponav.evaluation.runner import check_parts
from toponav.evaluation.sources import open_source
from toponav.evaluation.summary import summarize
from toponav.evaluation.tasks import Task, TaskQueue, plan, shard
from toponav.reasoning.openai_compatible import NAME as OPENAI
from toponav.reasoning.usage import VlmUsage, total_usage


@dataclass(frozen=True)
class RunProgress:
    """How far a run is.

    Attributes:
        done: Episodes finished, those of an earlier run that is resumed included.
        total: Episodes in all.
        outcome: The newest, or None at the start.
        results: All of them; the list grows.
    """

    done: int
    total: int
    outcome: Outcome | None
    results: list[EpisodeResult]


OnProgress = Callable[[RunProgress], None]


def evaluate(
    request: RunRequest,
    config: RunConfig,
    folder: Path,
    resume: bool = False,
    on_progress: OnProgress = lambda progress: None,
) -> dict[str, Any]:
    """Run the episodes of a source and write them into `folder`, one line each as they finish.

    Args:
        request: What to run.
        config: How.
        folder: Gets `config.json`, `run.json`, `episodes.jsonl` and, at the end, `summary.json`.
        resume: Go on with the run that was begun there.
        on_progress: Told at the start and after every episode.

    Returns:
        The summary: all episodes, those that stay on one floor, and those that change floor.

    Raises:
        InputError: Nothing to run; the folder holds another run's episodes, or is being written
            to; on resuming, the configuration or the source differ.
    """
    source = open_source(request.source, request.labels, request.data)
    tasks = plan(source.outlines(), request.episodes)
    if request.only is not None:
        tasks = only(tasks, source, request.only)
    if request.shard is not None:
        tasks = shard(tasks, request.shard)
    if request.workers < 1:
        raise InputError(f"--workers takes a positive number, not {request.workers}")
    check_parts(config, replayed=request.replay is not None)
    _check_cost(request, config)
    where = folder.resolve()
    models = ModelFiles(where, request.cache, request.replay)
    if request.replay is not None:
        check_replay(request.replay)
    recorded = where if request.record else None
    make_worker = partial(EpisodeWorker, source, config, recorded, models, request.explain)
    run = RunFolder(folder)
    with run.opened(request, config, resume):
        results = run_tasks(
            run, tasks, make_worker, partial(_crew, make_worker, request), on_progress,
            request.max_cost,
        )  # fmt: skip
    summary = _summary(request.source, config, tasks, results)
    run.conclude(summary)
    if len(results) < len(tasks):
        raise TopoNavError(
            f"stopped at {summary['vlm']['cost_usd']:.2f} dollars of --max-cost "
            f"{request.max_cost:g} after {len(results)} of {len(tasks)} episodes; go on with "
            "--resume and a higher --max-cost"
        )
    return summary


def run_tasks(
    run: RunFolder,
    tasks: list[Task],
    make_worker: WorkerFactory,
    make_crew: Callable[[], Crew],
    on_progress: OnProgress,
    max_cost: float | None = None,
) -> list[EpisodeResult]:
    """Run what is left and write it down.

    Args:
        run: The run's folder, opened.
        tasks: All tasks of the run.
        make_worker: Makes the worker that words the result of an episode that is given up.
        make_crew: Makes the workers; they are let go at the end. Not called if nothing is left.
        on_progress: Told at the start and after every episode.
        max_cost: Dollars after which no further episode is begun.

    Returns:
        All results, those of the run that is resumed included.
    """
    results = run.journal.results()
    keys = {result.key for result in results}
    left = [task for task in tasks if task.key not in keys]
    total = len(results) + len(left)
    queue = TaskQueue(left)

    def stop_if_spent() -> None:
        if max_cost is not None and sum(r.vlm.cost_usd for r in results) >= max_cost:
            queue.clear()

    def keep(outcome: Outcome) -> None:
        run.keep(outcome)
        results.append(outcome.result)
        stop_if_spent()
        on_progress(RunProgress(len(results), total, outcome, results))

    on_progress(RunProgress(len(results), total, None, results))
    stop_if_spent()
    if len(queue):
        with closing(make_crew()) as crew:
            drive(crew, queue, make_worker().failed, keep)
    return results


def _crew(make_worker: WorkerFactory, request: RunRequest) -> Crew:
    if request.workers == 1 and request.ray_address is None:
        return InProcess(make_worker)
    from toponav.evaluation.distributed import RayCrew

    return RayCrew(make_worker, request.workers, request.ray_address)


def _summary(
    source: str, config: RunConfig, tasks: list[Task], results: list[EpisodeResult]
) -> dict[str, Any]:
    """The run's numbers, from the episodes in the order of their tasks."""
    order = {task.key: k for k, task in enumerate(tasks)}
    ordered = sorted(results, key=lambda r: (order.get(r.key, len(order)), r.key))
    return {
        "source": source,
        "method": config.method,
        "preset": config.preset,
        "backend": config.backend,
        "follower": config.follower,
        "all": summarize(ordered),
        "same_floor": summarize([result for result in ordered if not result.floor_change]),
        "floor_change": summarize([result for result in ordered if result.floor_change]),
        "vlm": asdict(total_usage(result.vlm for result in ordered)),
    }


def summary_line(summary: dict[str, Any]) -> str:
    """The run in a few plain lines: one for each group that has episodes."""
    lines = [f"{summary['method']} (preset {summary['preset']}) on {summary['source']}"]
    if summary["follower"] == "oracle":
        lines[0] += " - FOLLOWER ORACLE: walks on the simulator's navmesh"
    for group in ("all", "same_floor", "floor_change"):
        row = summary[group]
        if row["n"]:
            lines.append(f"  {group.replace('_', ' '):13s}{_row(row)}")
    model = usage_line(VlmUsage(**summary["vlm"]))
    if model:
        lines.append(f"  {'model':13s}{model}")
    return "\n".join(lines)


def usage_line(usage: VlmUsage) -> str:
    """What a model took in a few plain words; nothing where none was asked."""
    if usage == VlmUsage():
        return ""
    kinds = ", ".join(f"{kind} {count}" for kind, count in usage.failure_kinds.items())
    words = [
        f"{usage.calls} calls, {usage.failures} failed" + (f" ({kinds})" if kinds else ""),
        f"{usage.prompt_tokens} tokens in, {usage.completion_tokens} out",
        f"{usage.cost_usd:.4f} dollars",
    ]
    if usage.cached:
        words.append(f"{usage.cached} questions answered by the cache")
    if usage.unanswered:
        words.append(f"{usage.unanswered} by the stand-in")
    if usage.not_recorded:
        words.append(f"{usage.not_recorded} prompts changed since the recording")
    return ", ".join(words)


def _check_cost(request: RunRequest, config: RunConfig) -> None:
    """A limit means nothing for a model whose price nobody knows."""
    openai = config.reasoning.openai
    if request.max_cost is not None and config.reasoner == OPENAI and openai.price() is None:
        raise InputError(
            f"--max-cost: the price of {openai.model} is not known; give it in dollars per million "
            "tokens in and out, as --set reasoning.openai.price_per_million=[2.5,10]"
        )


def _row(row: dict[str, Any]) -> str:
    rate = row["sr"][str(BENCHMARK_RADIUS_M)]
    low, high = rate["interval"]
    dtg = "-" if row["dtg"] is None else f"{row['dtg']:.2f} m"
    return (
        f"n {row['n']}, SR@0.1 {100 * rate['rate']:.1f} % "
        f"[{100 * low:.1f}, {100 * high:.1f}], SR@1.0 {100 * row['sr']['1.0']['rate']:.1f} %, "
        f"SPL {row['spl']:.3f}, SoftSPL {row['soft_spl']:.3f}, DTG {dtg}, "
        f"unreachable {row['unreachable']}, steps {row['steps']:.0f}"
    )
