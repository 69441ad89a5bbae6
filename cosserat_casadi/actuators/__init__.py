"""Actuators inside a rod, which act between its sections: tendons, pressure chambers and muscles."""
