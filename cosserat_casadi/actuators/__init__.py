"""Actuators inside a rod, which act between its sections: tendons and pressure chambers, along their routings."""
