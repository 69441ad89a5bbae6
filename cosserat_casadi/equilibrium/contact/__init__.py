"""Contact without friction: which sections touch which obstacles, and how they are pressed."""
