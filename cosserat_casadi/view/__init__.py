"""A scene in a browser on this machine: a page and its server, which solves, finds inputs and computes motions."""
