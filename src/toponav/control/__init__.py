"""From a waypoint to actions: planning over known free space, following, recovery."""
