"""What a user can choose: algorithms by name, their settings, and the ranges `tune` searches."""
