"""The noise of a channel: white, correlated, by place, rounded, with outliers."""
