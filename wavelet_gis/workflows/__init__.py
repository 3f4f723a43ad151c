"""One function for each use, called alike by the command line, the plugin and scripts."""
