"""Batches of jobs: parallel, resumable, interruptible."""
