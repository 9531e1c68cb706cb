"""Keys and values of TOML files, checked with a message that names the place."""
