"""Excitations: each module of this folder is one choice of `scarid trajgen --excitation`."""
