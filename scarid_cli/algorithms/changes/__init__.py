"""Whether a robot has changed between two logs, and what explains the difference."""
