"""What a user can choose: algorithms by name, their settings, and where `tune` searches."""
