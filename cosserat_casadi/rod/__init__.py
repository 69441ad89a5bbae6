"""One Cosserat rod: sections, strain, kinematics, statics."""
