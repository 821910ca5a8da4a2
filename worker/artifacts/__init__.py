"""Files of a finished reconstruction: meshes, report, manifest."""
