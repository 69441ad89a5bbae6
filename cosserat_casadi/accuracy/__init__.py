"""The discretisation that meets a tolerance at the least cost."""
