"""Processes: whatever a stage runs over one column, and how torques follow it in phase."""
