"""What acts inside a rod, between its sections: tendons and pressure chambers, along their routings."""
