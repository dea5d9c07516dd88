"""What surrounds a swimmer: the fluid and its flow, weight, thermal noise."""
