"""Read rigs of data sets: archives, folders and stores."""
