"""Tables of finished runs: loaded, grouped, compared episode by episode, and rendered."""
