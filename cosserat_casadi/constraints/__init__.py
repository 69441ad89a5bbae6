"""Constraints on sections of rods: supports of tips, joints, cables of given length."""
