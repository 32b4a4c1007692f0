"""One module a system: configuration in, `step(epoch) -> Estimate` out."""
