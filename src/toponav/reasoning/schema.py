"""What a reasoner answers: k', d_vlm, g_found and R (Section III-E)."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Guidance(BaseModel):
    """The reasoner's answer; its JSON schema is what a VLM is asked to fill."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    node_id: int
    """k': id of the remembered place around whose frontiers to search next."""

    direction: int
    """d_vlm: index of the panorama view that looks most promising."""

    target_found: bool
    """g_found: whether the target object itself is visible in the panorama."""

    room_type: str
    """R: the type of room in which the panorama was taken."""

    reason: str = ""
    """One sentence for people."""

    def steers_as(self, other: Guidance) -> bool:
        """Whether both lead the same way, whatever they call the room and their reasons."""
        return (self.node_id, self.direction, self.target_found) == (
            other.node_id,
            other.direction,
            other.target_found,
        )
