"""What `cluster.py` is made of: workers that sleep, workers that are killed, slow disks."""
