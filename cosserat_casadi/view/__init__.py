"""A scene in a browser on this machine: the page with a server behind it that solves, finds inputs and moves."""
