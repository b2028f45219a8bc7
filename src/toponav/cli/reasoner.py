"""`toponav reasoner`: what a model behind a server can do."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from toponav.cli.options import JsonFlag
from toponav.errors import TopoNavError

if TYPE_CHECKING:
    from toponav.evaluation.ledger import LedgerRow


@dataclass(frozen=True)
class Check:
    """Ask a configured model a few fixed questions: form of answers, sight, guidance, cost."""

    model: str | None = None
    """Model, as its server calls it; by default gpt-4o."""

    base_url: str | None = None
    """Server, such as http://localhost:8080/v1; by default OpenAI's. The key comes from the
    environment variable OPENAI_API_KEY alone."""

    set: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = field(default=())
    """Override any value, as --set reasoning.openai.retry.timeout_s=120; repeatable."""

    json: JsonFlag = False
    """Print the answers as one JSON object on stdout."""

    def run(self) -> None:
        """Ask and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import AgentOptions
        from toponav.cli.resolve import resolve_config
        from toponav.reasoning.openai_compatible import connect
        from toponav.reasoning.vlm.access import ModelAccess
        from toponav.reasoning.vlm.check import DECISIONS_PER_EPISODE, check_model

        options = AgentOptions(model=self.model, base_url=self.base_url, set=self.set)
        config, access = resolve_config(options).reasoning.openai, ModelAccess()
        client, chat = connect(config, access)
        output = Output(self.json)
        output.say(f"{config.model} at {config.base_url or 'OpenAI'}")
        questions = check_model(client, access, lambda: not chat.capabilities.images)
        decision = questions[-1]
        data: dict[str, Any] = {
            "model": config.model,
            "questions": [asdict(question) for question in questions],
            "structured": chat.capabilities.structured,
            "episode_usd": None,
            "episode_wait_s": None,
        }
        lines = [
            f"{'yes' if q.passed else 'no '}  {q.name} ({q.latency_s:.1f} s, {q.tokens[0]} tokens "
            f"in, {q.tokens[1]} out): {q.detail}"
            for q in questions
        ]
        if decision.passed:
            data["episode_usd"] = cost = DECISIONS_PER_EPISODE * decision.cost_usd
            data["episode_wait_s"] = wait = DECISIONS_PER_EPISODE * decision.latency_s
            known = "" if config.price() else ", price unknown"
            lines.append(f"form of answers: {chat.capabilities.structured}")
            lines.append(
                f"an episode of {DECISIONS_PER_EPISODE} decisions: {cost:.4f} dollars{known}, "
                f"{wait:.0f} s of waiting"
            )
        output.result("\n".join(lines), data)
        if not questions[0].passed:
            raise TopoNavError(
                f"{config.model} cannot serve as the reasoner: {questions[0].detail}"
            )


@dataclass(frozen=True)
class Ledger:
    """What the model of a finished run was asked, and what it took."""

    run_folder: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    """Folder that toponav eval or toponav run wrote."""

    json: JsonFlag = False
    """Print the rows as one JSON object on stdout."""

    def run(self) -> None:
        """Read and print."""
        from toponav.cli.console import Output
        from toponav.evaluation.ledger import ledger

        rows = ledger(self.run_folder)
        data = {"rows": [asdict(row) for row in rows]}
        Output(self.json).result("\n".join(map(_ledger_line, rows)), data)


def _ledger_line(row: LedgerRow) -> str:
    kinds = ", ".join(f"{kind} {count}" for kind, count in row.failures.items())
    latency = (
        "" if row.latency_s is None else "median {:.1f} s, 95 % {:.1f} s; ".format(*row.latency_s)
    )
    return (
        f"{row.prompt:12s} {row.questions} questions, {row.cached} from the cache, "
        f"{row.unanswered} by the stand-in; {row.calls} calls"
        + (f" ({kinds})" if kinds else "")
        + f"; {latency}{row.prompt_tokens} tokens in, {row.completion_tokens} out; "
        f"{row.cost_usd:.4f} dollars"
    )


@dataclass(frozen=True)
class ReasonerCommand:
    """The model that plays the paper's VLM: what it can do, and what it took."""

    command: (
        Annotated[Check, tyro.conf.subcommand("check")]
        | Annotated[Ledger, tyro.conf.subcommand("ledger")]
    )

    def run(self) -> None:
        """Run the chosen subcommand."""
        self.command.run()
