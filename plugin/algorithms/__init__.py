"""The Processing algorithms, one a module. Their ids, parameters and outputs are public and never renamed."""
