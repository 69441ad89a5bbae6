"""The work–precision bench: for one scene, the error of every method against its cost."""
