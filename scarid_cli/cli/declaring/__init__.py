"""What the declarations of commands share; nothing heavy is imported."""
