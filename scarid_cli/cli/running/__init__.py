"""What the actions of commands share: jobs, logs, settings, and what is shown."""
