"""The manual: pages of all commands, made of their declarations, as man pages and as Markdown."""
