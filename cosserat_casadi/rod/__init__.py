"""A Cosserat rod: sections, strain, kinematics, statics."""
