"""The command line: one thin file a subcommand; `main` turns errors into exit codes."""
