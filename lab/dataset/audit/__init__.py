"""Find damaged, duplicate and variant rigs of a data set."""
