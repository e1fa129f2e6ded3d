"""Many sessions analysed by one command: what there is to do, who does it, what is done already, and the one table.

A session is a task, and a task is one pure function of what it is given (`task.py`); whoever runs it, this process,
processes of this computer or a cluster, is a `concurrent.futures.Executor` (`executors.py`), and one loop hands the
tasks out and again where a worker was lost (`spread.py`). What is done is kept beside the results (`done.py`), so that
the same command goes on where it was ended. Nothing here needs a screen.
"""
