"""Pictures of what happened; they observe, and nothing below imports them."""
