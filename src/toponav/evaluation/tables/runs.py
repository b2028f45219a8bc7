"""Finished runs, read from the folders that `toponav eval` wrote."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from toponav.errors import InputError
from toponav.evaluation.journal import EPISODES_FILE, read_results
from toponav.evaluation.results import EpisodeResult, from_json
from toponav.evaluation.run_folder import CONFIG_FILE, RESULT_FILE, differences

SUBJECT = frozenset({"method", "preset", "navigator"})
"""What runs are compared for; the rest of a configuration is the protocol they should share."""

ORACLE_FOLLOWER_MARK = " (oracle follower)"
"""Ends the name of a run that walks on the simulator's navmesh, in every table of every format."""


@dataclass(frozen=True)
class Run:
    """One run, as a table shows it.

    Attributes:
        name: Its name in tables; unique among the runs of a table. That of a run with the oracle
            follower says so.
        folder: Where it was read from.
        config: Its `config.json`, empty where there is none.
        episodes: Its results in the order of their keys; at least one.
    """

    name: str
    folder: Path
    config: Mapping[str, Any]
    episodes: tuple[EpisodeResult, ...]

    @property
    def protocol(self) -> dict[str, Any]:
        """The part of the configuration that runs must share to be compared."""
        return {key: value for key, value in self.config.items() if key not in SUBJECT}

    def settings(self) -> str:
        """Method and protocol in one line."""
        if not self.config:
            return f"no {CONFIG_FILE}: protocol unknown"
        env = self.config.get("env", {})
        camera = f"{env.get('width', '?')} x {env.get('height', '?')}"
        noise = "noise" if _any_set(env.get("noise", {})) else "no noise"
        backend = self.config.get("backend", "embedded")
        oracle_follower = self.config.get("follower", "map") == "oracle"
        parts = (
            f"{self.config.get('method', '?')} (preset {self.config.get('preset', '?')})",
            f"detector {self.config.get('detector', '?')}",
            f"reasoner {self.config.get('reasoner', '?')}",
            f"camera {camera}", noise, f"{env.get('max_steps', '?')} steps",
            f"seed {self.config.get('seed', '?')}",
            *((f"backend {backend}",) if backend != "embedded" else ()),
            *(("FOLLOWER ORACLE: walks on the simulator's navmesh",) if oracle_follower else ()),
        )  # fmt: skip
        return ", ".join(parts)

    def protocol_difference(self, other: Run) -> str:
        """One line that names what of the protocol differs from another run's; "" if nothing.

        A run without a configuration is not judged: its settings say that it has none.
        """
        if not self.config or not other.config:
            return ""
        changed = [
            f"{key} ({theirs} there, {ours} here)"
            for key, theirs, ours in differences(other.protocol, self.protocol)
        ]
        if not changed:
            return ""
        return f"{self.name}: protocol differs from {other.name}: {', '.join(changed)}"


def load_runs(folders: Sequence[Path], names: Sequence[str] = ()) -> list[Run]:
    """Read runs, in the order given.

    Args:
        folders: Folders of runs, or folders that hold folders of runs, which come sorted.
        names: Their names in tables; by default what tells their paths apart.

    Raises:
        InputError: No run there, a run without episodes, a damaged file, a run given twice, or
            names that do not fit.
    """
    found = run_folders(folders)
    twice = [path for path, count in Counter(path.resolve() for path in found).items() if count > 1]
    if twice:
        raise InputError(f"{twice[0]} is given twice; give each run once")
    if names and len(names) != len(found):
        shown = ", ".join(map(str, found))
        raise InputError(f"{len(names)} names for {len(found)} runs ({shown}); give one for each")
    if len(set(names)) < len(names) or not all(names):
        raise InputError("two runs cannot share a name, nor have none; give each its own")
    titles = names or _short_names(found)
    return [_load(folder, name) for folder, name in zip(found, titles, strict=True)]


def run_folders(folders: Sequence[Path]) -> list[Path]:
    """The folders of runs among those given and, for those that are none, in them.

    Raises:
        InputError: None given, or one neither is nor holds a run.
    """
    if not folders:
        raise InputError("no run given; give the --out folder of a toponav eval")
    return [run for folder in folders for run in _runs_in(folder)]


def _runs_in(folder: Path) -> list[Path]:
    """The folder itself if it is a run's, else those in it that are."""
    if (folder / EPISODES_FILE).exists() or (folder / RESULT_FILE).exists():
        return [folder]
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; give the --out folder of a toponav eval")
    inner = sorted(path.parent for path in folder.glob(f"*/{EPISODES_FILE}"))
    if not inner:
        raise InputError(
            f"{folder}: no {EPISODES_FILE} in it or in its folders; give the --out folder of a "
            "toponav eval"
        )
    return inner


def _load(folder: Path, name: str) -> Run:
    results = _results(folder)
    if not results:
        raise InputError(f"{folder / EPISODES_FILE}: no finished episode yet; nothing to show")
    config = _config(folder)
    if config.get("follower", "map") == "oracle":
        name += ORACLE_FOLLOWER_MARK
    return Run(name, folder, config, tuple(sorted(results, key=lambda r: r.key)))


def _results(folder: Path) -> list[EpisodeResult]:
    """Those of an evaluation, or the one of a single episode."""
    single = folder / RESULT_FILE
    if (folder / EPISODES_FILE).exists() or not single.exists():
        return read_results(folder)
    return [from_json(single.read_text(encoding="utf-8", errors="replace"), str(single))]


def _config(folder: Path) -> dict[str, Any]:
    """The run's configuration as it was written, whatever version wrote it."""
    path = folder / CONFIG_FILE
    if not path.exists():
        return {}
    try:
        config = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path} cannot be read: {error}; restore it or remove it") from error
    if not isinstance(config, dict) or not isinstance(config.get("env", {}), dict):
        raise InputError(f"{path} is not the configuration of a run; restore it or remove it")
    return config


def _short_names(folders: Sequence[Path]) -> list[str]:
    """The ends of the paths, as long as it takes to tell them apart."""
    parts = [folder.resolve().parts for folder in folders]
    for length in range(1, max(map(len, parts)) + 1):
        names = ["/".join(path[-length:]) for path in parts]
        if len(set(names)) == len(names):
            break
    return names


def _any_set(value: Any) -> bool:
    """Whether any leaf of a configuration is neither zero, false nor empty."""
    if isinstance(value, dict):
        return any(map(_any_set, value.values()))
    return bool(value)
