"""An episode as the page's script reads it: plain JSON values, names readable."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from toponav.categories import readable
from toponav.evaluation.explanation_file import DecisionRecord, Explanation, MapRecord, values_of
from toponav.memory.graph import TopologicalMemory
from toponav.viz.labels import MIN_AREA_M2
from toponav.viz.report.changes import changes
from toponav.viz.report.episode_files import (
    DecisionLine,
    EpisodeRecords,
    ExchangeLine,
    StepLine,
    ViewLine,
)
from toponav.viz.report.pictures import Pictures

CENTI = 100
"""Positions and angles are whole hundredths on the page: a centimetre, half a degree."""


def episode_data(records: EpisodeRecords, pictures: Pictures) -> dict[str, Any]:
    """The episode; its pictures go into `pictures` and are named by their digests."""
    explanation = records.explanation
    explained = {} if explanation is None else {d.index: d for d in explanation.decisions}
    decisions = []
    before: DecisionRecord | None = None
    for line in records.decisions:
        record = explained.get(line.index)
        data = _decision(line)
        if record is not None:
            first = 0 if before is None else before.exchanges
            data |= _explained(record, pictures, f"{records.result.scene} #{records.result.index}")
            data["exchanges"] = [
                _exchange(one) for one in records.exchanges[first : record.exchanges]
            ]
            data["changes"] = changes(before, record)
            before = record
        decisions.append(data)
    return {
        "target": readable(records.result.target),
        "steps": _steps(records.steps),
        "decisions": decisions,
        "end": None if explanation is None or explanation.end is None else _map(explanation.end),
        "picture": _picture(explanation, pictures),
        "memory": _memory(records.memory),
    }


def _steps(steps: Sequence[StepLine]) -> dict[str, Any]:
    """Columns of whole numbers, which compress well."""
    return {
        "step": [line.step for line in steps],
        "x": [round(CENTI * line.position[0]) for line in steps],
        "y": [round(CENTI * line.position[1]) for line in steps],
        "z": [round(CENTI * line.position[2]) for line in steps],
        "yaw": [round(CENTI * line.yaw) for line in steps],
        "collided": [line.step for line in steps if line.collided],
    }


def _decision(line: DecisionLine) -> dict[str, Any]:
    guidance = line.guidance
    return {
        "index": line.index,
        "step": line.step,
        "phase": line.phase,
        "node": line.node,
        "waypoint": line.waypoint,
        "path": line.path,
        "memoryText": line.memory_text,
        "views": [_view(view) for view in line.views],
        "guidance": None
        if guidance is None
        else {
            "node": guidance.node_id,
            "direction": guidance.direction,
            "found": guidance.target_found,
            "room": readable(guidance.room_type),
            "reason": guidance.reason,
        },
    }


def _view(view: ViewLine) -> dict[str, Any]:
    return {
        "bearing": view.bearing,
        "frontiers": view.frontiers,
        "floor": view.floor_m2,
        "seen": [[readable(label), score] for label, score in view.seen],
    }


def _explained(record: DecisionRecord, pictures: Pictures, where: str) -> dict[str, Any]:
    panorama = record.panorama
    return {
        "floor": record.floor,
        "map": _map(record.map),
        "nodes": [{**node.model_dump(), **_names(node)} for node in record.nodes],
        "edges": record.edges,
        "history": record.history,
        "frontiers": [
            {**one.model_dump(), "speaks": readable(one.speaks)} for one in record.frontiers
        ],
        "candidates": [one.model_dump() for one in record.candidates],
        "terms": [[term.name, term.value] for term in record.terms],
        "panorama": None if panorama is None else pictures.add(panorama, where),
    }


def _map(record: MapRecord) -> dict[str, Any]:
    return {
        "origin": record.origin,
        "resolution": record.resolution,
        "shape": record.shape,
        "cells": record.cells,
        "objects": record.objects,
        "categories": [readable(name) for name in record.categories],
        "heat": record.heat,
        "landmarks": _landmarks(record),
    }


def _landmarks(record: MapRecord) -> list[tuple[int, float, float]]:
    """Category and centre (x, y) of each object that is large enough to be named."""
    layer = values_of(record.objects, record.shape)
    touching = np.ones((3, 3), dtype=np.bool_)
    found = []
    for index in range(len(record.categories)):
        labels, _ = ndimage.label(layer == index + 1, structure=touching)
        for k, box in enumerate(ndimage.find_objects(labels), start=1):
            if np.count_nonzero(labels[box] == k) * record.resolution**2 >= MIN_AREA_M2:
                x, y = (
                    low + record.resolution * (side.start + side.stop) / 2.0
                    for low, side in zip(record.origin, box, strict=True)
                )
                found.append((index, round(x, 2), round(y, 2)))
    return found


def _picture(explanation: Explanation | None, pictures: Pictures) -> dict[str, Any] | None:
    if explanation is None or explanation.picture is None:
        return None
    picture = explanation.picture
    digest = pictures.add(picture.image, "the picture of a floor")
    return {"floor": picture.floor, "low": picture.low, "high": picture.high, "image": digest}


def _memory(memory: TopologicalMemory | None) -> dict[str, Any] | None:
    """The memory at the end, for episodes whose decisions are not explained."""
    if memory is None:
        return None
    return {
        "nodes": [{**vars(node), **_names(node)} for node in memory.nodes],
        "edges": [[edge.source, edge.target, edge.geodesic_m] for edge in memory.edges],
    }


def _names(node: Any) -> dict[str, Any]:
    return {
        "room_type": readable(node.room_type),
        "objects": [readable(name) for name in node.objects],
    }


def _exchange(line: ExchangeLine) -> dict[str, Any]:
    return {
        "prompt": line.prompt,
        "model": line.model,
        "text": line.text,
        "answer": line.answer,
        "failure": line.failure,
        "cached": line.cached,
        "images": len(line.images),
        "requests": len(line.attempts),
        "seconds": round(sum(one.latency_s for one in line.attempts), 2),
        "tokensIn": sum(one.prompt_tokens for one in line.attempts),
        "tokensOut": sum(one.completion_tokens for one in line.attempts),
        "cost": sum(one.cost_usd for one in line.attempts),
        "failures": [one.failure for one in line.attempts if one.failure],
    }
