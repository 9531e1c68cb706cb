"""How far entries of the catalogue (beyond/) move the estimates, and what is fitted beside them."""
