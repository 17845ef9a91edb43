"""Lines of several cases in one picture: a metric over a column, such as an error over the feed."""
