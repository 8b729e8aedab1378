"""The documentation site: Sphinx's configuration, pages made from the code, and the check of built links."""
