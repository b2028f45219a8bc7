"""The cylinder that moves through a scene."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from toponav.config_model import ConfigModel

PositiveLength = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class AgentBody(ConfigModel):
    """What decides where an agent can be; defaults of habitat-lab's ObjectNav (PROTOCOL)."""

    radius: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] = 0.18
    """Of the cylinder, metres."""
    height: PositiveLength = 0.88
    """Of the cylinder, metres: less room above the floor stops it."""
    max_climb: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] = 0.2
    """Highest step that it takes, metres."""
    max_slope_deg: Annotated[float, Field(ge=0.0, lt=90.0)] = 45.0
    """Steepest slope that it walks on, degrees."""
    cell_size: PositiveLength = 0.05
    """Side of the columns that the scene is cut into, metres; Habitat's value too."""

    @model_validator(mode="after")
    def _climb_keeps_storeys_apart(self) -> Self:
        if self.max_climb >= 0.5 * self.height:
            raise ValueError("max_climb must be less than half of height")
        return self
