"""Questions over the table of many sessions that a batch writes: what it holds, its groups, their means. No screen."""
