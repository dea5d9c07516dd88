"""Several swimmers in one fluid: boundary elements with all surfaces in one system."""
