"""Side-by-side measurements that print the tables in docs/."""
