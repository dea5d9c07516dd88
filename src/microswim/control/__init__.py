"""The model inside a controller's loop: steppers, sensors, exports to C and FMI, environments."""
