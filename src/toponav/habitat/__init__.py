"""This package's agents inside habitat-lab; Habitat itself loads only where it is compared with."""

from toponav.habitat.challenge_agent import ChallengeAgent

__all__ = ["ChallengeAgent"]
