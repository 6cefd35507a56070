"""How the scene is looked at and measured: views, colours, section, distances."""
