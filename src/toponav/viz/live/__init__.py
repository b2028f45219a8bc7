"""What the agent sees and thinks, live in Rerun's viewer or in an `.rrd` file (extra `viz`).

`stream` opens and closes the recording, `blueprint` lays the viewer out, `watcher` logs an episode,
`entities` turns the package's values into Rerun's. All of it observes: the agent does not know it.
"""
