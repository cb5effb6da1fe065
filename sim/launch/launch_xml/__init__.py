"""``launch_xml``: launch files in XML."""
