"""The steps of a batch: what Snakemake's jobs run, each for a group of logs of one robot."""
