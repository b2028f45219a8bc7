"""From guidance to a waypoint: affordances, their argmax, and the target (Section III-E)."""
