"""The documentation site: Sphinx's configuration, the pages made from the code, and the check of the built links."""
