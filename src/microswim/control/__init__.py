"""The model inside a controller's loop: steppers, sensors, exports to C and FMI, environments.

Depends on gait, rft and kinematics; gymnasium and a C compiler only where they are used.
"""
